"""Acceptance rules as data: one TOML file each in `rules/`, or one of the user's own.

A rule is a limit, or classes by lower bounds, with its source, its edition and what is sure of it. A rule whose
figures could not be confirmed holds none and says why (`missing`).
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

from springline.errors import FormatError, ParameterError, nearest

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable


_KEYS = {
    "title",
    "quantity",
    "limit",
    "references",
    "source",
    "edition",
    "sure",
    "missing",
    "accuracy",
    "fail_at",
    "notes",
    "classes",
}
_NEEDED = ("title", "quantity", "references", "source", "edition", "sure")


@dataclass(frozen=True)
class Rule:
    """One acceptance rule.

    Attributes:
        name: Name by which it is asked for: the file's.
        title: What it is.
        quantity: Variable of `/metrics` that it judges, as a fraction.
        references: Reference diameters that it accepts, the preferred first.
        source: Where it is published.
        edition: Edition or state of that source.
        sure: What is confirmed of the figures here.
        limit: Largest passing value, or None for a rule by classes.
        classes: For each scope (`rigid`, `flexible`, `any`) the classes from worst to mildest with their lower bounds.
        fail_at: Mildest class that fails.
        accuracy: Relative accuracy that the rule asks of the measurement, or None.
        missing: Why the rule cannot be applied, or None.
        notes: What a reader should know.
    """

    name: str
    title: str
    quantity: str
    references: tuple[str, ...]
    source: str
    edition: str
    sure: str
    limit: float | None = None
    classes: dict[str, tuple[tuple[int, float], ...]] | None = None
    fail_at: int | None = None
    accuracy: float | None = None
    missing: str | None = None
    notes: tuple[str, ...] = ()

    def bounds(self, material: str | None) -> tuple[tuple[int, float], ...] | None:
        """Return the classes that hold for a material, or None when they depend on one that is not known."""
        if self.classes is None:
            return None
        return self.classes.get("any") or self.classes.get(material or "")


def rule_names() -> tuple[str, ...]:
    """Return the names of the rules that come with the program.

    >>> "deflection-5" in rule_names()
    True
    """
    return tuple(sorted(entry.name[:-5] for entry in _folder().iterdir() if entry.name.endswith(".toml")))


def load_rule(rule: str | Path) -> Rule:
    """Return a rule by its name, or from a file of the user's.

    Args:
        rule: Name, or path of a TOML file.

    Raises:
        ParameterError: No rule has that name.
        FormatError: The file is not TOML, lacks a key, or holds an unknown one.

    >>> load_rule("deflection-7.5").limit
    0.075
    """
    path = Path(rule)
    if path.suffix == ".toml":
        if not path.is_file():
            raise ParameterError(f"the rule file {path} does not exist", mend="give a path or one of the names")
        return _parse(path.stem, path.read_text(encoding="utf-8"), str(path))
    if str(rule) not in rule_names():
        raise ParameterError(
            f"rule = {str(rule)!r} is not known{nearest(str(rule), rule_names())}",
            expected="one of " + ", ".join(rule_names()),
            mend="or give the path of a TOML file",
        )
    return _parse(str(rule), (_folder() / f"{rule}.toml").read_text(encoding="utf-8"), f"{rule}.toml")


def _folder() -> Traversable:
    return files("springline.design") / "rules"


def _parse(name: str, text: str, where: str) -> Rule:
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as wrong:
        raise FormatError(f"not a TOML file: {wrong}", where=where) from wrong
    unknown = sorted(set(table) - _KEYS)
    if unknown:
        raise FormatError(
            f"unknown key {unknown[0]!r}{nearest(unknown[0], _KEYS)}", where=where, expected=", ".join(sorted(_KEYS))
        )
    lacking = [key for key in _NEEDED if key not in table]
    if lacking:
        raise FormatError(f"key {lacking[0]!r} is missing", where=where)
    if ("limit" in table) + ("classes" in table) + ("missing" in table) != 1:
        raise FormatError("a rule has either a limit, or classes, or says why it has none (missing)", where=where)
    table["references"] = tuple(table["references"])
    table["notes"] = tuple(table.get("notes", ()))
    if "classes" in table:
        table["classes"] = {entry["scope"]: _ordered(entry["lower"]) for entry in table["classes"]}
        if any(table.get("fail_at") not in dict(scope) for scope in table["classes"].values()):
            raise FormatError(f"fail_at = {table.get('fail_at')!r} is none of the classes", where=where)
    return Rule(name=name, **table)


def _ordered(lower: dict[str, float]) -> tuple[tuple[int, float], ...]:
    return tuple(sorted(((int(number), float(bound)) for number, bound in lower.items()), key=lambda pair: -pair[1]))
