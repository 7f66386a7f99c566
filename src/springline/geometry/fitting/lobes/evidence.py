"""How often a ring without a lobe shows as much: the false-alarm rate of a likelihood ratio.

Without a lobe its bearing and half angle have no meaning, so that the ratio follows no chi-square: it is the largest of
many, one for every place and width. That maximum is the one of a Gaussian field over (bearing, half angle), whose tail
is the expected Euler characteristic of the set where the field exceeds it:

    P(max > c) = L1 exp(-c^2/2) / (2 pi) + L2 c exp(-c^2/2) / (2 pi)^(3/2),

where L2 is the area of the parameter space and L1 half the length of its two edges, both measured by how fast the
templates change (a ring has no further term: its own Euler characteristic is zero).
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from .wall import ANGLES, SMOOTH

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

_NODES = 1440


def false_alarm_rate(
    evidence: ArrayLike, freedom: ArrayLike, *, kind: int, power: float, host_known: bool
) -> NDArray[np.float64]:
    """Return the probability that a ring without a lobe gives at least this evidence for one.

    Args:
        evidence: Twice the gain in log-likelihood of the best lobe over none.
        freedom: Readings to spare, on which the noise was estimated.
        kind, power: Of the lobe.
        host_known: Whether the host was given.

    Source: Euler characteristic of the excursion sets of Gaussian fields (Adler; Siegmund and Worsley for templates).

    >>> rate = false_alarm_rate([0.0, 20.0, 40.0], 300, kind=SMOOTH, power=3.0, host_known=False)
    >>> [f"{r:.0e}" for r in rate]
    ['1e+00', '5e-03', '7e-07']
    """
    edges, area = field_size(kind, power, host_known)
    nu = np.maximum(np.asarray(freedom, float), 1.0)
    # with the noise estimated, c is as rare as this many sigmas of a normal number (Wallace)
    c = (8 * nu + 1) / (8 * nu + 3) * np.sqrt(nu * np.log1p(np.maximum(np.asarray(evidence, float), 0.0) / nu))
    tail = np.exp(-0.5 * c * c)
    rate = edges * tail / (2 * np.pi) + area * c * tail / (2 * np.pi) ** 1.5
    return np.where(c < 1.0, 1.0, np.minimum(rate, 1.0))


@lru_cache(maxsize=64)
def field_size(kind: int, power: float, host_known: bool) -> tuple[float, float]:
    """Return half the length of the edges and the area of (bearing, half angle), in the metric of the templates."""
    theta = (np.arange(_NODES) + 0.5) * 2 * np.pi / _NODES - np.pi
    loose = [np.cos(theta), np.sin(theta)]
    if not host_known:
        loose += [np.ones_like(theta), np.cos(2 * theta), np.sin(2 * theta)]
    loose = np.linalg.qr(np.stack(loose, axis=-1))[0]

    def template(phi: float, shift: float = 0.0) -> NDArray[np.float64]:
        x = np.minimum(np.abs(theta - shift) / phi, 1.0)
        shape = np.cos(np.pi / 2 * x)
        values = shape**power if kind == SMOOTH else (1.0 - x**power) * shape
        values = values - loose @ (loose.T @ values)
        return values / np.linalg.norm(values)

    step = 0.5 * (theta[1] - theta[0])
    half = np.linspace(*ANGLES, 200)
    turned = np.array([np.linalg.norm(template(p, step) - template(p, -step)) / (2 * step) for p in half])
    widened = np.array([np.linalg.norm(template(p + 1e-4) - template(p - 1e-4)) / 2e-4 for p in half])
    return float(np.pi * (turned[0] + turned[-1])), float(2 * np.pi * np.trapezoid(turned * widened, half))
