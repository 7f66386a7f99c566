"""DXF: sections drawn side by side, as seen looking forward, in millimetres."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...io.trees import clean
from ..results import Results

if TYPE_CHECKING:
    from pathlib import Path

    from ...survey import Survey

_SECTIONS = 60
_COLUMNS = 10
_READINGS = 720
_LAYERS = {"NOMINAL": 8, "FITTED": 5, "READINGS": 1, "TEXT": 7}


def write_dxf(survey: Survey, path: Path, *, sections: int = _SECTIONS) -> None:
    """Write sections as DXF [mm]: z right, y up, fitted ellipse, reference circle and the readings that were used.

    Args:
        survey: A finished survey.
        path: Where to write.
        sections: Stations to draw: the most deflected one, and others evenly along the pipe.
    """
    import ezdxf

    results = Results(survey)
    drawing = ezdxf.new("R2010", units=4)
    for layer, colour in _LAYERS.items():
        drawing.layers.add(layer, color=colour)
    space = drawing.modelspace()
    reference = results.metrics_attr("reference_diameter")
    circle = 1e3 * (reference if np.isfinite(reference) else results.circle_diameter)
    pitch = 1.5 * circle
    for k, station in enumerate(_stations(results, sections).tolist()):
        z, y = (k % _COLUMNS) * pitch, -(k // _COLUMNS) * pitch
        space.add_circle((z, y), circle / 2, dxfattribs={"layer": "NOMINAL"})
        _fitted(space, results, station, z, y)
        _readings(space, results, station, z, y)
        label = space.add_text(f"{results.chainage[station]:.3f} m", height=circle / 20, dxfattribs={"layer": "TEXT"})
        label.set_placement((z - circle / 4, y - 0.62 * circle))
    # A caret and two percent signs begin special characters in DXF texts.
    title = " ".join(clean(str(survey.attrs.get("name") or "pipe")).split()).replace("^", "^ ").replace("%%", "% %")
    space.add_text(
        f"{title}: sections looking forward, mm; grey circle {circle:.1f} mm",
        height=circle / 12,
        dxfattribs={"layer": "TEXT"},
    ).set_placement((0.0, 0.8 * circle))
    drawing.saveas(path)


def _stations(results: Results, count: int) -> np.ndarray:
    """Return stations with a section, evenly along the pipe, the most oval one among them."""
    fitted = np.flatnonzero(np.isfinite(results.metric("semi_major")))
    if fitted.size <= count:
        return fitted
    chosen = fitted[np.linspace(0, fitted.size - 1, count - 1).astype(int)]
    oval = results.judged("ovality_polar")
    worst = [int(np.nanargmax(oval))] if np.isfinite(oval).any() else []
    return np.unique(np.concatenate([chosen, worst]).astype(int))


def _fitted(space: object, results: Results, station: int, z: float, y: float) -> None:
    major, minor, turn = (results.metric(n)[station] for n in ("semi_major", "semi_minor", "axis_bearing"))
    axis = (1e3 * major * np.cos(turn), 1e3 * major * np.sin(turn))
    space.add_ellipse((z, y), major_axis=axis, ratio=float(minor / major), dxfattribs={"layer": "FITTED"})


def _readings(space: object, results: Results, station: int, z: float, y: float) -> None:
    rows = results.ring_of_station[station : station + 1]
    block = next(iter(results.blocks(rows)))
    radius, bearing = block.about_centre(results.bearing)
    used = np.flatnonzero((block.reason[0] == 0) & np.isfinite(radius[0]))
    used = used[:: max(1, used.size // _READINGS)]
    right, up = 1e3 * radius[0] * np.cos(bearing[0]), 1e3 * radius[0] * np.sin(bearing[0])
    for k in used.tolist():
        space.add_point((z + right[k], y + up[k]), dxfattribs={"layer": "READINGS"})
