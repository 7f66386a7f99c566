"""How sure a mark is: what chance alone would show, and what that leaves for the mark to be real."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import norm
from scipy.stats import t as student

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_TAILS = 12.0
"""Degrees of freedom of the tails: walls and robots have more far-off values than a normal distribution."""


def robust_sigma(values: ArrayLike) -> float:
    """Return the one-sigma of the bulk of the values: 1.4826 times the median distance from their median.

    >>> round(robust_sigma(np.append(np.random.default_rng(0).standard_normal(4001), [1e3] * 40)), 1)
    1.0
    """
    values = np.asarray(values, float)
    values = values[np.isfinite(values)]
    return float(1.4826 * np.median(np.abs(values - np.median(values)))) if len(values) else float("nan")


def threshold(false_alarms: float, looks: float, *, tails: float = _TAILS) -> float:
    """Return the score in sigmas that chance passes `false_alarms` times in `looks` independent looks.

    >>> round(threshold(0.01, 10_000, tails=np.inf), 2)
    4.75
    """
    share = min(false_alarms / max(looks, 1.0), 0.5)
    return float(student.isf(share, tails) if np.isfinite(tails) else norm.isf(share))


def confidence(score: ArrayLike, looks: float, *, expected: float, tails: float = _TAILS) -> NDArray[np.float64]:
    """Return the probability that a score is a mark and not chance.

    With F the false alarms that chance alone would bring at that score or higher, and E the marks that one may expect
    to be there, it is E / (E + F).

    Args:
        score: (mark,) in sigmas.
        looks: Independent looks at the wall.
        expected: Marks that one may expect.
        tails: Degrees of freedom of Student's t for chance.

    >>> confidence([4.0, 12.0], 1e4, expected=1.0).round(3).tolist()
    [0.102, 1.0]
    """
    false = looks * student.sf(np.asarray(score, float), tails)
    return expected / (expected + false)
