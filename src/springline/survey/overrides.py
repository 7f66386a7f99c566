"""`overrides.toml`: corrections that people make to a survey, each with its author, date and reason.

    [[mask]]                      # readings that must not be used
    from_m = 12.0
    to_m = 13.5
    from_clock = 4.0              # an arc, clockwise; without both the whole ring
    to_clock = 8.0
    author = "A. Surveyor"
    date = 2026-05-04
    reason = "the robot stood in a roots' curtain"

    [[relabel]]                   # [[remove]] is alike, without `to`
    kind = "joint"
    chainage_m = 12.3
    to = "lateral"
    ...

Places are chainages, with the datum of the same file in them when there is one; those of a mask with
`along = "distance"` are what the odometer read. The file says nothing that the report does not repeat.
"""

from __future__ import annotations

import json
import tomllib
from datetime import date, datetime
from math import isfinite
from typing import TYPE_CHECKING, Any

import tomli_w

from ..errors import FormatError, InputError, nearest
from .model import PENDING

if TYPE_CHECKING:
    from pathlib import Path

    from .model import Survey

_SIGNED = ("author", "date", "reason")
_TEXTS = (*_SIGNED, "kind", "to", "image", "along")
_ALONG = ("chainage", "distance")
_CLOCKS = ("from_clock", "to_clock", "clock_h")

ACTIONS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "mask": (("from_m", "to_m"), ("from_clock", "to_clock", "along")),
    "relabel": (("kind", "chainage_m", "to"), ("clock_h", "within_m")),
    "remove": (("kind", "chainage_m"), ("clock_h", "within_m")),
    "add": (("kind", "chainage_m"), ("clock_h", "size_mm", "length_mm", "depth_mm", "image")),
    "datum": (("at_m",), ("chainage_m", "easting_m", "northing_m", "elevation_m")),
}
"""What can be done, with the keys that each table must and may have beside author, date and reason."""


def read_overrides(path: Path) -> list[dict[str, Any]]:
    """Return the corrections in an `overrides.toml`, in the order of `ACTIONS` and of the file.

    Args:
        path: The file.

    Returns:
        For each: `action`, `what` (a plain sentence), `author`, `date`, `reason`, and `change` (its numbers and words
        as the file has them).

    Raises:
        FormatError: It is not TOML.
        InputError: A key is unknown (its nearest neighbour is named), missing, or has a value that cannot be.
    """
    if not path.is_file():
        raise InputError("no such file", where=path, mend="check the path given to --overrides")
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise FormatError(f"not a TOML file: {error}", where=path) from None
    for key in values:
        if key not in ACTIONS:
            raise InputError(f"unknown key{nearest(key, ACTIONS)}", where=f"{path}, {key}", expected=", ".join(ACTIONS))
    records = []
    for action in ACTIONS:
        tables = values.get(action, [])
        if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
            raise InputError(
                "it is not a list of tables", where=f"{path}, {action}", expected=f"[[{action}]], in double brackets"
            )
        records += [_record(action, table, f"{path}, {action} {k}") for k, table in enumerate(tables, 1)]
    if sum(record["action"] == "datum" for record in records) > 1:
        raise InputError("there are two datums", where=f"{path}, datum", expected="one")
    return records


def with_overrides(survey: Survey, path: Path) -> Survey:
    """Return the survey with the corrections of a file, for `inspect` to apply; earlier ones are replaced.

    A finished survey keeps those that were applied to it; the file's stand ready for when it is inspected again.

    Raises:
        InputError: As `read_overrides`.
    """
    text = json.dumps(read_overrides(path), ensure_ascii=False)
    return survey.with_attrs(**{PENDING if survey.has("section") else "overrides": text})


def dump_overrides(survey: Survey) -> str:
    """Return the corrections of a survey as an `overrides.toml`."""
    tables: dict[str, list[dict[str, Any]]] = {}
    for record in changes(survey, *ACTIONS):
        tables.setdefault(record["action"], []).append(record["change"] | {key: record[key] for key in _SIGNED})
    return tomli_w.dumps(tables)


def changes(survey: Survey, *actions: str) -> list[dict[str, Any]]:
    """Return the corrections of a survey with one of the actions, each with its `change`."""
    records = json.loads(survey.attrs.get("overrides", "[]"))
    return [record for record in records if record["action"] in actions]


def with_effects(survey: Survey, effects: list[str], *actions: str) -> Survey:
    """Return the survey with what each of its `changes(survey, *actions)` did, in their order."""
    told = iter(effects)
    records = json.loads(survey.attrs.get("overrides", "[]"))
    records = [{**r, "effect": next(told)} if r["action"] in actions else r for r in records]
    return survey.with_attrs(overrides=json.dumps(records, ensure_ascii=False))


def datum_shift(survey: Survey) -> float:
    """Return what the survey's datum adds to every chainage [m]; 0 without one."""
    for record in changes(survey, "datum"):
        change = record["change"]
        if "chainage_m" in change:
            return change["chainage_m"] - change["at_m"]
    return 0.0


def _record(action: str, table: dict[str, Any], where: str) -> dict[str, Any]:
    must, may = ACTIONS[action]
    known = (*must, *may, *_SIGNED)
    for key in table:
        if key not in known:
            raise InputError(
                f"unknown key '{key}'{nearest(key, known)}", where=f"{where}, {key}", expected=", ".join(known)
            )
    for key in (*must, *_SIGNED):
        if key not in table:
            raise InputError(f"the key '{key}' is missing", where=where, expected=", ".join((*must, *_SIGNED)))
    change = {key: _value(key, value, f"{where}, {key}") for key, value in table.items()}
    _check(action, change, where)
    signed = {key: change.pop(key) for key in _SIGNED}
    return {"action": action, "what": _sentence(action, change), **signed, "change": change}


def _value(key: str, value: Any, where: str) -> Any:
    if key == "date":
        return iso_date(value, where)
    if key in _TEXTS:
        if not isinstance(value, str) or not value.strip():
            raise InputError(f"{value!r} is not a text", where=where, expected="a text in quotes")
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
        raise InputError(f"{value!r} is not a number", where=where, expected="a number")
    if key in _CLOCKS and not 0 <= value <= 12:
        raise InputError(f"{value:g} is no clock position", where=where, expected="0 to 12 hours")
    return float(value)


def iso_date(value: Any, where: str) -> str:
    """Return a date that was read from TOML as ISO 8601 writes it.

    Raises:
        InputError: It is none.

    >>> iso_date(date(2026, 5, 4), "survey.toml, date")
    '2026-05-04'
    """
    if isinstance(value, (date, datetime)):
        return value.isoformat()
    try:
        return datetime.fromisoformat(value) and value
    except (TypeError, ValueError):
        raise InputError(f"{value!r} is not a date", where=where, expected="ISO 8601, such as 2026-05-04") from None


def _check(action: str, change: dict[str, Any], where: str) -> None:
    if action == "mask":
        if change["to_m"] <= change["from_m"]:
            raise InputError("to_m is not beyond from_m", where=where, expected="from_m < to_m")
        if ("from_clock" in change) != ("to_clock" in change):
            raise InputError(
                "an arc has one end only", where=where, expected="both from_clock and to_clock, or neither"
            )
        if change.get("along", "chainage") not in _ALONG:
            raise InputError(
                f"'{change['along']}' is unknown{nearest(change['along'], _ALONG)}",
                where=f"{where}, along",
                expected=" or ".join(_ALONG),
            )
    if action == "datum" and len(change) == 1 + len(_SIGNED):
        raise InputError("the datum sets nothing", where=where, expected=", ".join(ACTIONS["datum"][1]))
    if change.get("within_m", 1.0) <= 0:
        raise InputError("within_m is not positive", where=f"{where}, within_m", expected="a length above 0")


def _sentence(action: str, change: dict[str, Any]) -> str:
    def at(key: str) -> str:
        return f"{change[key]:g} m"

    clock = f", {change['clock_h']:g} o'clock" if "clock_h" in change else ""
    if action == "mask":
        arc = f", {change['from_clock']:g} to {change['to_clock']:g} o'clock" if "from_clock" in change else ""
        by = " by the odometer" if change.get("along") == "distance" else ""
        return f"leave out readings from {at('from_m')} to {at('to_m')}{by}{arc}"
    if action == "datum":
        said = ", ".join(f"{key.removesuffix('_m')} {at(key)}" for key in ACTIONS["datum"][1] if key in change)
        return f"set the point at {at('at_m')} to {said}"
    place = f"the {change['kind']} at {at('chainage_m')}{clock}"
    return {"relabel": f"call {place} a {change.get('to')}", "remove": f"remove {place}", "add": f"add {place}"}[action]
