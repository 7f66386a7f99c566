"""DWA-M 150 XML, type B: reaches (HG) with their inspections (HI) and what was coded in them (HZ).

Source: DWA-M 150 (04-2010), field names as in its published example; numbers there have a comma or a point.
"""

from __future__ import annotations

from datetime import datetime
from typing import TYPE_CHECKING

from ..errors import FormatError
from .codes import en_kind
from .observations import Inspection, Observed, clock_hours, number, observations_survey
from .trees import child, children, parse, tag, text, to_tree

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

TEXTS = {
    "HZ002": "code",
    "HZ014": "characterisation_1",
    "HZ015": "characterisation_2",
    "HZ003": "quantification_1",
    "HZ004": "quantification_2",
    "HZ005": "continuous",
    "HZ008": "video",
    "HZ009": "photo",
    "HZ010": "remarks",
    "HZ011": "joint",
}
"""Fields of HZ whose content is text, with their names in `/observations`."""

REACH = {
    "name": "HG001",
    "node_from": "HG003",
    "node_to": "HG004",
    "material": "HG304",
    "width_mm": "HG306",
    "height_mm": "HG307",
    "length_m": "HG310",
}
"""Fields of HG by common word."""

INSPECTION = {"direction": "HI101", "date": "HI104", "time": "HI105", "operator": "HI112"}
"""Fields of HI by common word; dates are day.month.year."""

DIRECTIONS = {"I": "downstream", "G": "upstream"}
_PLACED = ("HZ001", "HZ006", "HZ007")


def read_m150(path: Path, options: ReadOptions) -> Survey:
    """Read the inspections in a DWA-M 150 file into `/observations`; all else is carried.

    Raises:
        FormatError: It is not DWA-M 150, holds no inspection, or a number cannot be read.
    """
    root = parse(path)
    if tag(root) != "DATA":
        raise FormatError(f"the root is '{tag(root)}'", where=path, expected="DATA")
    found = [
        _inspection(reach, inspection, row, f"{path}, HG {row}")
        for row, reach in enumerate(children(root, "HG"), 1)
        for inspection in children(reach, "HI")
    ]
    layout = {"tree": to_tree(root, lambda one: tag(one) == "HG" and child(one, "HI") is not None)}
    return observations_survey(found, path, format="m150", layout=layout)


def _inspection(reach: ET.Element, inspection: ET.Element, row: int, place: str) -> Inspection:
    common = {word: text(reach, name) for word, name in REACH.items()}
    common |= {word: text(inspection, name) for word, name in INSPECTION.items()}
    common["direction"] = DIRECTIONS.get(common["direction"], "")
    common["date"] = _iso(common["date"])
    for word in ("width_mm", "height_mm", "length_m"):
        common[word] = common[word].replace(",", ".")
    return Inspection(
        {word: value for word, value in common.items() if value},
        {
            "row": row,
            "reach": to_tree(reach, lambda one: tag(one) == "HI"),
            "inspection": to_tree(inspection, lambda one: tag(one) == "HZ"),
        },
        [_observed(one, f"{place}, HZ {k}") for k, one in enumerate(children(inspection, "HZ"), 1)],
    )


def _observed(state: ET.Element, place: str) -> Observed:
    texts = {name: text(state, field) for field, name in TEXTS.items()}
    texts["kind"] = en_kind(texts["code"], texts["remarks"])
    return Observed(
        number(text(state, "HZ001"), f"{place}, HZ001", decimal=","),
        clock_hours(text(state, "HZ006"), f"{place}, HZ006"),
        clock_hours(text(state, "HZ007"), f"{place}, HZ007"),
        texts,
        {"more": [to_tree(one) for one in state if tag(one) not in {*TEXTS, *_PLACED}]},
    )


def _iso(date: str) -> str:
    try:
        return datetime.strptime(date, "%d.%m.%Y").date().isoformat()
    except ValueError:
        return date
