"""LandXML 1.2: the axis as an alignment, with its elevations as a profile."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from datetime import datetime
from typing import TYPE_CHECKING

import numpy as np

from ... import __version__
from ...io.trees import clean, document
from .centreline import required_centreline

if TYPE_CHECKING:
    from pathlib import Path

    from ...survey import Survey
    from .centreline import Centreline

_TOLERANCE = 1e-3


def write_landxml(survey: Survey, path: Path) -> None:
    """Write the axis as LandXML [m]: northing before easting, thinned so that no station lies 1 mm off.

    Raises:
        InputError: No layout says where the pipe runs.
    """
    line = required_centreline(survey, "an alignment")
    name = clean(str(survey.attrs.get("name") or "pipe"))
    length = float(line.chainage[-1] - line.chainage[0])
    now = datetime.now()
    root = ET.Element("LandXML", {
        "xmlns": "http://www.landxml.org/schema/LandXML-1.2",
        "version": "1.2",
        "date": now.date().isoformat(),
        "time": now.time().isoformat("seconds"),
    })  # fmt: skip
    units = ET.SubElement(root, "Units")
    ET.SubElement(units, "Metric", {
        "linearUnit": "meter", "areaUnit": "squareMeter", "volumeUnit": "cubicMeter",
        "temperatureUnit": "celsius", "pressureUnit": "milliBars", "angularUnit": "radians",
    })  # fmt: skip
    ET.SubElement(root, "CoordinateSystem", {"name": line.crs or line.frame, "desc": line.frame})
    ET.SubElement(root, "Project", {"name": name})
    ET.SubElement(root, "Application", {"name": "Springline", "version": __version__})
    alignment = ET.SubElement(
        ET.SubElement(root, "Alignments"),
        "Alignment",
        {"name": name, "length": f"{length:.4f}", "staStart": f"{line.chainage[0]:.4f}"},
    )
    _plan(alignment, line)
    _profile(alignment, line, name)
    path.write_bytes(document(root))


def _plan(alignment: ET.Element, line: Centreline) -> None:
    keep = thinned(np.stack([line.chainage, line.northing, line.easting], axis=1), _TOLERANCE)
    points = [f"{line.northing[k]:.4f} {line.easting[k]:.4f}" for k in keep]
    element = ET.SubElement(
        ET.SubElement(alignment, "CoordGeom"),
        "IrregularLine",
        {"length": f"{line.chainage[-1] - line.chainage[0]:.4f}", "staStart": f"{line.chainage[0]:.4f}"},
    )
    ET.SubElement(element, "Start").text = points[0]
    ET.SubElement(element, "End").text = points[-1]
    ET.SubElement(element, "PntList2D").text = " ".join(points)


def _profile(alignment: ET.Element, line: Centreline, name: str) -> None:
    known = np.flatnonzero(np.isfinite(line.elevation))
    if known.size < 2:
        return
    points = np.stack([line.chainage[known], line.elevation[known]], axis=1)
    profile = ET.SubElement(ET.SubElement(alignment, "Profile", {"name": name}), "ProfAlign", {"name": name})
    for k in thinned(points, _TOLERANCE):
        ET.SubElement(profile, "PVI").text = f"{points[k, 0]:.4f} {points[k, 1]:.4f}"


def thinned(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the rows to keep of points (n, 1 + d) that follow their first column, so that straight pieces between
    them pass every other within `tolerance` (the rule of Douglas and Peucker along the first column).

    >>> thinned(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 1.0]]), 1e-3).tolist()
    [0, 2, 3]
    """
    keep = np.zeros(len(points), bool)
    keep[[0, -1]] = True
    pieces = [(0, len(points) - 1)]
    while pieces:
        first, last = pieces.pop()
        if last - first < 2:
            continue
        inner = points[first + 1 : last]
        share = (inner[:, :1] - points[first, 0]) / (points[last, 0] - points[first, 0])
        off = np.linalg.norm(inner[:, 1:] - points[first, 1:] - share * (points[last, 1:] - points[first, 1:]), axis=1)
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            middle = first + 1 + worst
            keep[middle] = True
            pieces += [(first, middle), (middle, last)]
    return np.flatnonzero(keep)
