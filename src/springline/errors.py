"""One tree of errors; each says what, where, what was expected and how to mend it.

The library raises, the command line explains: `springline.cli` turns every `SpringlineError` into one message
and exit code 2.
"""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path


class SpringlineError(Exception):
    """Base of every error that Springline raises on purpose.

    Args:
        what: What is wrong, in one sentence.
        where: File, row, column, ring or chainage at which it is wrong.
        expected: What was expected instead.
        mend: How to mend it.

    >>> str(SpringlineError("the cell 'abc' is not a number", where="rings.csv, row 3, column r_7"))
    "rings.csv, row 3, column r_7: the cell 'abc' is not a number"
    """

    def __init__(
        self,
        what: str,
        *,
        where: str | Path | None = None,
        expected: str | None = None,
        mend: str | None = None,
    ) -> None:
        self.what, self.where, self.expected, self.mend = what, where, expected, mend
        text = f"{where}: {what}" if where is not None else what
        if expected:
            text += f"; expected {expected}"
        if mend:
            text += f". {mend[0].upper()}{mend[1:]}"
        super().__init__(text)


class InputError(SpringlineError, ValueError):
    """A file, a table or an argument holds something that cannot be used."""


class ParameterError(InputError):
    """A parameter lies outside its valid range; the message names it, its value and the range."""


class FormatError(InputError):
    """A file's format is unknown, or its content does not follow its format."""


class ContractError(SpringlineError, ValueError):
    """A survey does not follow the data contract of `springline.conventions`."""


class MissingGroupError(ContractError, KeyError):
    """A survey lacks a group that was asked for; the message names the stage that makes it."""

    def __str__(self) -> str:
        return self.args[0]


class MissingExtraError(SpringlineError, ImportError):
    """An optional library is not installed; the message holds the install command."""

    @classmethod
    def of(cls, extra: str, needed_for: str) -> MissingExtraError:
        """Return the error for the optional-dependency group `extra`, wanted for `needed_for`.

        >>> print(MissingExtraError.of("las", "reading LAS and LAZ files"))
        reading LAS and LAZ files needs the extra 'las'. Install it with: pip install 'springline[las]'
        """
        return cls(
            f"{needed_for} needs the extra '{extra}'",
            mend=f"Install it with: pip install 'springline[{extra}]'",
        )


class OutputError(SpringlineError, OSError):
    """A result could not be written; nothing half-written is left behind."""

    def __str__(self) -> str:
        return self.args[0]


def nearest(name: str, known: Iterable[str]) -> str:
    """Return ", did you mean 'x'?" for the nearest of the `known` names, or an empty string.

    >>> nearest("nominal_diametre", ["name", "nominal_diameter"])
    ", did you mean 'nominal_diameter'?"
    """
    found = get_close_matches(name, list(known), n=1)
    return f", did you mean '{found[0]}'?" if found else ""


def listed(parts: Sequence[str], most: int, between: str = "; ") -> str:
    """Return the first `most` parts as one text, and how many more there are.

    >>> listed(["a.png (empty)", "b.png (cut short)", "c.png (empty)"], 2)
    'a.png (empty); b.png (cut short) and 1 more'
    """
    more = f" and {len(parts) - most} more" if len(parts) > most else ""
    return between.join(parts[:most]) + more
