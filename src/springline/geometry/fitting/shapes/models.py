"""Families as a fit sees them: coordinates that are at least zero, chains of pieces, and where to start.

The limits of a family's parameters depend on each other (an egg is wider than twice its invert radius, a bottom arc
froze after the top one). They are all linear, so that each family has as many room coordinates as parameters, none of
which may fall below its floor, and parameters follow from them by a matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import choice

from ...sections import FAMILIES, SHAPES
from ...sections.severity import chord, hinge_table
from .chains import chain_of_hinges, chain_of_pieces

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

OPEN = 1e-3
"""Floor of a coordinate whose zero is no section any more, over the pipe's mean radius."""

LEAST_CROWN = 0.02
"""Least height of the crown above O that a hinged section may have, over its radius."""


@dataclass(frozen=True, eq=False)
class Model:
    """A family of sections made of arcs and lines, for fits.

    Attributes:
        name: Its name.
        parameters: Names of its parameters, K of them.
        limits: What each coordinate's floor means.
        matrix: (K, K): parameters = offset + matrix @ coordinates.
        offset: (K,).
        floor: (K,) least value of each coordinate.
        lengths: (K,) which parameters, and which coordinates, are lengths; the others have no unit.
        straight: (P,) which pieces are lines.
        chain: Makes (N, P, FIELDS) from (N, K) parameters.
        valid: Whether (N, K) parameters make a section, as far as the floors alone do not say.
        starts: (S, K) parameters to start from, of any size.
    """

    name: str
    parameters: tuple[str, ...]
    limits: tuple[str, ...]
    matrix: Array
    offset: Array
    floor: Array
    lengths: NDArray[np.bool_]
    straight: NDArray[np.bool_]
    chain: Callable[[Array], Array]
    valid: Callable[[Array], NDArray[np.bool_]]
    starts: Array

    def parameters_of(self, coordinates: Array) -> Array:
        """Return parameters (..., K) of coordinates (..., K)."""
        return self.offset + coordinates @ self.matrix.T

    def coordinates_of(self, parameters: Array) -> Array:
        """Return coordinates (..., K) of parameters (..., K), raised to their floors."""
        return np.maximum((parameters - self.offset) @ np.linalg.inv(self.matrix).T, self.floor)

    def chain_at(self, coordinates: Array) -> Array:
        """Return the chains (N, P, FIELDS) of coordinates (N, K)."""
        return self.chain(self.parameters_of(coordinates))


# Rows: the limit's meaning, whether its zero is a section, and the parameters it is made of.
_ROOMS = {
    "egg": (
        ("invert_radius < width/2", False, (1, 0, -2)),
        ("height >= width", True, (-1, 1, 0)),
        ("invert_radius > 0", False, (0, 0, 1)),
    ),
    "horseshoe": (("diameter > 0", False, (1,)),),
    "loaf": (("fillet <= width/2", True, (1, 0, -2)), ("wall >= 0", True, (0, 1, 0)), ("fillet > 0", False, (0, 0, 1))),
    "arch": (("rise <= width/2", True, (1, -2, 0)), ("rise > 0", False, (0, 1, 0)), ("wall >= 0", True, (0, 0, 1))),
    "box": (
        ("fillet <= width/2", False, (1, 0, -2)),
        ("fillet <= height/2", False, (0, 1, -2)),
        ("fillet >= 0", True, (0, 0, 1)),
    ),
}

_ALIASES = {"new egg": "egg", "inverted horseshoe": "horseshoe"}

_STARTS = {
    "egg": list(product((1.0,), (1.15, 1.5, 1.85), (0.1, 0.25, 0.4))),
    "horseshoe": [(1.0,)],
    "loaf": list(product((1.0,), (0.1, 0.3, 0.6, 1.0), (0.05, 0.15, 0.35))),
    "arch": list(product((1.0,), (0.15, 0.3, 0.45), (0.1, 0.4, 0.8, 1.3))),
    "box": list(product((1.0,), (0.5, 0.75, 1.0, 1.4, 2.0), (0.05, 0.15))),
}

_SEVERITIES = (0.97, 0.93, 0.87, 0.8, 0.7)
_SHARES = {
    4: [(1.0, 1.0 - f) for f in (0.1, 0.5, 0.9)],
    5: [(1.0, 1.0 - f, 1.0 - g) for f, g in ((0.5, 0.05), (0.95, 0.05), (0.95, 0.5), (0.7, 0.3))],
}

MODELS = tuple(name for name in FAMILIES if name not in ("circle", "ellipse"))
"""Names of the families that can be fitted; circles and ellipses have fits of their own, `fitting.fit_ellipses`."""


@lru_cache(maxsize=32)
def model_of(name: str) -> Model:
    """Return the model of a listed family; ParameterError names the known ones.

    >>> model_of("egg").limits
    ('invert_radius < width/2', 'height >= width', 'invert_radius > 0')
    """
    choice("family", name, MODELS)
    return _mode_model(int(name[5:])) if name.startswith("mode ") else _shape_model(name)


def _shape_model(name: str) -> Model:
    family, key = FAMILIES[name], _ALIASES.get(name, name)
    rooms, starts = _ROOMS.get(key), np.array(_STARTS.get(key, [SHAPES[name].example]), float)
    if rooms is None:
        # a shape that is listed without rooms: its numbers are above zero, and its builder refuses what else is wrong
        rooms = [(f"{p} > 0", False, row) for p, row in zip(family.parameters, np.eye(starts.shape[1]), strict=True)]
    meanings, closed, rows = zip(*rooms, strict=True)

    def chain(parameters: Array) -> Array:
        return chain_of_pieces(family.section(parameters).pieces)

    return Model(
        name=name,
        parameters=family.parameters,
        limits=meanings,
        matrix=np.linalg.inv(np.array(rows, float)),
        offset=np.zeros(len(rows)),
        floor=np.where(closed, 0.0, OPEN),
        lengths=np.ones(len(rows), bool),
        straight=family.section(starts).pieces.straight,
        chain=chain,
        valid=lambda parameters: np.isfinite(parameters).all(axis=-1),
        starts=starts,
    )


def _mode_model(mode: int) -> Model:
    family = FAMILIES[f"mode {mode}"]
    # parameters r, s1, s02, s01; rooms below 1 and between the severities in their order s1 <= s01 <= s02 <= 1
    rows, limits = [[1.0, 0.0, 0.0, 0.0]], ["r > 0"]
    order = {4: [(2, 1)], 5: [(3, 1), (2, 3)]}.get(mode, [])
    for above, below in order:
        row = [0.0] * 4
        row[above], row[below] = 1.0, -1.0
        rows.append(row)
        limits.append(f"{family.parameters[below]} <= {family.parameters[above]}")
    top = 2 if mode >= 4 else 1
    rows.append([-1.0 if k == top else 0.0 for k in range(4)])
    limits.append(f"{family.parameters[top]} <= 1")
    count = len(family.parameters)
    matrix = np.linalg.inv(np.array(rows)[:, :count])
    offset = np.zeros(count)
    offset[1:] = 1.0
    shares = _SHARES.get(mode, [(1.0,)])
    starts = [(1.0, *(1.0 - (1.0 - s) * np.array(share))) for s, share in product(_SEVERITIES, shares)]
    return Model(
        name=family.name,
        parameters=family.parameters,
        limits=tuple(limits),
        matrix=matrix,
        offset=offset,
        floor=np.array([OPEN] + [0.0] * (count - 1)),
        lengths=np.arange(count) == 0,
        straight=np.zeros(4, bool),
        chain=lambda p: chain_of_hinges(p[:, 0], hinge_table(*_severities(mode, p), rule="exact")),
        valid=lambda p: _hinges_exist(*_severities(mode, p)),
        starts=np.array([start for start in starts if _hinges_exist(*_severities(mode, np.array([start])))[0]]),
    )


def _severities(mode: int, parameters: Array) -> tuple[Array, Array, Array]:
    """Return s1, s02, s01 as `hinge_table` takes them."""
    s1 = parameters[:, 1]
    top = s1 if mode == 1 else np.ones_like(s1) if mode <= 3 else parameters[:, 2]
    bottom = np.ones_like(s1) if mode == 2 else parameters[:, 3] if mode == 5 else s1
    return s1, top, bottom


def _hinges_exist(s1: Array, s02: Array, s01: Array) -> NDArray[np.bool_]:
    """Return whether both halves reach the same springline with their crowns above O."""
    here = np.isfinite(s1 + s02 + s01) & (np.minimum(np.minimum(s1, s02), s01) > LEAST_CROWN)
    here &= np.maximum(np.maximum(s1, s02), s01) <= 1.0 + 1e-9
    crown = np.full(s1.shape, np.nan)
    top, bottom = (np.minimum(s[here], 1.0) for s in (s02, s01))
    crown[here] = chord(top) ** 2 - chord(bottom) ** 2 + s1[here] ** 2
    return crown > LEAST_CROWN**2
