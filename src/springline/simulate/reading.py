"""From a scenario file to a `Scenario`, with complaints that name key, line, value and valid range."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from ..errors import FormatError, InputError, ParameterError, nearest
from .checks import check
from .problem import Problem
from .scenario import Scenario

FOLDER = Path(__file__).with_name("scenarios")

_HEADER = re.compile(r"\s*(\[\[?)\s*([A-Za-z0-9_.\-]+)\s*\]\]?")
_KEY = re.compile(r"\s*([A-Za-z0-9_\-]+)\s*=")
_QUOTED = re.compile(r'"[^"]*"|\'[^\']*\'|#.*')
_TOKENS = re.compile(r"[\[\]{}]|([A-Za-z0-9_\-]+)\s*=")
_RANGES = {"gt": "above {}", "ge": "at least {}", "lt": "below {}", "le": "at most {}"}


def scenarios() -> dict[str, str]:
    """Return the ready scenarios: name and description of each.

    >>> "builtin" in scenarios()
    True
    """
    found = {}
    for file in sorted(FOLDER.glob("*.toml")):
        found[file.stem] = tomllib.loads(file.read_text(encoding="utf-8"))["description"]
    return found


def load(scenario: str | Path | Scenario) -> Scenario:
    """Return a checked scenario.

    Args:
        scenario: A TOML file, the name of a ready scenario, or a `Scenario`.

    Raises:
        InputError: There is no such file or ready scenario.
        FormatError: The file is not TOML.
        ParameterError: A key is unknown or a value out of range; the message names key, line, value and valid range.
    """
    if isinstance(scenario, Scenario):
        return _checked(scenario, "scenario", "")
    path = Path(scenario)
    ready = FOLDER / f"{scenario}.toml"
    if not path.suffix and ready.is_file():
        path = ready
    if not path.is_file():
        raise InputError(
            f"no scenario file '{scenario}' and no ready scenario of that name{nearest(str(scenario), scenarios())}",
            expected="a TOML file or one of " + ", ".join(scenarios()),
        )
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise FormatError(f"not a text in UTF-8: {error.reason} at byte {error.start}", where=path) from None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", where=path) from None
    return parse(text, where=str(path))


def parse(text: str, *, where: str = "scenario") -> Scenario:
    """Return the scenario that a TOML text describes; see `load` for what it raises.

    >>> parse('name = "x"\\n[pipe]\\ndiameter = -0.3\\nrun = [{kind = "straight", length = 5}]')
    Traceback (most recent call last):
    ...
    springline.errors.ParameterError: scenario, line 3: pipe.diameter = -0.3; expected above 0.0
    """
    try:
        raw = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise FormatError(f"not a TOML file: {error}", where=where) from None
    try:
        scenario = Scenario.model_validate(raw)
    except ValidationError as error:
        # A misspelt key also leaves the right one missing: the misspelling is what must be told.
        first = min(error.errors(), key=lambda one: one["type"] != "extra_forbidden")
        raise _complaint(first, raw, text, where) from None
    return _checked(scenario, where, text)


def _checked(scenario: Scenario, where: str, text: str) -> Scenario:
    try:
        check(scenario)
    except Problem as problem:
        raise ParameterError(
            f"{key_of(problem.path)} = {problem.value}{problem.why}",
            where=_place(where, problem.path, text),
            expected=problem.expected,
        ) from None
    return scenario


def _complaint(error: ErrorDetails, raw: dict[str, Any], text: str, where: str) -> ParameterError:
    path = _path_in(raw, error["loc"])
    place = _place(where, path, text)
    key = key_of(path)
    kind = error["type"]
    if kind == "extra_forbidden":
        known = _known_keys(path, error["loc"])
        return ParameterError(
            f"unknown key '{key}' = {error['input']!r}{nearest(str(path[-1]), known)}",
            where=place,
            expected="one of " + ", ".join(known),
        )
    if kind == "missing" and isinstance(error["loc"][-1], int):
        value = _value_at(raw, path)
        return ParameterError(f"{key} = {value!r}", where=place, expected=f"at least {len(value) + 1} values")
    if kind == "missing":
        return ParameterError(f"the key '{key}' is missing", where=place)
    context = error.get("ctx", {})
    if kind.startswith("union_tag"):
        return ParameterError(f"{key}.kind = {context.get('tag', 'nothing')!r}", where=place, expected=_tags(path))
    if kind == "model_type":
        return ParameterError(f"{key} = {error['input']!r}", where=place, expected="a table of its keys")
    limits = [_RANGES[name].format(limit) for name, limit in context.items() if name in _RANGES]
    said = error["msg"].lower().removeprefix("input should be ").removeprefix("value error, ")
    expected = " and ".join(limits) or str(context.get("expected", "")) or said
    return ParameterError(f"{key} = {error['input']!r}", where=place, expected=expected)


def _tags(path: tuple[int | str, ...]) -> str:
    """Return which kinds the table at `path` may be of."""
    kinds = [model.model_fields["kind"].annotation for model in _models_at((*path, "kind"))]
    return " or ".join(f"'{kind.__args__[0]}'" for kind in kinds)


def _path_in(raw: Any, loc: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return the part of pydantic's location that stands in the file: union tags and the like are left out."""
    path: list[int | str] = []
    here = raw
    for k, step in enumerate(loc):
        in_list = isinstance(here, list) and isinstance(step, int) and step < len(here)
        if in_list or (isinstance(here, dict) and step in here):
            here = here[step]
        elif k == len(loc) - 1 and isinstance(here, dict) and isinstance(step, str):
            path.append(step)
            break
        else:
            continue
        path.append(step)
    return tuple(path)


def _value_at(raw: Any, path: tuple[int | str, ...]) -> Any:
    """Return what stands in the file at `path`."""
    for step in path:
        raw = raw[step]
    return raw


def key_of(path: tuple[int | str, ...]) -> str:
    """Return a path as it is spoken of: `pipe.run[1].radius`, counting from 1.

    >>> key_of(("pipe", "run", 0, "radius"))
    'pipe.run[1].radius'
    """
    out = ""
    for step in path:
        out += f"[{step + 1}]" if isinstance(step, int) else f".{step}" if out else step
    return out


def _place(where: str, path: tuple[int | str, ...], text: str) -> str:
    line = line_of(text, path)
    return f"{where}, line {line}" if line else where


def line_of(text: str, path: tuple[int | str, ...]) -> int | None:
    """Return the line (from 1) on which a key of a TOML text stands, or its table, or None.

    >>> line_of('[a]\\nb = [\\n  {d = 1},\\n  {d = 2}]\\n[[c]]\\nd = 2\\n[[c]]\\nd = 3', ("c", 1, "d"))
    8
    >>> line_of('[a]\\nb = [\\n  {d = 1},\\n  {d = 2}]\\n[[c]]\\nd = 2\\n[[c]]\\nd = 3', ("a", "b", 1, "d"))
    4
    """
    counts: dict[str, int] = {}
    table: tuple[int | str, ...] = ()
    found: dict[tuple[int | str, ...], int] = {}
    inside: _Inline | None = None
    for number, raw in enumerate(text.splitlines(), start=1):
        row = _QUOTED.sub("''", raw)
        if inside is not None:
            inside.scan(row, number)
        elif header := _HEADER.match(row):
            name = header[2]
            table = tuple(name.split("."))
            if header[1] == "[[":
                counts[name] = counts.get(name, -1) + 1
                table = (*table, counts[name])
            found.setdefault(table, number)
        elif key := _KEY.match(row):
            found.setdefault((*table, key[1]), number)
            inside = _Inline((*table, key[1]), found)
            inside.scan(row[key.end() :], number)
        if inside is not None and inside.depth == 0:
            inside = None
    for length in range(len(path), 0, -1):
        if path[:length] in found:
            return found[path[:length]]
    return None


class _Inline:
    """Finds the lines of what stands inside one value: inline tables, and arrays of them."""

    def __init__(self, path: tuple[int | str, ...], found: dict[tuple[int | str, ...], int]) -> None:
        self._path, self._found = path, found
        self._brackets = self._braces = 0
        self._index = -1

    @property
    def depth(self) -> int:
        """How many brackets and braces are still open."""
        return self._brackets + self._braces

    def scan(self, row: str, number: int) -> None:
        """Take in one more line of the value."""
        for token in _TOKENS.finditer(row):
            mark = token[0]
            if mark in "[]":
                self._brackets += 1 if mark == "[" else -1
            elif mark in "{}":
                self._braces += 1 if mark == "{" else -1
                if mark == "{" and self._braces == 1 and self._brackets == 1:
                    self._index += 1
                    self._found.setdefault((*self._path, self._index), number)
            elif self._braces == 1:
                within = (self._index,) if self._index >= 0 else ()
                self._found.setdefault((*self._path, *within, token[1]), number)


def _known_keys(path: tuple[int | str, ...], loc: tuple[int | str, ...]) -> list[str]:
    """Return the keys that the table holding `path` may have; `loc` names the kind where tables have kinds."""
    models = _models_at(path)
    of_kind = [m for m in models if "kind" in m.model_fields and m.model_fields["kind"].annotation.__args__[0] in loc]
    return sorted({name for model in of_kind or models for name in model.model_fields})


def _models_at(path: tuple[int | str, ...]) -> list[Any]:
    """Return the models that the table holding `path` may follow."""
    models: list[Any] = [Scenario]
    for step in path[:-1]:
        if isinstance(step, str):
            models = [m for model in models for m in _models_in(model.model_fields[step].annotation)]
    return models


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    """Return the models that an annotation speaks of, however deeply wrapped."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in getattr(annotation, "__args__", ()) for model in _models_in(part)]
