"""What else a patch may be than a change: rings laid beside their place, restless all round, or changed all round."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import fft
from scipy.ndimage import gaussian_filter

from .shape import median_of_nine
from .templates import slide

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .difference import Difference
    from .templates import Template

_SMOOTH, _SMOOTH_TURN = 0.008, 0.012  # m, and share of the circle, over which the wall's slope is smoothed
_LEAST_REACH = 0.1  # m to both sides of a patch in which its rings are looked at
_OWN = 1.5  # half widths of a template to both sides of a patch that are its own
_PRIOR_COUNT = 8.0  # places by which the whole map's scatter counts beside that of a patch's own rings
_CLEAR = 3.0  # sigmas by which rings must be restless to count as such
_LEAST_SEEN = 0.3
_LOBE = np.radians(60.0)  # width at half height of a lobe of an oval
_CLEARLY = 6.0  # of a sum of squares: odds of 20 to 1


def slope_along(found: Difference) -> NDArray[np.float64]:
    """Return the slope of both walls along the pipe (n, m) [m/m]; of lone stray readings there is none."""
    wall, known = 0.5 * (found.wall_a + found.wall_b), np.isfinite(found.change)
    wall = np.where(known, wall, 0.0)
    near = median_of_nine(wall)
    reach = _SMOOTH / found.step, wall.shape[1] * _SMOOTH_TURN
    value, share = (
        gaussian_filter(part, reach, mode=("nearest", "wrap"))
        for part in (np.where(known, near, 0.0).astype(float), known.astype(float))
    )
    smooth = value / np.maximum(share, 1e-6)
    return np.gradient(smooth, found.step, axis=0) if len(smooth) > 1 else np.zeros_like(smooth)


def sigma_in_doubt(
    found: Difference, slope: NDArray, one: Template, i: int, j: int, depth: float, sigma: float, spread: float
) -> float:
    """Return the one-sigma [m] of a patch's depth with all that it may be but a change; infinite where rings are waves.

    Args:
        found: The difference map.
        slope: Of the wall along the pipe (n, m) [m/m].
        one: The template that told the patch.
        i, j: Row and column of its middle.
        depth: Of the patch [m].
        sigma: Of that, by chance alone [m].
        spread: Scatter of the template's scores on the whole map.
    """
    if is_whole_ring(found, one, i, j):
        return float("inf")
    wider = sigma * restlessness(found, one, i, j, depth, spread) / spread
    return float(np.hypot(wider, beside(found, slope, one, i, j)))


def beside(found: Difference, slope: NDArray, one: Template, i: int, j: int) -> float:
    """Return the one-sigma [m] of a patch's depth that its rings' place and tilt leave.

    A ring that lies d further on shows d times the wall's slope; a tilted one does so on both sides with other signs.

    Args:
        found: The difference map.
        slope: Of the wall along the pipe (n, m) [m/m].
        one: The template that told the patch.
        i, j: Row and column of its middle.
    """
    rows, along = _rows(found, one, i)
    shape = along[:, None] * np.roll(one.around, j)[None, :]
    known = np.isfinite(found.change[rows])
    pull = np.where(known, shape / np.square(found.sigma[rows]), 0.0)
    pull /= max(float((pull * shape).sum()), 1e-30)
    shown = (pull * slope[rows]).sum(axis=0)
    place, side = float(shown.sum()), abs(complex(shown @ np.exp(1j * found.bearing)))
    return float(np.hypot(found.place_sigma[i] * place, found.side_sigma * side))


def is_whole_ring(found: Difference, one: Template, i: int, j: int) -> bool:
    """Return whether a wave all round explains the rings of a patch better than the patch does.

    A patch as wide as a lobe of an oval must explain them clearly better: half-seen, the two are hard to tell apart.
    Sections that became more or less oval are told by diameters and ovality, which know what a sensor's tilt does to
    them; waves of three and four are a section that lies turned against itself.

    Args:
        found: The difference map.
        one: The template that told the patch.
        i, j: Row and column of its middle.
    """
    rows, along = _rows(found, one, i)
    known = np.isfinite(found.change[rows])
    weight = np.where(known, 1.0 / np.square(found.sigma[rows]), 0.0)
    pull = along @ np.where(known, weight * found.change[rows], 0.0)
    total = np.square(along) @ weight
    first, *waves = (np.column_stack((np.cos(k * found.bearing), np.sin(k * found.bearing))) for k in (1, 2, 3, 4))
    waves[0] = np.column_stack((np.ones_like(found.bearing), waves[0]))
    patch = _gain(pull, total, first, np.roll(one.around, j)[:, None]) - 1.0
    least = patch - (_CLEARLY if one.width > _LOBE else 0.0)
    return any(_gain(pull, total, first, wave) - wave.shape[1] > least for wave in waves)


def _gain(pull: NDArray, total: NDArray, given: NDArray, shapes: NDArray) -> float:
    """Return by how much shapes (m, k) lower a ring's sum of squares when those `given` (m, l) have done so."""
    return _explained(pull, total, np.column_stack((given, shapes))) - _explained(pull, total, given)


def _explained(pull: NDArray, total: NDArray, shapes: NDArray) -> float:
    """Return by how much the shapes (m, k) lower the sum of squares of a ring with these sums and weights (m,)."""
    right = shapes.T @ pull
    normal = shapes.T @ (total[:, None] * shapes)
    return float(right @ np.linalg.solve(normal + 1e-9 * np.trace(normal) * np.eye(len(right)), right))


def _rows(found: Difference, one: Template, i: int) -> tuple[slice, NDArray[np.float64]]:
    """Return the rows under a template whose middle is row i, and its shape on them."""
    half = len(one.along) // 2
    rows = slice(max(i - half, 0), i + half + 1)
    return rows, one.along[max(half - i, 0) :][: len(found.change[rows])]


def restlessness(found: Difference, one: Template, i: int, j: int, depth: float, spread: float) -> float:
    """Return how far the scores of a template scatter on the rings of a patch, beside it: the usual `spread`, or more.

    What moves whole rings, such as a robot that tilts where its wheels pass a step, shows on all sides of them.

    Args:
        found: The difference map.
        one: The template that told the patch.
        i, j: Row and column of its middle.
        depth: Of the patch [m], which is taken away first: it moves the middles of its rings.
        spread: Scatter of the template's scores on the whole map.
    """
    half, cells = len(one.along) // 2, found.change.shape[1]
    reach = max(len(one.along), round(_LEAST_REACH / found.step))
    rows = slice(max(i - reach - half, 0), i + reach + half + 1)
    at = np.arange(rows.start, rows.start + len(found.change[rows])) - i
    along = np.where(np.abs(at) <= half, one.along[np.clip(at + half, 0, 2 * half)], 0.0)
    change = found.change[rows] - depth * along[:, None] * np.roll(one.around, j)[None, :]
    known = np.isfinite(change)
    weight = np.where(known, 1.0 / np.square(found.sigma[rows]), 0.0)
    size = fft.next_fast_len(len(known) + len(one.along), real=True)
    waves = [fft.rfft2(p, s=(size, cells)) for p in (np.where(known, change, 0.0) * weight, weight)]
    top, bottom = (slide(wave, one, p, (size, cells), len(known)) for wave, p in zip(waves, (1, 2), strict=True))
    apart = np.abs(np.mod(np.arange(cells) - j + cells // 2, cells) - cells // 2)
    seen = (np.abs(at) <= reach)[:, None] & (apart > _OWN * one.reach)
    seen &= bottom > _LEAST_SEEN * one.energy * weight.max()
    if not seen.any():
        return spread
    local = 1.4826 * float(np.median(np.abs(top[seen] / np.sqrt(bottom[seen]))))
    count = seen.sum() / max(0.5 * len(one.along) * one.reach, 1.0)
    if local < spread * (1.0 + _CLEAR / np.sqrt(2.0 * count)):
        return spread
    return float(np.sqrt((_PRIOR_COUNT * spread**2 + count * local**2) / (_PRIOR_COUNT + count)))
