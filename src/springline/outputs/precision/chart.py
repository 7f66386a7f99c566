"""Bars of h or k, laboratory by laboratory, with their critical values: what the practice asks to look at."""

from __future__ import annotations

from typing import Any

_WIDTH, _HEIGHT, _LEFT, _BOTTOM, _TOP = 720.0, 200.0, 44.0, 26.0, 12.0
_FILL = ("#2f74a8", "#b5502a", "#6f757d", "#12395f", "#e39a63", "#7fb1d3")


def consistency_chart(values: dict[str, Any], statistic: str) -> dict[str, Any]:
    """Return where the bars, lines and words of a chart stand, in the units of its view box.

    Args:
        values: As `study_values` returns them.
        statistic: h or k.

    Returns:
        `bars` (x, y, width, height, fill, title), `lines` (y, label), `labels` (x, text), `keys` (x, fill, text),
        `zero`, and the view box's size; no bars where the statistic is not known.
    """
    cells = [cell for cell in values["cells"] if cell[statistic] is not None]
    materials = [one["material"] for one in values["materials"]]
    laboratories = list(dict.fromkeys(cell["laboratory"] for cell in values["cells"]))
    limits = [one[f"{statistic}_critical"] for one in values["materials"] if one[f"{statistic}_critical"] is not None]
    reach = max([abs(cell[statistic]) for cell in cells] + limits, default=1.0) * 1.08 or 1.0
    low = -reach if statistic == "h" else 0.0
    scale = (_HEIGHT - _BOTTOM - _TOP) / (reach - low)

    def level(value: float) -> float:
        return _TOP + (reach - value) * scale

    group = (_WIDTH - _LEFT) / max(len(laboratories), 1)
    bar = 0.8 * group / max(len(materials), 1)
    bars = []
    for cell in cells:
        i, j = laboratories.index(cell["laboratory"]), materials.index(cell["material"])
        top, bottom = level(max(cell[statistic], 0.0)), level(min(cell[statistic], 0.0))
        bars.append(
            {
                "x": _LEFT + group * (i + 0.1) + bar * j,
                "y": top,
                "width": 0.92 * bar,
                "height": max(bottom - top, 0.5),
                "fill": _FILL[j % len(_FILL)],
                "title": f"{cell['laboratory']}, {cell['material']}: {statistic} = {cell[statistic]:.2f}",
            }
        )
    signs = (1.0, -1.0) if statistic == "h" else (1.0,)
    lines = [{"y": level(s * v), "label": f"{s * v:.2f}"} for v in dict.fromkeys(limits) for s in signs]
    labels = [{"x": _LEFT + group * (i + 0.5), "text": name} for i, name in enumerate(laboratories)]
    keys = [{"x": _LEFT + 110.0 * j, "fill": _FILL[j % len(_FILL)], "text": name} for j, name in enumerate(materials)]
    return {
        "statistic": statistic,
        "bars": bars,
        "lines": lines,
        "labels": labels,
        "keys": keys,
        "zero": level(0.0),
        "left": _LEFT,
        "width": _WIDTH,
        "height": _HEIGHT,
    }
