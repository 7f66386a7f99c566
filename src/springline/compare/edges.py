"""What of two walls is not compared: joints, rims of openings, edges, what one inspection did not see."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import binary_dilation, maximum_filter, median_filter, minimum_filter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .wall import Wall

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

_LOCAL = 1.0  # m over which the scatter is taken
_EDGE = 7.0  # scatters that neighbours differ by at an edge
_JOINT_LENGTH = 0.05  # m: what stands out all round over no more than this is a joint
_JOINT_SIGMAS = 6.0
_FAR, _FAR_SHARE = 5.0, 0.03  # scatters, and the share of a ring's readings so far off that a short event is a joint
_SLANT = 0.01  # m: a ring that stands two degrees off the square of a 300 mm pipe spans so much to both sides
_NEAR_JOINT = 2  # rows beside a joint that are left out with it
_RIM = 4  # cells beside an opening that its rim may reach


def joint_rows(wall: NDArray, seen: NDArray, section: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the rows (n,) that stand out from those beside them, over so short a way that they are a joint."""
    scatter = 1.4826 * float(np.median(np.abs(wall[seen]))) if seen.any() else np.inf
    # One stray reading is no joint.
    plain, count = np.clip(np.where(seen, wall, 0.0), -_FAR * scatter, _FAR * scatter), np.maximum(seen.sum(axis=1), 1)
    power = np.log(np.square(plain, dtype=float).sum(axis=1) / count + 1e-14)
    # The ring's own mean: sections that were estimated along the pipe are smooth past a joint.
    mean = np.nan_to_num(section[:, 0], nan=np.nanmedian(section[:, 0])) + plain.sum(axis=1, dtype=float) / count
    width = 2 * round(0.5 * _LOCAL / step) + 1
    out = np.zeros(len(wall), bool)
    for values in (power, mean):
        off = values - median_filter(values, width, mode="nearest")
        out |= np.abs(off) > _JOINT_SIGMAS * 1.4826 * max(float(np.median(np.abs(off))), 1e-9)
    # Stray readings are everywhere: a joint has more of them than the rings about it.
    far = (np.abs(wall) > _FAR * scatter).mean(axis=1)
    usual = median_filter(far, width, mode="nearest")
    out |= far > usual + np.maximum(_FAR_SHARE, _FAR * np.sqrt(usual / wall.shape[1]))
    edges = np.flatnonzero(np.diff(np.concatenate(([False], out, [False]))))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if (last - first) * step > max(_JOINT_LENGTH, 3 * step):
            out[first:last] = False
    return binary_dilation(out, np.ones(2 * _NEAR_JOINT + 1, bool))


def at_joints(x: NDArray, joints: NDArray, step: float) -> NDArray[np.bool_]:
    """Return the places x (n,) [m] that a ring cuts a joint from: within half its gap, a slant cut and the step."""
    reach = 0.5 * np.nan_to_num(joints[:, 1]) + _SLANT + _NEAR_JOINT * step
    begun = np.searchsorted(np.sort(joints[:, 0] - reach), x, side="right")
    return begun > np.searchsorted(np.sort(joints[:, 0] + reach), x, side="left")


def rims(wall: Wall, x: NDArray, rows: int, roll: NDArray | None) -> NDArray[np.bool_]:
    """Return the cells (n, rows) in and beside the openings of a wall, at its own chainage x [m]."""
    ring = np.abs(wall.chainage[np.clip(np.searchsorted(wall.chainage, x), 1, len(wall.chainage) - 1)] - x)
    at = np.clip(np.searchsorted(wall.chainage, x), 1, len(wall.chainage) - 1)
    at -= np.abs(wall.chainage[at - 1] - np.nan_to_num(x, nan=-1e9)) < np.nan_to_num(ring, nan=1e9)
    hole, _ = coarser(wall.opening[at], wall.opening[at], rows)
    if roll is not None:
        shift = np.rint(roll * rows / (2 * np.pi)).astype(int)
        hole = np.take_along_axis(hole, (np.arange(rows)[None, :] - shift[:, None]) % rows, 1)
    wide = np.pad(hole, ((0, 0), (_RIM, _RIM)), mode="wrap")
    return binary_dilation(wide, np.ones((2 * _RIM + 1, 2 * _RIM + 1), bool))[:, _RIM:-_RIM]


def why_compared(
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


def coarser(values: NDArray, seen: NDArray, rows: int) -> tuple[NDArray, NDArray]:
    """Return values and flags at the (n, rows) cells nearest to those of a finer circle."""
    if values.shape[1] == rows:
        return values, seen
    at = np.rint(np.arange(rows) * (values.shape[1] / rows)).astype(int)
    return values[:, at], seen[:, at]
