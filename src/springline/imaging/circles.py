"""Circles that one arc or two arcs together may belong to."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_MOST_ARCS = 60  # the longest; their pairs are all tried
_SHORTEST = 30  # points of an arc or a pair
_ALIGNED = 0.9  # cosine between edge and circle, median of an arc
_OFF = (1.5, 0.03)  # px, and share of the radius, that an arc may lie off the circle
_SMALLEST = 9.0  # px of radius
_LARGEST = 1.6  # diagonals of the frame


def smallest_radius() -> float:
    """Return the least radius [px] of a ring that is sought."""
    return _SMALLEST


def circles_of(arcs: Sequence[Array], diagonal: float, *, one_sense: bool = True) -> tuple[Array, Array]:
    """Return circles through single arcs and through pairs of arcs that fit one circle with the same sense.

    All pairs are fitted at once by Kasa's method from sums over each arc.

    Args:
        arcs: Arrays (n, 6) as of `smooth_arcs`.
        diagonal: Of the frame [px]; bounds the radius.
        one_sense: Whether the light must rise, or fall, outwards all round.

    Returns:
        Ellipses (m, 5) and their senses (m): +1 where the light rises outwards; 0 unless `one_sense`.
    """
    arcs = sorted(arcs, key=len, reverse=True)[:_MOST_ARCS]
    if not arcs:
        return np.zeros((0, 5)), np.zeros(0)
    origin = arcs[0][:, :2].mean(axis=0)
    sums = np.array([_sums(arc[:, :2] - origin) for arc in arcs])
    spots = np.array([arc[np.array([0, 1, 2, 3, 4]) * (len(arc) - 1) // 4, :4] for arc in arcs])
    spots[:, :, :2] -= origin
    one, other = np.triu_indices(len(arcs), 1)
    first, second = np.concatenate([np.arange(len(arcs)), one]), np.concatenate([np.arange(len(arcs)), other])
    total = np.where((first == second)[:, None], sums[first], sums[first] + sums[second])
    enough = total[:, 0] >= _SHORTEST
    first, second, total = first[enough], second[enough], total[enough]
    centre, radius = _kasa(total)
    with np.errstate(invalid="ignore"):
        fits = np.isfinite(radius) & (radius > _SMALLEST) & (radius < _LARGEST * diagonal)
        off_first, aligned_first = _off(spots[first], centre, radius)
        off_second, aligned_second = _off(spots[second], centre, radius)
        near = np.maximum(_OFF[0], _OFF[1] * np.clip(radius, 0.0, 120.0))
        fits &= (off_first < near) & (off_second < near)
        fits &= (np.abs(aligned_first) > _ALIGNED) & (np.abs(aligned_second) > _ALIGNED)
        if one_sense:
            fits &= aligned_first * aligned_second > 0
    circles = np.column_stack([centre + origin, radius, radius, np.zeros_like(radius)])
    return circles[fits], np.sign(aligned_first[fits]) * one_sense


def kasa_circle(points: Array) -> tuple[Array, float]:
    """Return centre (2) and radius of the circle through points (n, 2); NaN where they lie on a line."""
    middle = points.mean(axis=0)
    centre, radius = _kasa(_sums(points - middle)[None])
    return centre[0] + middle, float(radius[0])


def _sums(points: Array) -> Array:
    x, y = points.T
    z = x * x + y * y
    return np.array([len(x), x.sum(), y.sum(), z.sum(), x @ x, x @ y, y @ y, x @ z, y @ z])


def _kasa(sums: Array) -> tuple[Array, Array]:
    n, sx, sy, sz, sxx, sxy, syy, sxz, syz = sums.T
    mean_x, mean_y = sx / n, sy / n
    uu, uv, vv = sxx - n * mean_x**2, sxy - n * mean_x * mean_y, syy - n * mean_y**2
    square = mean_x**2 + mean_y**2
    z = sz - 2 * mean_x * sx - 2 * mean_y * sy + n * square
    uz = sxz - 2 * mean_x * sxx - 2 * mean_y * sxy + square * sx - mean_x * z
    vz = syz - 2 * mean_x * sxy - 2 * mean_y * syy + square * sy - mean_y * z
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = uu * vv - uv * uv
        a = 0.5 * (uz * vv - vz * uv) / determinant
        b = 0.5 * (vz * uu - uz * uv) / determinant
        return np.stack([a + mean_x, b + mean_y], axis=-1), np.sqrt(a * a + b * b + z / n)


def _off(spots: Array, centre: Array, radius: Array) -> tuple[Array, Array]:
    """How far all but the worst of five points of an arc lie off, and how the light rises there, signed cosine."""
    apart = spots[:, :, :2] - centre[:, None]
    distance = np.hypot(apart[..., 0], apart[..., 1])
    cosine = np.sum(apart * spots[:, :, 2:], axis=-1) / distance
    return np.sort(np.abs(distance - radius[:, None]), axis=1)[:, 3], np.median(cosine, axis=1)
