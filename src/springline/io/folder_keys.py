"""`survey.toml`: its keys, checked one by one, as attributes of a survey."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from math import radians
from typing import TYPE_CHECKING, Any

from ..conventions import BEARING_SENSES, BEARING_ZEROS, SENSOR_KINDS, SURVEY_FOLDER_KEYS, SURVEY_SENSOR_KEYS
from ..errors import FormatError, InputError, nearest
from ..survey.overrides import iso_date
from .columns import UNITS, unit_name
from .units import length

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

PARTS = ("rings", "rings_rear", "inertial", "ties", "frames", "design_line", "calibration", "observations")
"""Parts of a survey folder, each a file."""

_TEXTS = ("name", "material", "crs", "operator", "equipment")
_LENGTHS = ("nominal_diameter", "base_diameter", "wall_thickness")
_CHOICES = {
    "kind": SENSOR_KINDS,
    "bearing_zero": tuple(BEARING_ZEROS),
    "bearing_sense": tuple(BEARING_SENSES),
    "referred_to": ("sensor", "axis"),
}


@dataclass(frozen=True)
class FolderKeys:
    """What `survey.toml` says.

    Args:
        attrs: Root attributes of the survey.
        parts: File name by part.
        sensor: Attributes of `/rings`: kind, bearings, noise [m], position [m], boresight angles [rad].
        sensor_rear: The same of `/rings_rear`.
        lens: Lens models by name, as they stand.
        units: Unit by quantity.
    """

    attrs: dict[str, Any]
    parts: dict[str, str]
    sensor: dict[str, Any] = field(default_factory=dict)
    sensor_rear: dict[str, Any] = field(default_factory=dict)
    lens: dict[str, Any] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)


def read_keys(path: Path) -> FolderKeys:
    """Read `survey.toml`.

    Raises:
        FormatError: It is not TOML.
        InputError: A key is unknown (its nearest neighbour is named) or its value cannot be used.
    """
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FormatError(f"not a TOML file: {error}", where=path) from None
    _known(values, SURVEY_FOLDER_KEYS, path, "")
    attrs: dict[str, Any] = {}
    for key in _TEXTS:
        if key in values:
            attrs[key] = _text(values[key], path, key)
    for key in _LENGTHS:
        if key in values:
            attrs[key] = _length(values[key], path, key)
    if "direction" in values:
        attrs["direction"] = _choice(values["direction"], ("downstream", "upstream"), path, "direction")
    if "facing" in values:
        attrs["facing"] = _choice(values["facing"], ("forwards", "backwards"), path, "facing")
    if "date" in values:
        attrs["date"] = iso_date(values["date"], f"{path}, date")
    parts = _table(values, "parts", path)
    _known(parts, PARTS, path, "parts.")
    return FolderKeys(
        attrs,
        {key: _text(value, path, f"parts.{key}") for key, value in parts.items()},
        _sensor(values, "sensor", path),
        _sensor(values, "sensor_rear", path),
        _table(values, "lens", path),
        _units(_table(values, "units", path), path),
    )


_LIMITS = {
    "boresight_pitch_deg": (-45.0, 45.0),
    "boresight_yaw_deg": (-45.0, 45.0),
    "boresight_roll_deg": (-360.0, 360.0),
    "baseline_sigma_deg": (0.0, 10.0),
    "range_scale_applied": (0.5, 2.0),
}
"""Numbers of `[sensor]` that have no unit, and what they may be."""


def _sensor(values: dict[str, Any], name: str, path: Path) -> dict[str, Any]:
    table = _table(values, name, path)
    _known(table, SURVEY_SENSOR_KEYS, path, f"{name}.")
    attrs: dict[str, Any] = {}
    for key, value in table.items():
        place = f"{name}.{key}"
        if key in _CHOICES:
            attrs["sensor_kind" if key == "kind" else key] = _choice(value, _CHOICES[key], path, place)
        elif key.endswith("_deg") or key == "range_scale_applied":
            low, high = _LIMITS[key]
            kind, wanted = ("an angle", "degrees, a number") if key.endswith("_deg") else ("a number", "about 1")
            wanted += f" from {low:g} to {high:g}"
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
                raise InputError(f"{value!r} is not {kind}", where=f"{path}, {place}", expected=wanted)
            attrs[key.removesuffix("_deg")] = radians(value) if key.endswith("_deg") else float(value)
        else:
            attrs[key.replace("offset", "position")] = _length(value, path, place, signed=key.startswith("offset"))
    return attrs


def _units(table: dict[str, Any], path: Path) -> dict[str, str]:
    _known(table, UNITS, path, "units.")
    units = {}
    for key, value in table.items():
        unit = unit_name(_text(value, path, f"units.{key}"))
        if unit not in UNITS[key]:
            # Of words for one unit only the first is offered.
            offered = {factor: word for word, factor in reversed(UNITS[key].items())}
            _choice(unit, tuple(reversed(offered.values())), path, f"units.{key}")
        units[key] = unit
    return units


def _known(values: Iterable[str], known: Iterable[str], path: Path, prefix: str) -> None:
    for key in values:
        if key not in known:
            raise InputError(
                f"unknown key{nearest(key, known)}", where=f"{path}, {prefix}{key}", expected=", ".join(known)
            )


def _table(values: dict[str, Any], key: str, path: Path) -> dict[str, Any]:
    table = values.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{table!r} is not a table", where=f"{path}, {key}", expected=f"a table [{key}]")
    return table


def _text(value: Any, path: Path, key: str) -> str:
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{value!r} is not a text", where=f"{path}, {key}", expected="a text in quotes")
    return value


def _choice(value: Any, known: tuple[str, ...], path: Path, key: str) -> str:
    if value not in known:
        raise InputError(
            f"{value!r} is unknown{nearest(str(value), known)}", where=f"{path}, {key}", expected=" or ".join(known)
        )
    return value


def _length(value: Any, path: Path, key: str, *, signed: bool = False) -> float:
    if not isinstance(value, str):
        raise InputError(
            f"{value!r} has no unit",
            where=f"{path}, {key}",
            expected="a length with its unit in quotes, such as '300mm'",
        )
    return length(value, where=f"{path}, {key}", signed=signed)
