"""The difference of two walls on one chainage: B less A, what the instruments differ by taken away and kept."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..geometry.measures import polar_radius
from .edges import COMPARED, SPIKE, at_joints, coarser, joint_rows, rims, why_compared
from .shape import local_sigma, median_of_nine, pattern_of, roll_left, white_sigma, without_shape
from .texture import sample, white_kept

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .registration import Registration
    from .wall import Wall

_SPIKE = 4.5  # scatters
_LEAST_NOISE = 0.1  # of the readings' scatter: no cell is surer, however alike two maps are


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
        sigma: (n, m) one-sigma of a cell [m], as what is averaged over several of them has it; interpolation makes a
            lone cell quieter than that.
        why: (n, m) flags of `WHY_NOT`, uint8.
        scale: Ranges of B over those of A, less one; what a change of all diameters alike would show too.
        scale_sigma: Its one-sigma.
        pattern: (m,) change that all rings share [m], which a sensor's error and a wall worn alike over the whole
            length both show; 0 when the pipe is too short to tell.
        fine: (n,) whether the relief placed the row.
        radius: Usual radius of the pipe [m].
        place_sigma: (n,) one-sigma of where each row lies in B [m].
        side_sigma: One-sigma of how far what is not known of the tilts moves the sides of a ring along the pipe [m].
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
    radius: float
    place_sigma: NDArray[np.float64]
    side_sigma: float

    @property
    def step(self) -> float:
        """Distance between rows [m]."""
        return float(self.chainage[1] - self.chainage[0]) if len(self.chainage) > 1 else 0.0


def difference(a: Wall, b: Wall, placed: Registration, joints: tuple[NDArray, NDArray] | None = None) -> Difference:
    """Return the difference of two walls.

    Sections are compared about their own middles, so that neither sensor's place in the pipe matters. The common scale
    of the ranges is taken from the ratio of mean radii; the orders 0 to 2 of each ring, averaged over 3 m, are left
    to the diameters; a pattern that all rings share is taken away and kept.

    Args:
        a: Wall of the first inspection.
        b: Wall of the second, as driven.
        placed: Where A's rings lie in B.
        joints: Chainage and gap (k, 2) [m] of the joints found in A, and of those found in B.
    """
    turned = b.mirrored(placed.extent_b) if placed.reversed else b
    rows = min(a.surface.shape[1], b.surface.shape[1])
    bearing = np.arange(rows) * (2 * np.pi / rows)
    step = max(a.spacing, b.spacing)
    x = np.arange(a.extent[0], a.extent[1] + 0.5 * step, step)
    y = placed.at(x)[0]
    own = sum(placed.extent_b) - y if placed.reversed else y
    wall_a, seen_a = coarser(*sample(a.chainage, a.surface, x, 3.0 * step), rows)
    wall_b, seen_b = coarser(*sample(turned.chainage, turned.surface, np.nan_to_num(own, nan=-1e9), 3.0 * step), rows)
    wall_b, seen_b = _rolled(wall_b, seen_b, placed.roll_at(x))
    section_a = _sections(a, x)
    section_b = _turn(_sections(turned, own), placed.roll_at(x))
    scale, scale_sigma = _scale(section_a[:, 0], section_b[:, 0])
    radius = [polar_radius(p[:, None, :], bearing) for p in (section_a, section_b)]
    change = (radius[1] + wall_b) / (1.0 + scale) - (radius[0] + wall_a)
    joint = joint_rows(wall_a, seen_a, section_a, step) | joint_rows(wall_b, seen_b, section_b, step)
    for at, found in zip((x, y), joints or (), strict=bool(joints)):
        joint |= at_joints(at, found, step)
    rim = rims(a, x, rows, None) | rims(turned, own, rows, placed.roll_at(x))
    why = why_compared(wall_a, wall_b, seen_a, seen_b, rim | joint[:, None], placed.reliable(x))
    change = np.where(why == COMPARED, change, np.nan).astype(np.float32)
    both = 0.5 * (radius[0] + radius[1]), 0.5 * (wall_a + wall_b)
    change -= roll_left(change, *both, placed.roll_sigma_at(x), step).astype(np.float32)
    spike = _spikes(change, step)
    why[spike], change[spike] = SPIKE, np.nan
    change = without_shape(change, bearing, step)
    pattern = pattern_of(change, float(x[-1] - x[0]))
    change -= pattern.astype(np.float32)
    kept = _kept(a, turned, x, np.nan_to_num(own), placed.roll_at(x), rows)
    sigma = np.maximum(white_sigma(change, step, kept), np.float32(_LEAST_NOISE * np.hypot(a.noise, b.noise)))
    return Difference(
        chainage=x, chainage_b=y, bearing=bearing,
        wall_a=np.where(seen_a, wall_a, np.nan).astype(np.float32),
        wall_b=np.where(seen_b, wall_b, np.nan).astype(np.float32),
        change=change, sigma=sigma, why=why, scale=scale, scale_sigma=scale_sigma,
        pattern=pattern, fine=placed.refined_at(x), radius=a.radius,
        place_sigma=np.nan_to_num(placed.at(x)[1]), side_sigma=a.radius * float(np.hypot(a.tilt_sigma, b.tilt_sigma)),
    )  # fmt: skip


def _rolled(values: NDArray, seen: NDArray, roll: NDArray) -> tuple[NDArray, NDArray]:
    """Return values (n, m) turned by roll (n,) [rad], between cells by the line."""
    m = values.shape[1]
    whole, part = _cells_rolled(roll, m)
    part = part[:, None].astype(np.float32)
    first = (np.arange(m)[None, :] + whole[:, None]) % m
    second = (first + 1) % m
    take = np.take_along_axis
    near, far = take(seen, first, 1), take(seen, second, 1)
    return (1 - part) * take(values, first, 1) + part * take(values, second, 1), near & far


def _cells_rolled(roll: NDArray, cells: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return by how many whole cells (n,) a roll (n,) [rad] moves a ring of `cells`, and by which part (n,) of one."""
    shift = -roll * cells / (2 * np.pi)
    whole = np.floor(shift).astype(int)
    return whole, shift - whole


def _kept(a: Wall, b: Wall, x: NDArray, y: NDArray, roll: NDArray, rows: int) -> NDArray[np.float64]:
    """Return the share (n,) of the variance of white readings that interpolation left in a cell of the difference."""
    part = _cells_rolled(roll, rows)[1]
    own = white_kept(a.chainage, x), white_kept(b.chainage, y) * ((1.0 - part) ** 2 + part**2)
    power = np.square([a.noise, b.noise])
    return (power[0] * own[0] + power[1] * own[1]) / power.sum()


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


def _spikes(change: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the cells that stand far off their eight neighbours: no wall does that, stray readings do."""
    sigma = local_sigma(change, step)
    near = median_of_nine(np.nan_to_num(change))
    with np.errstate(invalid="ignore"):
        return np.abs(change - near) > _SPIKE * sigma
