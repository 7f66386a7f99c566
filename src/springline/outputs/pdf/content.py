"""What the template of the PDF reads: words, ticks by their share of an axis, and pictures as SVG or PNG files."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from ..colours import scale_colours
from ..png import palette_png
from ..report.along import by_reason
from .svg import chart_svg, plan_svg, residuals_svg, section_svg, swatch_svg

if TYPE_CHECKING:
    from pathlib import Path

    from ..report.charts import Chart
    from ..report.drawing import Drawing
    from ..report.layout import Plan
    from ..report.listings import Table
    from ..report.maps import Map
    from ..report.model import Report
    from ..report.pictures import Picture
    from ..report.profiles import Axis

_AREA_WIDTH = {"a4": 460.0, "us-letter": 476.0}
_HEIGHTS = {"coverage": 56.0}
_HEIGHT, _MAP_HEIGHT = 88.0, 118.0
_LARGE, _SMALL = 220.0, 140.0
_RESIDUALS = (40.0, 25.0)
_VERDICTS = {
    "pass": ("✓", "#0072b2"),
    "fail": ("✗", "#b5350a"),
    "uncertain": ("?", "#b58900"),
    "not assessed": ("–", "#8b95a1"),
}
_SENTENCE = 24
_LONG = re.compile(r"\S{25,}")


def content(report: Report, folder: Path) -> dict[str, Any]:
    """Return what `report.typ` reads, but its fonts; pictures are written into `folder`.

    Args:
        report: The model.
        folder: An existing folder.
    """
    import numpy as np

    paper = "us-letter" if report.scales.length.name == "ft" else "a4"
    width = _AREA_WIDTH[paper]
    (folder / "ramp.png").write_bytes(palette_png(np.arange(201, dtype=np.uint8)[None], scale_colours()))
    words = report.words
    return {
        "paper": paper,
        "area_width": width,
        "map_height": _MAP_HEIGHT,
        "large": _LARGE,
        "small": _SMALL,
        "name": breakable(report.name),
        "footer": breakable(f"{report.name}. Springline {report.version}."),
        "facts": [[label, breakable(value)] for label, value in report.facts],
        "rules": _rules(report),
        "warnings": [breakable(line) for line in report.warnings],
        "assumptions": [breakable(line) for line in report.assumptions],
        "headlines": _headlines(report),
        "overrides": _table(report.overrides),
        "words": {
            "wall": words.wall,
            "along": words.along,
            "worst": words.worst,
            "features": words.features,
            "no_features": words.features,
            "pictures": report.pictures_note,
            "definitions": words.definitions,
            "end": words.end,
        },
        "maps": [_map(one, folder) for one in report.maps],
        "marks": [{"left": mark.left, "top": mark.top, "label": mark.label} for mark in report.marks],
        "clock_ticks": [[k / 4, f"{hour} h"] for k, hour in enumerate((6, 3, 12, 9, 6))],
        "xticks": _ticks(report.axis),
        "xtitle": f"Chainage [{report.scales.length.name}]",
        "readings": _table(report.readings),
        "statuses": _table(report.statuses),
        "unseen": _table(report.unseen),
        "charts": [_chart(one, report, width, silent=True) for one in report.charts],
        "layout": [_chart(one, report, width, silent=False) for one in report.layout],
        "layout_lists": [{"title": title, **_table(table)} for title, table in report.layout_lists],
        "missing": _missing(by_reason(report.missing)),
        "missing_layout": _missing(by_reason(report.missing_layout)),
        "plan": None if report.plan is None else _plan(report.plan, width),
        "section_legend": _section_legend(report),
        "worst_true": None if report.worst_true is None else _drawing(report.worst_true, 0),
        "drawings": [_drawing(one, number) for number, one in enumerate(report.drawings, 1)],
        "worst": _table(report.worst),
        "features": _table(report.features),
        "pictures": [_picture(one, folder) for one in report.pictures],
        "stretches": _table(report.stretches),
        "definitions": _table(report.definitions),
        "method": list(words.method),
        "command": breakable(report.command),
        "inputs": _inputs(report),
        "config": report.config_toml,
    }


def breakable(text: str) -> str:
    """Return a text whose long words may break: a zero-width space after every twelve signs of them.

    >>> breakable("a" * 30).count("\\u200b"), breakable("short words stay").count("\\u200b")
    (2, 0)
    """
    return _LONG.sub(lambda word: "\u200b".join(word[0][k : k + 12] for k in range(0, len(word[0]), 12)), text)


def _rules(report: Report) -> list[dict[str, str]]:
    rows = []
    for rule, edition, verdict, where, why in report.rules.rows:
        sign, colour = _VERDICTS.get(verdict, ("", "#8b95a1"))
        place = f", at {where}\u00a0{report.scales.length.name}" if where != "–" else ""
        words = breakable(f"{rule}{f', {edition}' if edition else ''}{place}")
        rows.append({"sign": sign, "colour": colour, "verdict": verdict, "rule": words, "why": breakable(why)})
    return rows


def _headlines(report: Report) -> list[dict[str, Any]]:
    rows = []
    for one in report.headlines:
        at = [] if one.chainage is None else [f"at {report.scales.length.text(one.chainage, 2)}"]
        lines = ([one.interval] if one.interval else []) + at
        rows.append({"label": one.label, "value": one.value, "unit": one.unit, "lines": lines, "note": one.note})
    return rows


def _table(table: Table) -> dict[str, Any]:
    words = sorted(table.words)
    # Columns of sentences share what the others leave; without any, the first column takes it.
    long = [k for k in words if max((len(row[k]) for row in table.rows), default=0) > _SENTENCE]
    return {
        "headings": list(table.headings),
        "rows": [[breakable(cell) for cell in row] for row in table.rows],
        "words": words,
        "stretch": long or words[:1] or [0],
    }


def _ticks(axis: Axis, *, upwards: bool = False) -> list[list[Any]]:
    shares = [axis.share(tick) for tick in axis.ticks]
    return [[1 - share if upwards else share, axis.label(tick)] for share, tick in zip(shares, axis.ticks, strict=True)]


def _swatch(label: str, kind: str, colour: str, dash: str = "") -> dict[str, str]:
    return {"svg": swatch_svg(kind, colour, dash), "label": label}


def _chart(chart: Chart, report: Report, width: float, *, silent: bool) -> dict[str, Any]:
    height = _HEIGHTS.get(chart.key, _HEIGHT)
    legend = [_swatch(line.label, "line", line.colour, line.dash) for line in chart.lines]
    legend += [_swatch(band.label, "band", band.colour) for band in chart.bands]
    legend += [_swatch(label, "line", "#6b7480", "5 4") for label, _ in chart.levels]
    return {
        "title": chart.title,
        "unit": chart.unit,
        "note": chart.note,
        "legend": legend,
        "height": height,
        "svg": chart_svg(chart, report.axis, report.gaps, report.silent if silent else (), width, height),
        "yticks": _ticks(chart.axis, upwards=True),
    }


def _map(one: Map, folder: Path) -> dict[str, Any]:
    file = f"map-{one.key}.png"
    (folder / file).write_bytes(one.picture)
    legend = [] if one.limit is None else [{"svg": None, "ramp": list(one.limit), "label": ""}]
    legend += [_swatch(label, "chip", colour) for label, colour in one.legend]
    return {"title": one.title, "note": one.note, "file": file, "legend": legend}


def _missing(entries: list[tuple[str, str]]) -> list[dict[str, str]]:
    return [{"titles": titles, "reason": breakable(reason)} for titles, reason in entries]


def _plan(plan: Plan, width: float) -> dict[str, Any]:
    return {
        "unit": plan.unit,
        "note": f"{plan.note} One scale in both directions, north up. Numbers are features.",
        "aspect": plan.aspect,
        "svg": plan_svg(plan, width),
        "xticks": _ticks(plan.across),
        "yticks": _ticks(plan.up, upwards=True),
        "xtitle": f"Easting [{plan.unit}] across, northing [{plan.unit}] up",
        "marks": [list(mark) for mark in plan.marks],
    }


def _section_legend(report: Report) -> list[dict[str, str]]:
    unused = [] if report.worst_true is None else [(label, colour) for label, colour, _ in report.worst_true.unused]
    return [
        _swatch(report.words.circle, "line", "#6b7480", "5 4"),
        _swatch("fitted section", "line", "#c0392b"),
        _swatch("used readings", "dot", "#1d2733"),
        *(_swatch(label, "dot", colour) for label, colour in unused),
        _swatch("largest chord", "line", "#d55e00", "2.5 2.5"),
        _swatch("smallest chord", "line", "#0072b2", "2.5 2.5"),
    ]


def _drawing(drawing: Drawing, number: int) -> dict[str, Any]:
    residuals = drawing.residuals if number else None
    # The labels at the left take what the drawing leaves.
    width, height = (_LARGE if number == 1 else _SMALL) - _RESIDUALS[0], _RESIDUALS[1]
    return {
        "title": f"{number}. {drawing.title}" if number else drawing.title,
        "caption": drawing.caption,
        "bar": drawing.bar[1],
        "svg": section_svg(drawing),
        "residuals": residuals
        and {
            "svg": residuals_svg(residuals, width, height),
            "width": width,
            "height": height,
            "limit": residuals.limit,
            "rms": residuals.rms,
        },
    }


def _picture(one: Picture, folder: Path) -> dict[str, str]:
    file = f"feature-{one.number}.png"
    (folder / file).write_bytes(one.image)
    caption = one.caption + (f" Image {one.source_image}." if one.source_image else "")
    return {"number": str(one.number), "title": breakable(one.title), "caption": breakable(caption), "file": file}


def _inputs(report: Report) -> dict[str, Any]:
    rows = [[str(item.get(key, "")) for key in ("name", "bytes", "sha256")] for item in report.inputs]
    return {
        "headings": ["Input", "Bytes", "SHA-256"],
        "rows": [[breakable(cell) for cell in row] for row in rows],
        "words": [0, 2],
        "stretch": [0, 2],
    }
