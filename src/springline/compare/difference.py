"""The difference of two walls on one chainage: B less A, what the instruments differ by taken away and kept."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import (
    binary_dilation,
    maximum_filter,
    median_filter,
    minimum_filter,
    uniform_filter,
    uniform_filter1d,
)

from ..geometry.measures import polar_radius
from .texture import sample

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .registration import Registration
    from .wall import Wall

_SHAPE = 1.5  # m over which orders 0 to 2 of the difference are shape, told by diameters, not patches
_LOCAL = 1.0  # m over which the scatter is taken
_EDGE = 7.0  # scatters that neighbours differ by at an edge
_JOINT_LENGTH = 0.05  # m: what stands out all round over no more than this is a joint
_JOINT_SIGMAS = 6.0
_FAR, _FAR_SHARE = 5.0, 0.03  # scatters, and the share of a ring's readings so far off that a short event is a joint
_NEAR_JOINT = 2  # rows beside a joint that are left out with it
_CLEAR = 1.0  # scatters of a cell, by which the mean of 25 stands out five times as far
_SPIKE = 4.5  # scatters
_RIM = 4  # cells beside an opening that its rim may reach
_LEAST_NOISE = 0.1  # of the readings' scatter: no cell is surer, however alike two maps are
_LEAST_NOISE = 0.1  # of the readings' scatter: no cell is surer, however alike two maps are
_PATTERN_LENGTH = 5.0  # m from which a pattern that all rings share can be told from a patch

COMPARED, UNSEEN_A, UNSEEN_B, EDGE, UNPLACED, SPIKE = 0, 1, 2, 3, 4, 5
WHY_NOT = {
    COMPARED: "compared",
    UNSEEN_A: "not seen in A",
    UNSEEN_B: "not seen in B",
    EDGE: "an edge of the wall: joint, lateral or step",
    UNPLACED: "place in B not certain",
    SPIKE: "a lone reading far off",
}
"""Why a cell of the difference map has a value (0) or none."""


@dataclass(frozen=True)
class Difference:
    """How far the wall of B stands outside that of A.

    Attributes:
        chainage: (n,) in A [m], equal steps.
        chainage_b: (n,) in B [m]; NaN where it has no place.
        bearing: (m,) [rad], in A's frame.
        wall_a: (n, m) departure of A's wall from its fitted section [m]; NaN where unseen.
        wall_b: (n, m) the same of B, in A's place and frame.
        change: (n, m) radius of B less that of A [m], outward positive, without scale, pattern and slow shape; NaN
            where it cannot be told.
        sigma: (n, m) one-sigma of a cell [m].
        why: (n, m) flags of `WHY_NOT`, uint8.
        scale: Ranges of B over those of A, less one; what a change of all diameters alike would show too.
        scale_sigma: Its one-sigma.
        pattern: (m,) change that all rings share [m], which a sensor's error and a wall worn alike over the whole
            length both show; 0 when the pipe is too short to tell.
        fine: (n,) whether the relief placed the row.
        radius: Usual radius of the pipe [m].
    """

    chainage: NDArray[np.float64]
    chainage_b: NDArray[np.float64]
    bearing: NDArray[np.float64]
    wall_a: NDArray[np.float32]
    wall_b: NDArray[np.float32]
    change: NDArray[np.float32]
    sigma: NDArray[np.float32]
    why: NDArray[np.uint8]
    scale: float
    scale_sigma: float
    pattern: NDArray[np.float64]
    fine: NDArray[np.bool_]
    radius: float = 0.0

    @property
    def step(self) -> float:
        """Distance between rows [m]."""
        return float(self.chainage[1] - self.chainage[0]) if len(self.chainage) > 1 else 0.0


def difference(a: Wall, b: Wall, placed: Registration) -> Difference:
    """Return the difference of two walls.

    Sections are compared about their own middles, so that neither sensor's place in the pipe matters. The common scale
    of the ranges is taken from the ratio of mean radii; the orders 0 to 2 of each ring, averaged over 1.5 m, are left
    to the diameters; a pattern that all rings share is taken away and kept.

    Args:
        a: Wall of the first inspection.
        b: Wall of the second, as driven.
        placed: Where A's rings lie in B.
    """
    turned = b.mirrored(placed.extent_b) if placed.reversed else b
    rows = min(a.surface.shape[1], b.surface.shape[1])
    bearing = np.arange(rows) * (2 * np.pi / rows)
    step = max(a.spacing, b.spacing)
    x = np.arange(a.extent[0], a.extent[1] + 0.5 * step, step)
    y = placed.at(x)[0]
    own = sum(placed.extent_b) - y if placed.reversed else y
    wall_a, seen_a = _coarser(*sample(a.chainage, a.surface, x, 3.0 * step), rows)
    wall_b, seen_b = _coarser(*sample(turned.chainage, turned.surface, np.nan_to_num(own, nan=-1e9), 3.0 * step), rows)
    wall_b, seen_b = _rolled(wall_b, seen_b, placed.roll_at(x))
    section_a = _sections(a, x)
    section_b = _turn(_sections(turned, own), placed.roll_at(x))
    scale, scale_sigma = _scale(section_a[:, 0], section_b[:, 0])
    radius = [polar_radius(p[:, None, :], bearing) for p in (section_a, section_b)]
    change = (radius[1] + wall_b) / (1.0 + scale) - (radius[0] + wall_a)
    joint = _joints(wall_a, seen_a, section_a, step) | _joints(wall_b, seen_b, section_b, step)
    rim = _rims(a, x, rows, None) | _rims(turned, own, rows, placed.roll_at(x))
    why = _why(wall_a, wall_b, seen_a, seen_b, rim | joint[:, None], placed.reliable(x))
    change = np.where(why == COMPARED, change, np.nan).astype(np.float32)
    spike = _spikes(change, step)
    why[spike], change[spike] = SPIKE, np.nan
    change = _without_shape(change, bearing, step)
    pattern = _pattern(change, float(x[-1] - x[0]))
    change -= pattern.astype(np.float32)
    sigma = np.maximum(_local_sigma(change, step), np.float32(_LEAST_NOISE * np.hypot(a.noise, b.noise)))
    return Difference(
        chainage=x, chainage_b=y, bearing=bearing,
        wall_a=np.where(seen_a, wall_a, np.nan).astype(np.float32),
        wall_b=np.where(seen_b, wall_b, np.nan).astype(np.float32),
        change=change, sigma=sigma, why=why, scale=scale, scale_sigma=scale_sigma,
        pattern=pattern, fine=placed.refined_at(x), radius=a.radius,
    )  # fmt: skip


def _coarser(values: NDArray, seen: NDArray, rows: int) -> tuple[NDArray, NDArray]:
    """Return cells (n, rows) nearest to those of a finer circle."""
    if values.shape[1] == rows:
        return values, seen
    at = np.rint(np.arange(rows) * (values.shape[1] / rows)).astype(int)
    return values[:, at], seen[:, at]


def _rolled(values: NDArray, seen: NDArray, roll: NDArray) -> tuple[NDArray, NDArray]:
    """Return values (n, m) turned by roll (n,) [rad], between cells by the line."""
    m = values.shape[1]
    shift = -roll * m / (2 * np.pi)
    whole = np.floor(shift).astype(int)
    part = (shift - whole)[:, None].astype(np.float32)
    first = (np.arange(m)[None, :] + whole[:, None]) % m
    second = (first + 1) % m
    take = np.take_along_axis
    near, far = take(seen, first, 1), take(seen, second, 1)
    return (1 - part) * take(values, first, 1) + part * take(values, second, 1), near & far


def _sections(wall: Wall, x: NDArray) -> NDArray[np.float64]:
    """Return section parameters (n, 3) at chainage x [m], NaN where the rings beside have none."""
    return np.column_stack([np.interp(x, wall.chainage, p, left=np.nan, right=np.nan) for p in wall.parameters.T])


def _turn(parameters: NDArray, roll: NDArray) -> NDArray[np.float64]:
    mean, c, s = parameters.T
    cos, sin = np.cos(2 * roll), np.sin(2 * roll)
    return np.column_stack((mean, c * cos - s * sin, c * sin + s * cos))


def _scale(a: NDArray, b: NDArray) -> tuple[float, float]:
    """Return the ratio of mean radii less one, and its one-sigma."""
    ratio = b / a
    ratio = ratio[np.isfinite(ratio)]
    if not ratio.size:
        return 0.0, float("inf")
    middle = float(np.median(ratio))
    scatter = 1.4826 * float(np.median(np.abs(ratio - middle)))
    return middle - 1.0, 1.2533 * scatter / np.sqrt(ratio.size)


def _joints(wall: NDArray, seen: NDArray, section: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the rows (n,) that stand out from those beside them, over so short a way that they are a joint."""
    square = np.where(seen, wall, 0.0).astype(float) ** 2
    power = np.log(square.sum(axis=1) / np.maximum(seen.sum(axis=1), 1) + 1e-14)
    width = 2 * round(0.5 * _LOCAL / step) + 1
    out = np.zeros(len(wall), bool)
    for values in (power, np.nan_to_num(section[:, 0], nan=np.nanmedian(section[:, 0]))):
        off = values - median_filter(values, width, mode="nearest")
        out |= np.abs(off) > _JOINT_SIGMAS * 1.4826 * max(float(np.median(np.abs(off))), 1e-9)
    scatter = 1.4826 * float(np.median(np.abs(wall[seen]))) if seen.any() else np.inf
    out |= (np.abs(wall) > _FAR * scatter).mean(axis=1) > _FAR_SHARE
    edges = np.flatnonzero(np.diff(np.concatenate(([False], out, [False]))))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if (last - first) * step > max(_JOINT_LENGTH, 3 * step):
            out[first:last] = False
    return binary_dilation(out, np.ones(2 * _NEAR_JOINT + 1, bool))


def _rims(wall: Wall, x: NDArray, rows: int, roll: NDArray | None) -> NDArray[np.bool_]:
    """Return the cells (n, rows) in and beside the openings of a wall, at its own chainage x [m]."""
    ring = np.abs(wall.chainage[np.clip(np.searchsorted(wall.chainage, x), 1, len(wall.chainage) - 1)] - x)
    at = np.clip(np.searchsorted(wall.chainage, x), 1, len(wall.chainage) - 1)
    at -= np.abs(wall.chainage[at - 1] - np.nan_to_num(x, nan=-1e9)) < np.nan_to_num(ring, nan=1e9)
    hole, _ = _coarser(wall.opening[at], wall.opening[at], rows)
    if roll is not None:
        shift = np.rint(roll * rows / (2 * np.pi)).astype(int)
        hole = np.take_along_axis(hole, (np.arange(rows)[None, :] - shift[:, None]) % rows, 1)
    wide = np.pad(hole, ((0, 0), (_RIM, _RIM)), mode="wrap")
    return binary_dilation(wide, np.ones((2 * _RIM + 1, 2 * _RIM + 1), bool))[:, _RIM:-_RIM]


def _why(
    wall_a: NDArray, wall_b: NDArray, seen_a: NDArray, seen_b: NDArray, edge_of: NDArray, good: NDArray
) -> NDArray[np.uint8]:
    """Return why each cell is compared or not."""
    edges = []
    for wall, seen in ((wall_a, seen_a), (wall_b, seen_b)):
        scatter = 1.4826 * float(np.median(np.abs(wall[seen]))) if seen.any() else np.inf
        size, mode = (3, 3), ("nearest", "wrap")
        spread = maximum_filter(wall, size, mode=mode) - minimum_filter(wall, size, mode=mode)
        edge = np.pad(spread > _EDGE * max(scatter, 1e-5), ((0, 0), (2, 2)), mode="wrap")
        edges.append(binary_dilation(edge, np.ones((5, 3), bool))[:, 2:-2])
    why = np.full(wall_a.shape, COMPARED, np.uint8)
    # What only one of both shows is a change, not a place where the least misfit shows as one.
    why[(edges[0] & edges[1]) | edge_of] = EDGE
    why[~seen_b] = UNSEEN_B
    why[~seen_a] = UNSEEN_A
    why[~good] = UNPLACED
    return why


def _spikes(change: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the cells that stand far off their eight neighbours: no wall does that, stray readings do."""
    sigma = _local_sigma(change, step)
    near = median_filter(np.pad(np.nan_to_num(change), ((0, 0), (1, 1)), mode="wrap"), 3, mode="nearest")[:, 1:-1]
    with np.errstate(invalid="ignore"):
        return np.abs(change - near) > _SPIKE * sigma


def _without_shape(change: NDArray, bearing: NDArray, step: float) -> NDArray[np.float32]:
    """Return the change without the first order of each ring, and without orders 0 and 2 averaged along the pipe.

    The first order is where the section's middle was put; a ring says nothing of it.
    """
    waves = np.column_stack([np.ones_like(bearing), *(f(k * bearing) for k in (1, 2) for f in (np.cos, np.sin))])
    own = _orders(change, waves, 1)
    centred = change - own[:, 1:3] @ waves[:, 1:3].T
    width = max(3, round(_SHAPE / step))
    slow = _orders(np.where(_marked(centred, step), np.nan, centred), waves, width)
    return (centred - slow @ waves.T).astype(np.float32)


def _marked(change: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the cells that with those about them stand clear of the rest: what is there would raise its neighbours."""
    near = uniform_filter(np.pad(np.nan_to_num(change), ((0, 0), (2, 2)), mode="wrap"), 5, mode="nearest")[:, 2:-2]
    with np.errstate(invalid="ignore"):
        return np.abs(near) > _CLEAR * _local_sigma(change, step)


def _orders(change: NDArray, waves: NDArray, width: int) -> NDArray[np.float64]:
    """Return the orders 0 to 2 (n, 5) of each ring by least squares over `width` rings."""
    seen = np.isfinite(change)
    right = np.where(seen, change, 0.0).astype(float) @ waves
    products = (waves[:, :, None] * waves[:, None, :]).reshape(len(waves), -1)
    left = seen.astype(float) @ products
    if width > 1:
        right, left = (uniform_filter1d(part, width, axis=0, mode="constant") for part in (right, left))
    left = left.reshape(-1, 5, 5) + 1e-3 * len(waves) * np.eye(5)
    return np.linalg.solve(left, right[:, :, None])[:, :, 0]


def _pattern(change: NDArray, length: float) -> NDArray[np.float64]:
    """Return the change that all rings share, by bearing (m,) [m]."""
    if length < _PATTERN_LENGTH or not np.isfinite(change).any():
        return np.zeros(change.shape[1])
    masked = np.ma.masked_invalid(change)
    return np.ma.median(masked, axis=0).filled(0.0).astype(float)


def _local_sigma(change: NDArray, step: float) -> NDArray[np.float32]:
    """Return the one-sigma (n, m) of a cell, by the scatter of all bearings within half a metre to both sides."""
    n = len(change)
    width = max(1, round(0.5 * _LOCAL / step))
    middles = np.arange(0, n, width)
    scatter = np.full(len(middles), np.nan)
    for k, i in enumerate(middles):
        part = change[max(i - width, 0) : i + width + 1]
        part = part[np.isfinite(part)]
        if part.size > 50:
            scatter[k] = 1.4826 * np.median(np.abs(part - np.median(part)))
    known = np.isfinite(scatter)
    if not known.any():
        return np.full(change.shape, np.nan, np.float32)
    row = np.interp(np.arange(n), middles[known], scatter[known])
    return np.broadcast_to(np.maximum(row, 1e-7)[:, None], change.shape).astype(np.float32)
