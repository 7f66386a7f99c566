"""The cover, and the command that makes the same results again."""

from __future__ import annotations

import shlex
from math import isfinite
from typing import TYPE_CHECKING, Any

from ..summary import summary

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scales

NOT_STATED = "not stated"
"""What stands on the cover where the survey says nothing."""


def cover_facts(results: Results, scales: Scales) -> tuple[tuple[str, str], ...]:
    """Return label and text of each line of the cover; what the survey does not say is said to be missing."""
    attrs, rings = results.survey.attrs, results.survey.rings.attrs

    def diameter(key: str) -> str | None:
        value = attrs.get(key)
        return scales.small.plain(float(value)) if value is not None and isfinite(float(value)) else None

    first, last = (scales.length.number(results.chainage[k], 2) for k in (0, -1))
    always = (
        ("Nominal diameter", diameter("nominal_diameter")),
        ("Material", attrs.get("material")),
        ("Direction of travel", attrs.get("direction")),
        ("Date", attrs.get("date")),
        ("Operator", attrs.get("operator")),
        ("Equipment", attrs.get("equipment")),
        ("Sensor", str(rings.get("sensor_kind", "unknown")).replace("-", " ")),
        ("Calibration", _calibration(results, scales)),
        ("Chainage", f"{first} to {last} {scales.length.name}, {results.stations} stations"),
    )
    if_known = (
        ("Base diameter", diameter("base_diameter")),
        ("Wall thickness", diameter("wall_thickness")),
        ("Coordinate system", attrs.get("crs")),
    )
    known = tuple((label, str(value)) for label, value in if_known if value)
    stated = tuple((label, str(value or NOT_STATED)) for label, value in always)
    return (*stated[:1], *known, *stated[1:])


def _calibration(results: Results, scales: Scales) -> str:
    """Return what the scale of the ranges stands on: a calibration with its reference, or an assumption."""
    section = results.survey.section.attrs
    scale, source = section.get("range_scale_sigma"), str(section.get("range_scale_source", "") or "")
    known = "" if scale is None else f"scale known to {2 * float(scale) * 1e2:.2g} % (two-sigma)"
    if not results.survey.has("calibration") or "range_scale" not in results.survey.calibration:
        return "; ".join(part for part in ("none given", known, source) if part)
    data = results.survey.calibration
    reference = data.attrs.get("reference_diameter")
    against = f"against a reference of {scales.small.plain(float(reference))}" if reference else "given with the survey"
    applied = f"ranges divided by {float(data['range_scale']):.5f}"
    return "; ".join(part for part in (against, applied, known) if part)


def command(results: Results) -> str:
    """Return the command line that makes the same results again: the inputs as they were last read, with what was
    stated about them, and the corrections and the calibration that were given."""
    attrs, record = results.survey.attrs, results.provenance
    read = record.get("read", {})
    names = read.get("names") or [str(item["name"]) for item in record.get("inputs", ())] or ["INPUT"]
    stated = {key: _flag_value(value) for key, value in read.get("options", {}).items() if key != "nominal_diameter"}
    for flag, key in (("nominal", "nominal_diameter"), ("base", "base_diameter")):
        if attrs.get(key) is not None:
            stated[flag] = f"{float(attrs[key]) * 1e3:g}mm"
    files = {
        key: str(record[key])
        for key in ("calibration", "overrides", "design_line", "design_line_of", "back")
        if key in record
    }
    flags = [f"--{key.replace('_', '-')}" for key in (*stated, *files)]
    # A value that begins with a hyphen, as axes do, would be taken for another option.
    words = [
        f"{flag}={value}" if value.startswith("-") else f"{flag} {value}"
        for flag, value in zip(flags, map(shlex.quote, (*stated.values(), *files.values())), strict=True)
    ]
    words += [f"--check {shlex.quote(str(row.get('rule')))}" for row in summary(results.survey)["rules"]]
    return " ".join(["springline inspect", *map(shlex.quote, names), *words, "--config config.toml -o DIR"])


def _flag_value(value: Any) -> str:
    return ",".join(f"{number:.12g}" for number in value) if isinstance(value, list) else str(value)
