"""Inspections with what was coded in them, as exchange files hold them, to and from `/observations`."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from ..conventions import bearing_from_clock, clock_from_bearing
from ..errors import FormatError, listed
from ..survey import Survey, add_assumption

if TYPE_CHECKING:
    from pathlib import Path

TEXTS = (
    "code",
    "kind",
    "characterisation_1",
    "characterisation_2",
    "quantification_1",
    "quantification_2",
    "joint",
    "continuous",
    "photo",
    "video",
    "remarks",
)
"""Text variables of `/observations`."""

COMMON = (
    "name",
    "node_from",
    "node_to",
    "date",
    "time",
    "operator",
    "direction",
    "material",
    "height_mm",
    "width_mm",
    "length_m",
)
"""What any header may say, in words of our own: ISO dates, downstream or upstream, numbers with a point."""


@dataclass
class Observed:
    """One coded observation.

    Args:
        distance: From the inspection's start [m].
        clock: First clock position [h]; NaN when there is none.
        clock_to: Second one.
        texts: By the names in `TEXTS`.
        fields: Whatever else the file says.
    """

    distance: float
    clock: float = np.nan
    clock_to: float = np.nan
    texts: dict[str, str] = field(default_factory=dict)
    fields: dict[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> str:
        return self.texts.get(name, "")


@dataclass
class Inspection:
    """One inspection of one pipe.

    Args:
        common: By the names in `COMMON`; what is not known is not there.
        own: The file's own header, by its own names.
        observed: What was coded.
    """

    common: dict[str, str]
    own: dict[str, Any] = field(default_factory=dict)
    observed: list[Observed] = field(default_factory=list)


def observations_survey(inspections: list[Inspection], path: Path, *, format: str, layout: Any) -> Survey:  # noqa: A002
    """Return a survey with `/observations`; attributes are those of the pipe when there is one inspection.

    Args:
        inspections: In the order of the file.
        path: The file, for messages.
        format: Key of its format.
        layout: How the file was laid out.

    Raises:
        FormatError: There is no inspection.
    """
    if not inspections:
        raise FormatError("there is no inspection of a pipe in it", where=path)
    rows = [(k, one) for k, inspection in enumerate(inspections) for one in inspection.observed]
    columns: dict[str, Any] = {
        "inspection_row": ("observation", np.array([k for k, _ in rows], np.int64)),
        "distance": ("observation", np.array([one.distance for _, one in rows], float)),
        "bearing": ("observation", bearing_from_clock(np.array([one.clock for _, one in rows], float))),
        "bearing_to": ("observation", bearing_from_clock(np.array([one.clock_to for _, one in rows], float))),
        "fields": ("observation", _texts(json.dumps(one.fields, ensure_ascii=False) for _, one in rows)),
        "name": ("inspection", _texts(one.common.get("name", "") for one in inspections)),
        "header": ("inspection", _texts(_header(one) for one in inspections)),
    }
    columns |= {name: ("observation", _texts(one[name] for _, one in rows)) for name in TEXTS}
    attrs = {"format": format, "layout": json.dumps(layout, ensure_ascii=False)}
    survey = Survey({"observations": xr.Dataset(columns, attrs=attrs)}, _attrs(inspections))
    unknown = sorted({one["code"] for _, one in rows if not one["kind"]})
    if unknown:
        shown = listed(unknown, 12, ", ")
        survey = add_assumption(survey, f"{len(unknown)} codes have no kind here and are carried as they are: {shown}.")
    return survey


def inspections_of(survey: Survey) -> list[Inspection]:
    """Return the inspections in `/observations`, as they were read."""
    data = survey.observations
    count = data.sizes.get("observation", 0)
    found = []
    for header in data["header"].values.tolist():
        values = json.loads(header)
        found.append(Inspection(values["common"], values["own"]))
    texts = {name: data[name].values.tolist() if name in data else [""] * count for name in TEXTS}
    fields = [json.loads(f) for f in data["fields"].values.tolist()] if "fields" in data else [{}] * count
    clock, clock_to = (_hours(data, name, count) for name in ("bearing", "bearing_to"))
    for k, (owner, distance) in enumerate(
        zip(data["inspection_row"].values.tolist(), data["distance"].values.tolist(), strict=True)
    ):
        words = {name: texts[name][k] for name in TEXTS}
        found[owner].observed.append(Observed(distance, clock[k], clock_to[k], words, fields[k]))
    return found


def plain(value: float, decimals: int = 6) -> str:
    """Return a number as short as it can be said; nothing for NaN.

    >>> plain(17.0), plain(0.5), plain(float("nan"))
    ('17', '0.5', '')
    """
    if not np.isfinite(value):
        return ""
    text = f"{value:.{decimals}f}".rstrip("0").rstrip(".") if decimals else f"{value:.0f}"
    return "0" if text in ("-0", "") else text


def number(text: str, where: str, *, decimal: str = ".") -> float:
    """Return a number, NaN for an empty text.

    Raises:
        FormatError: It is none.
    """
    text = text.strip()
    if not text:
        return np.nan
    try:
        return float(text.replace(decimal, ".") if decimal != "." else text)
    except ValueError:
        raise FormatError(f"the cell {text!r} is not a number", where=where) from None


def clock_hours(text: str, where: str) -> float:
    """Return a clock position [h]; NaN when there is none, which `0` and `00` say too.

    Raises:
        FormatError: It is no clock position.
    """
    hours = number(text, where, decimal=",")
    if not np.isnan(hours) and not 0 <= hours <= 12:
        raise FormatError(f"{text!r} is no clock position", where=where, expected="1 to 12")
    return np.nan if hours == 0 else hours


def _hours(data: xr.Dataset, name: str, count: int) -> list[float]:
    if name not in data:
        return [np.nan] * count
    return np.round(clock_from_bearing(data[name].values), 6).tolist()


def _header(inspection: Inspection) -> str:
    return json.dumps({"common": inspection.common, "own": inspection.own}, ensure_ascii=False)


def _texts(values: Any) -> np.ndarray:
    found = [str(v) for v in values]
    return np.array(found, dtype=str) if found else np.empty(0, "<U1")


def _attrs(inspections: list[Inspection]) -> dict[str, Any]:
    if len(inspections) != 1:
        return {}
    common = inspections[0].common
    attrs: dict[str, Any] = {
        key: common[key] for key in ("name", "date", "operator", "direction", "material") if common.get(key)
    }
    height = float(common.get("height_mm") or 0)
    return attrs | ({"nominal_diameter": height / 1e3} if height > 0 else {})
