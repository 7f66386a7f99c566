"""What a liner's shape claims about the liner: does it lie in its host, is it smooth, does it keep its length?"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import positive

from ...conventions import CROWN
from ...errors import ParameterError
from ..sections import quadrature
from ..sections.ellipses import perimeter
from ..sections.search import golden, maximise
from .hosts import host_arc, host_polar
from .lobes import Lobe, PolarLobe, SmoothLobe, each, half_angle

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from .lined import Liner

    Array = NDArray[np.float64]

_STEP = np.pi / 720  # of the bearings at which the search for a protrusion begins


@dataclass(frozen=True)
class Conformity:
    """How well a liner's shape conforms; arrays of the batch shape.

    Attributes:
        protrusion: Largest radial distance by which the liner lies outside its host; 0 where it touches at most.
        slope_jump: Largest jump of dr/dtheta at a joint, as an angle's tangent: over the radius there.
        curvature_jump: Largest jump of the curvature at a joint [1/length].
        stretch: The liner's length over the host's perimeter, less 1.
        inside, slope_continuous, curvature_continuous, length_conserved: The four verdicts.
    """

    protrusion: Array
    slope_jump: Array
    curvature_jump: Array
    stretch: Array
    inside: NDArray[np.bool_]
    slope_continuous: NDArray[np.bool_]
    curvature_continuous: NDArray[np.bool_]
    length_conserved: NDArray[np.bool_]


def conformity(liner: Liner, *, tolerance: float = 1e-9) -> Conformity:
    """Return whether liners lie inside their host, are smooth, and keep the length of the host's perimeter.

    Args:
        liner: One liner or a batch.
        tolerance: Relative to the host's mean radius, and of the stretch itself.

    Source: errata A3, A4, A5 on what chapter 7 claims.

    >>> from springline.geometry.liners import lobed
    >>> found = conformity(lobed(12.0, 10.0, np.pi / 6, 8.0))
    >>> bool(found.inside), bool(found.slope_continuous), bool(found.curvature_continuous), bool(found.length_conserved)
    (True, True, False, False)
    """
    scale = np.sqrt(liner.r1 * liner.r2)
    joints = liner.joints()
    at = host_polar(joints.bearing, liner.r1[..., None], liner.r2[..., None])[0]
    slope = np.max(np.abs(joints.slope) / at, axis=-1, initial=0.0)
    curvature = np.max(np.abs(joints.curvature), axis=-1, initial=0.0)
    outside = _outside(liner)
    stretch = liner.perimeter / perimeter(liner.r1, liner.r2) - 1.0
    return Conformity(
        outside,
        slope,
        curvature,
        stretch,
        outside <= tolerance * scale,
        slope <= tolerance,
        curvature * scale <= tolerance,
        np.abs(stretch) <= tolerance,
    )


def _raised(lobe: PolarLobe, r1: ArrayLike, r2: ArrayLike) -> tuple[Array, Array, PolarLobe]:
    """Return host and lobe with an axis for places along the lobe."""
    r1, r2 = (np.asarray(r, float)[..., None] for r in (r1, r2))
    return r1, r2, each(lobe, lambda number: number[..., None])


def _outside(liner: Liner) -> Array:
    breaks = liner.breaks
    turn = np.arange(0.0, 2 * np.pi, _STEP)
    # a lobe that protrudes does so close to its edges, where the grid must be dense
    node = quadrature.rule(20)[0]
    span = np.diff(breaks, axis=-1, append=breaks[..., :1] + 2 * np.pi)
    dense = quadrature.flat(breaks[..., None] + span[..., None] * node)
    grid = np.concatenate([np.broadcast_to(turn, (*breaks.shape[:-1], turn.size)), dense], axis=-1)

    def leaving(theta: Array) -> Array:
        return liner.polar_radius(theta) - liner.host_radius(theta)

    return np.maximum(maximise(leaving, grid, leaving(grid)[..., None, :], _STEP)[0][..., 0], 0.0)


def lobe_protrusion(lobe: PolarLobe, r1: ArrayLike, r2: ArrayLike) -> Array:
    """Return the largest amount by which a lobe lies outside its host; 0 when only its edges touch.

    Args:
        lobe: The lobe.
        r1, r2: The host's semi-axes along z and y.

    Source: errata A4.

    >>> round(float(lobe_protrusion(Lobe(np.pi / 3, 9.9), 12.0, 10.0)), 9)
    0.000225681
    """
    node = quadrature.rule()[0]
    r1, r2, held = _raised(lobe, r1, r2)
    shape = np.broadcast_shapes(*(x.shape[:-1] for x in (r1, r2, *vars(held).values())))
    worst = np.zeros(shape)
    for side in (-1.0, 1.0):

        def leaving(x: Array, side: float = side) -> Array:
            offset = side * x * held.phi
            return held.polar(offset, r1, r2, side=side)[0] - host_polar(held.bearing + offset, r1, r2)[0]

        best = np.clip(np.argmax(leaving(node), axis=-1, keepdims=True), 1, node.size - 2)
        value, _ = golden(leaving, node[best - 1], node[best + 1])
        worst = np.maximum(worst, value[..., 0])
    return worst


def lobe_arc(lobe: PolarLobe, r1: ArrayLike, r2: ArrayLike) -> Array:
    """Return the length of a lobe between its edges.

    >>> round(float(lobe_arc(Lobe(np.pi / 6, 8.0), 12.0, 10.0)), 9)
    10.82689677
    """
    node, weight = quadrature.rule()
    r1, r2, held = _raised(lobe, r1, r2)
    total = 0.0
    for side in (-1.0, 1.0):
        radius, slope, _ = held.polar(side * held.phi * node, r1, r2, side=side)
        total = total + held.phi[..., 0] * np.sum(weight * np.hypot(radius, slope), axis=-1)
    return total


def confined_oc(r1: ArrayLike, r2: ArrayLike, phi: ArrayLike, p: ArrayLike = 2.0, bearing: ArrayLike = CROWN) -> Array:
    """Return the largest oc at which the proposed lobe starts inside its host at both edges: necessary, not sufficient.

    Args:
        r1, r2: The host's semi-axes along z and y.
        phi, p, bearing: As for `Lobe`.

    Source: errata A4.

    >>> round(float(confined_oc(12.0, 10.0, np.pi / 6)), 9)
    10.011509245
    """
    phi, p = half_angle(phi), positive("p", p)
    limits = []
    for side in (-1.0, 1.0):
        edge, slope, second = host_polar(bearing + side * phi, r1, r2)
        limits.append(edge - 2.0 * phi * side * slope / np.pi + phi**2 * second / (p * np.pi))
    return np.minimum(*limits)


def conserving_oc(
    r1: ArrayLike, r2: ArrayLike, phi: ArrayLike, p: ArrayLike = 2.0, bearing: ArrayLike = CROWN
) -> Array:
    """Return the oc of the proposed lobe that is as long as the host's arc behind it: no stretch, no slip.

    Args:
        r1, r2: The host's semi-axes along z and y.
        phi, p, bearing: As for `Lobe`.

    Returns:
        The oc of the deep branch, between 0 and the host's radius at the lobe's centre.

    Raises:
        ParameterError: The lobe is so wide that even through the host's centre it is shorter than the host's arc.

    Source: errata A5 and E.

    >>> conserving_oc(12.0, 10.0, np.radians([15, 30, 45])).round(3).tolist()
    [9.597, 8.38, 6.38]
    """
    return _conserving(Lobe, r1, r2, phi, p, bearing)


def conserving_smooth_oc(
    r1: ArrayLike, r2: ArrayLike, phi: ArrayLike, n: ArrayLike = 3.0, bearing: ArrayLike = CROWN
) -> Array:
    """Return the oc of the smooth lobe that is as long as the host's arc behind it; as `conserving_oc`.

    With n above 2 this lobe lies in its host, is curvature-continuous, and keeps the liner's length.

    >>> round(float(conserving_smooth_oc(10.0, 10.0, 0.5)), 6)
    8.507166
    """
    return _conserving(SmoothLobe, r1, r2, phi, n, bearing)


def _conserving(
    build: Callable[..., PolarLobe], r1: ArrayLike, r2: ArrayLike, phi: ArrayLike, power: ArrayLike, bearing: ArrayLike
) -> Array:
    r1, r2, phi, power, bearing = np.broadcast_arrays(
        positive("r1", r1), positive("r2", r2), half_angle(phi), np.asarray(power, float), bearing
    )
    full = host_polar(bearing, r1, r2)[0]
    wanted = host_arc(bearing - phi, bearing + phi, r1, r2)

    def too_long(depth: Array) -> Array:
        return lobe_arc(build(phi, full * (1.0 - depth), power, bearing), r1, r2) - wanted

    # from the deepest lobe up: the first depth at which it is no longer too long has the root below it
    depths = 1.0 - np.geomspace(1e-9, 1.0, 40)[:-1]
    depths = np.concatenate([depths, np.geomspace(depths[-1], 1e-12, 60)[1:]])
    deep, shallow = np.full(full.shape, np.nan), np.full(full.shape, np.nan)
    for one, other in pairwise(depths):
        crossing = np.isnan(deep) & (too_long(np.full(full.shape, one)) > 0.0)
        crossing &= too_long(np.full(full.shape, other)) <= 0.0
        deep, shallow = np.where(crossing, one, deep), np.where(crossing, other, shallow)
        if not np.isnan(deep).any():
            break
    none = np.isnan(deep) & ~np.isnan(full + phi + power)
    if none.any():
        raise ParameterError(
            f"phi = {phi[none].flat[0]:.10g} is too wide for a lobe that keeps its length",
            expected="a lobe that, drawn down to the host's centre, is longer than the host's arc",
        )
    for _ in range(60):
        middle = 0.5 * (deep + shallow)
        long = too_long(middle) > 0.0
        deep, shallow = np.where(long, middle, deep), np.where(long, shallow, middle)
    return full * (1.0 - 0.5 * (deep + shallow))
