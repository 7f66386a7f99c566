"""What a reproduced figure is: its drawing, a note, and each statement of the text about it, checked."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log10

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Check:
    """A statement of the text about a figure, and what comes out here.

    Attributes:
        statement: What is stated.
        printed: The printed value; empty where the text gives no number.
        found: What is found.
        holds: Whether the statement holds, to the digits in which it is printed.
        why: Where it does not hold, the reason.
    """

    statement: str
    printed: str
    found: str
    holds: bool
    why: str = ""


@dataclass(frozen=True)
class Figure:
    """A figure made again.

    Attributes:
        number: As cited in the text, such as "5.6"; chapters 3, 5 and 7 print it as 0.6.
        title: What it shows.
        svg: A whole SVG document.
        note: Where the published figure is wrong and why, or what is drawn beyond it.
        checks: The text's statements.
    """

    number: str
    title: str
    svg: str
    note: str
    checks: tuple[Check, ...] = ()


def below(value: float) -> str:
    """Return the power of ten that a small number stays below, as text; rounding then does not show.

    >>> below(4.4e-10), below(1e-16)
    ('10⁻⁹', '10⁻¹²')
    """
    exponent = max(ceil(log10(max(value, 1e-300))), -12)
    return "10" + str(exponent).translate(_RAISED)
