"""DWA-M 150 XML, type B: what was read is written back as it stood; results get a reach of their own."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from datetime import date
from typing import TYPE_CHECKING

import numpy as np

from ...io.m150 import DIRECTIONS, INSPECTION, REACH, TEXTS
from ...io.observations import plain
from ...io.trees import clean, document, to_element
from .coded import inspections, is_own

if TYPE_CHECKING:
    from pathlib import Path

    from ...io.observations import Inspection, Observed
    from ...survey import Survey

_ORDER = ("HZ001", "HZ002", "HZ014", "HZ015", "HZ003", "HZ004", "HZ005", "HZ006", "HZ007", "HZ008", "HZ009", "HZ010",
          "HZ011")  # fmt: skip
_EDITION = (("FD001", "04-2010"), ("FD002", "B"))


def write_m150(survey: Survey, path: Path) -> None:
    """Write observations, or the features of an inspection, as DWA-M 150 of 04-2010, type B; numbers have a comma.

    Raises:
        InputError: There is nothing to write, or it is coded by another system.
    """
    found = inspections(survey, "m150")
    if is_own(survey, "m150"):
        reaches: dict[int, list[Inspection]] = {}
        for one in found:
            reaches.setdefault(one.own["row"], []).append(one)
        written = iter(reaches.values())
        tree = json.loads(survey.observations.attrs["layout"])["tree"]
        root = to_element(tree, lambda _: _own_reach(next(written)))
    else:
        root = ET.Element("DATA")
        head = ET.SubElement(root, "FD")
        for name, value in _EDITION:
            ET.SubElement(head, name).text = value
        root.extend(_reach(one) for one in found)
    path.write_bytes(document(root))


def _own_reach(inspected: list[Inspection]) -> ET.Element:
    runs = iter(inspected)
    return to_element(inspected[0].own["reach"], lambda _: _own_inspection(next(runs)))


def _own_inspection(one: Inspection) -> ET.Element:
    states = iter(one.observed)
    return to_element(one.own["inspection"], lambda _: _state(next(states)))


def _reach(one: Inspection) -> ET.Element:
    reach, inspection = ET.Element("HG"), ET.Element("HI")
    codes = {said: letter for letter, said in DIRECTIONS.items()}
    for words, element in ((REACH, reach), (INSPECTION, inspection)):
        for word, field in words.items():
            value = one.common.get(word, "")
            if word == "direction":
                value = codes.get(value, "")
            elif word == "date":
                value = _german(value)
            elif word.endswith(("_mm", "_m")):
                value = value.replace(".", ",")
            if value:
                ET.SubElement(element, field).text = clean(value)
    inspection.extend(_state(seen) for seen in one.observed)
    reach.append(inspection)
    return reach


def _german(value: str) -> str:
    try:
        return date.fromisoformat(value).strftime("%d.%m.%Y")
    except ValueError:
        return value


def _state(one: Observed) -> ET.Element:
    values = {field: one[name] for field, name in TEXTS.items()}
    values["HZ001"] = plain(one.distance).replace(".", ",")
    for field, hours in (("HZ006", one.clock), ("HZ007", one.clock_to)):
        values[field] = f"{round(hours) or 12:02d}" if np.isfinite(hours) else ""
    state = ET.Element("HZ")
    for field in _ORDER:
        ET.SubElement(state, field).text = clean(values[field]) or None
    state.extend(to_element(tree) for tree in one.fields.get("more", []))
    return state
