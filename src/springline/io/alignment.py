"""LandXML alignments as lines of points: plan from straight pieces and arcs, height from the design profile."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from .trees import child, children, parse, tag, text

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from pathlib import Path

_METRES = {"meter": 1.0, "millimeter": 1e-3, "centimeter": 1e-2, "foot": 0.3048, "USSurveyFoot": 1200.0 / 3937.0}
_SAGITTA = 1e-4
"""How far a piece of an arc may stand off its chord [m]."""


def read_alignment(path: Path) -> dict[str, np.ndarray]:
    """Return easting, northing and elevation [m] of the one alignment in a LandXML file.

    Stations of the profile run along the plan from `staStart`; where the alignment's stated length is not that of its
    plan (stations along a sloping pipe), they are stretched to it.

    Raises:
        FormatError: It is not XML.
        InputError: There is not one alignment, its plan has a spiral or a gap, or it has no profile.
    """
    if not path.is_file():
        raise InputError("no such file", where=path, mend="check the path")
    root = parse(path)
    found = [one for group in children(root, "Alignments") for one in children(group, "Alignment")]
    if tag(root) != "LandXML" or len(found) != 1:
        raise InputError(f"there are {len(found)} alignments", where=path, expected="a LandXML file with one")
    alignment, unit = found[0], _unit(root, path)
    plan = _plan(alignment, path)
    stations, heights = _profile(alignment, path)
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(plan, axis=0).T))])
    start = _value(alignment, "staStart", path, 0.0)
    whole = _value(alignment, "length", path, run[-1])
    along = (stations - start) * (run[-1] / whole)
    # Both the plan's corners and the profile's are corners of the line.
    inside = (along > 1e-6) & (along < run[-1] - 1e-6)
    places = np.unique(np.round(np.concatenate([run, along[inside]]), 9))
    places = places[(places >= along[0] - 1e-6) & (places <= along[-1] + 1e-6)]
    if places.size < 2:
        raise InputError("its profile lies beyond its plan", where=path, expected="stations between its two ends")
    northing, easting = (np.interp(places, run, plan[:, k]) for k in (0, 1))
    elevation = np.interp(places, along, heights)
    return {"easting": unit * easting, "northing": unit * northing, "elevation": unit * elevation}


def _unit(root: ET.Element, path: Path) -> float:
    units = child(root, "Units")
    for system in [] if units is None else units:
        name = system.get("linearUnit", "")
        if name in _METRES:
            return _METRES[name]
        raise InputError(f"the unit '{name}' is unknown", where=f"{path}, Units", expected=", ".join(_METRES))
    raise InputError("it states no unit", where=f"{path}, Units", expected="Metric or Imperial with its linearUnit")


def _plan(alignment: ET.Element, path: Path) -> np.ndarray:
    """Return the corners of the plan, northing and easting in the file's unit (n, 2)."""
    pieces: list[np.ndarray] = []
    for geometry in children(alignment, "CoordGeom"):
        for one in geometry:
            kind = tag(one)
            if kind == "Line":
                piece = np.stack([_point(one, name, path) for name in ("Start", "End")])
            elif kind == "IrregularLine":
                piece = _irregular(one, path)
            elif kind == "Curve":
                piece = _arc(one, path)
            else:
                raise InputError(
                    f"its plan holds a {kind}", where=f"{path}, CoordGeom", expected="Line, IrregularLine or Curve"
                )
            if pieces and np.hypot(*(piece[0] - pieces[-1][-1])) > 1e-2:
                raise InputError(f"the plan has a gap before its {len(pieces) + 1}. piece", where=f"{path}, CoordGeom")
            pieces.append(piece[1:] if pieces else piece)
    if not pieces:
        raise InputError("the alignment has no plan", where=path, expected="CoordGeom with its lines and curves")
    return np.concatenate(pieces)


def _irregular(one: ET.Element, path: Path) -> np.ndarray:
    for name, width in (("PntList2D", 2), ("PntList3D", 3)):
        if text(one, name):
            return _numbers(text(one, name), width, f"{path}, {name}")[:, :2]
    raise InputError("an irregular line has no points", where=f"{path}, CoordGeom", expected="PntList2D")


def _arc(one: ET.Element, path: Path) -> np.ndarray:
    start, centre, end = (_point(one, name, path) for name in ("Start", "Center", "End"))
    radius = float(np.hypot(*(start - centre)))
    # Angles from north clockwise, as northing comes first.
    first, last = (math.atan2(p[1] - centre[1], p[0] - centre[0]) for p in (start, end))
    turn = (last - first) % (2.0 * math.pi)
    if one.get("rot") == "ccw":
        turn -= 2.0 * math.pi
    elif one.get("rot") != "cw":
        raise InputError("a curve does not say its sense", where=f"{path}, Curve, rot", expected="cw or ccw")
    step = 2.0 * math.acos(max(1.0 - _SAGITTA / max(radius, 2.0 * _SAGITTA), 0.0))
    angles = first + turn * np.linspace(0.0, 1.0, max(math.ceil(abs(turn) / step), 1) + 1)
    arc = centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    arc[-1] = end
    return arc


def _profile(alignment: ET.Element, path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return stations and elevations of the design profile, in the file's unit."""
    lines = [line for profile in children(alignment, "Profile") for line in children(profile, "ProfAlign")]
    if len(lines) != 1:
        raise InputError(f"the alignment has {len(lines)} design profiles", where=path, expected="one ProfAlign")
    points = [
        _numbers(one.text or "", 2, f"{path}, ProfAlign, {tag(one)}")[0] for one in lines[0] if tag(one) != "Feature"
    ]
    curved = [tag(one) for one in lines[0] if tag(one) not in ("PVI", "Feature")]
    if curved:
        raise InputError(f"its profile holds a {curved[0]}", where=f"{path}, ProfAlign", expected="PVI alone")
    values = np.array(points).reshape(-1, 2)
    if len(values) < 2 or not (np.diff(values[:, 0]) > 0.0).all():
        raise InputError(
            "its profile does not run on", where=f"{path}, ProfAlign", expected="two or more PVI, stations increasing"
        )
    return values[:, 0], values[:, 1]


def _point(one: ET.Element, name: str, path: Path) -> np.ndarray:
    return _numbers(text(one, name), 0, f"{path}, {tag(one)}, {name}")[0, :2]


def _value(element: ET.Element, name: str, path: Path, otherwise: float) -> float:
    return float(_numbers(element.get(name, repr(otherwise)), 1, f"{path}, Alignment, {name}")[0, 0])


def _numbers(words: str, width: int, where: str) -> np.ndarray:
    """Return numbers separated by white space as rows (n, width); one row of two or more when the width is 0."""
    try:
        values = np.array([float(word) for word in words.split()])
    except ValueError:
        values = np.array([math.nan])
    width = width or values.size
    if values.size < max(width, 1) or values.size % width or not np.isfinite(values).all() or width < 1:
        raise InputError(f"'{words[:40]}' is not what it should be", where=where, expected="numbers, northing first")
    return values.reshape(-1, width)
