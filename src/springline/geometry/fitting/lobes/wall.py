"""Lobed liners and their hosts, as the solver asks for them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .kernels import HOST, LOBE, PROPOSED, SMOOTH, lobed_radius

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

KINDS = {"proposed": PROPOSED, "smooth": SMOOTH}
"""Lobes that can be fitted, by name: the published one, and the recommended one that never leaves its host."""

DEFAULT_POWER = {PROPOSED: 2.0, SMOOTH: 3.0}

POWERS = {PROPOSED: (1.05, 12.0), SMOOTH: (2.0, 12.0)}
"""Powers that a lobe may have; at 1 the published lobe has a kink, below 2 the smooth one."""

ANGLES = (0.06, 1.6)
"""Half angles that a lobe may have [rad]: a few readings, and a little more than a quarter turn."""

_DEEPEST = 0.95
_SIZES = (0.1, 5.0)
_MOST_OVAL = 0.45


class LobeWall:
    """A liner with one lobe, or none: the coordinates are the host's where it is free, then the lobe's.

    Args:
        kind: One of `KINDS`.
        power: (N,) the power of each ring's lobe, where it is not free.
        host: (N, 3) the hosts, in units of the rings' size, where they are known.
        lobed: Whether there is a lobe.
        free_power: Whether the power is a coordinate.
    """

    def __init__(
        self, kind: int, power: Array, host: Array | None, *, lobed: bool = True, free_power: bool = False
    ) -> None:
        # without depth a smooth lobe is its host, the published one is not
        self._kind = kind if lobed else SMOOTH
        self._power, self._host = power, host
        self.hosts = 0 if host is not None else HOST
        self.lobes = (LOBE - 1 + free_power) if lobed else 0
        oval = (-_MOST_OVAL, _MOST_OVAL)
        lobe = [(-np.inf, np.inf), ANGLES, (0.0, _DEEPEST), POWERS[kind]]
        limits = np.array([*[_SIZES, oval, oval][: self.hosts], *lobe[: self.lobes]]).reshape(-1, 2)
        self.floor, self.ceiling = np.ascontiguousarray(limits.T)

    def prepare(self, coordinates: Array) -> tuple[NDArray[np.bool_], Array]:
        """Return all coordinates (R, K) as they are: floor and ceiling alone say what makes a liner."""
        return np.ones(len(coordinates), bool), coordinates

    def evaluate(self, rows, prepared, bearing, counts, radius, slope, by) -> None:
        """Fill radius, slope and derivatives; see `shapes.solve.Wall`."""
        first = HOST - self.hosts
        lobed_radius(rows, self._kind, self.numbers(rows, prepared), first, bearing, counts, radius, slope, by)

    def numbers(self, rows: NDArray[np.int64], coordinates: Array) -> Array:
        """Return host and lobe (R, HOST + LOBE) of some rings, from their coordinates (R, K)."""
        numbers = np.zeros((len(rows), HOST + LOBE))
        numbers[:, 4], numbers[:, 6] = 1.0, self._power[rows]
        numbers[:, :HOST] = coordinates[:, :HOST] if self._host is None else self._host[rows]
        numbers[:, HOST : HOST + self.lobes] = coordinates[:, self.hosts :]
        return numbers
