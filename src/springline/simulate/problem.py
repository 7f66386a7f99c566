"""What is wrong with a scenario, before it is known on which line of its file that stands."""

from __future__ import annotations

from typing import Any

Path = tuple[int | str, ...]


class Problem(Exception):
    """One thing wrong: where in the scenario, what value, and what was expected."""

    def __init__(self, path: Path, value: Any, expected: str, why: str = "") -> None:
        super().__init__(path, value, expected)
        self.path, self.value, self.expected, self.why = path, value, expected, why


def require(ok: bool, path: Path, value: Any, expected: str, why: str = "") -> None:
    """Raise a `Problem` unless `ok`."""
    if not ok:
        raise Problem(path, value, expected, why)
