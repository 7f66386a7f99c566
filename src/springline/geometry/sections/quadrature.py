"""One quadrature for everything that has no closed form: the double-exponential rule between smooth breaks.

Cross-sections are smooth between their hinges, corners and lobe edges, and what is hard about them (a crown hinge that
nearly touches O, a fractional power at a lobe's centre) sits at those breaks, which is where this rule has its nodes.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_REACH = 3.15  # where the weights fall below the last bit of the largest


@lru_cache(maxsize=8)
def rule(half: int = 60) -> tuple[Array, Array]:
    """Return nodes in [0, 1] and weights of the double-exponential (tanh-sinh) rule with 2 half + 1 nodes.

    Smooth integrands come out to about 1e-14 of their size; algebraic or logarithmic ends cost nothing.

    Source: Takahasi and Mori, Double exponential formulas for numerical integration, 1974.

    >>> node, weight = rule()
    >>> bool(abs(np.sum(weight * np.sqrt(node)) - 2 / 3) < 1e-15 * 10)
    True
    """
    step = _REACH / half
    t = step * np.arange(-half, half + 1)
    inner = np.pi / 2 * np.sinh(t)
    node = 1.0 / (1.0 + np.exp(-2.0 * inner))
    weight = step * np.pi / 4 * np.cosh(t) / np.cosh(inner) ** 2
    node.flags.writeable = weight.flags.writeable = False
    return node, weight


def spread(breaks: Array, half: int = 60) -> tuple[Array, Array]:
    """Return bearings and weights for one turn, piece by piece between the breaks.

    Args:
        breaks: (..., P): ascending within one turn [rad]; the last piece closes the turn.
        half: The rule's size.

    Returns:
        Bearings and weights, each (..., P n).

    >>> bearing, weight = spread(np.array([0.0, np.pi / 2]))
    >>> bool(abs(np.sum(weight * np.cos(bearing) ** 2) - np.pi) < 1e-13)
    True
    """
    node, weight = rule(half)
    span = np.diff(breaks, axis=-1, append=breaks[..., :1] + 2 * np.pi)
    bearing = breaks[..., None] + span[..., None] * node
    return flat(bearing), flat(span[..., None] * weight)


def flat(nodes: Array) -> Array:
    """Return (..., P, n) as (..., P n), also for an empty batch.

    >>> flat(np.zeros((0, 4, 3))).shape
    (0, 12)
    """
    return nodes.reshape(*nodes.shape[:-2], nodes.shape[-2] * nodes.shape[-1])
