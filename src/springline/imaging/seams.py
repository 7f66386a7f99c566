"""Joints of one frame with lens and pose: lines all round the wall, laid out by how far off the pipe's axis it is seen.

On the wall laid out, a joint is a line across the pipe: a dark gap, or the lit edge of the next pipe. What the pose is
off bends it into one wave per turn, the same number of pixels at every depth for a tilt and nearly so for an offset.
So each row is averaged along waves within the prior, and a joint is where the weaker half of all sectors still shows
it: a stain, a crack or a lateral does that on one side only.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from springline.geometry.camera import camera_eye
from springline.imaging.opencv import opencv
from springline.imaging.unwrapping import wall_grid

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens
    from springline.imaging.reprojection import PosePrior

    Array = NDArray[np.float64]

_SECTORS, _WIDE = 36, 6  # sectors round the wall, and bearings in each
_MOST_ROWS = 260
_WIDTHS = (1.0, 1.7)  # of the line, one-sigma [rows]
_LIMIT = 2.5  # one place counts no more than that, in sigmas of its surroundings
_SURROUNDINGS = (31, 37)  # rows and bearings
_FLOOR = 1.0  # least scatter of the light that is believed, in hundredths of its logarithm times two
_QUANTILE = 0.45  # of the sectors that may show less than the score
_WAVE_STEP = 1.5  # rows between waves that are tried
_MOST_WAVE = 24.0
_LEAST_WAVE = 1.5
_WITHIN = 40  # rows to each side against which a row is judged
_APART = 0.1  # of the way ahead: peaks nearer than that are sides of one line
_PLACE = 0.8  # rows to which a line is placed
_FEWEST_ROWS = 30
_LEAST_SIGMA = 0.03  # of a place, in radii of the pipe: how wide the edge of a pipe is
_EVEN = 5.0  # score at which a line is as likely a joint as not, where one is expected
_PER_SIGMA = 1.2  # log odds for each sigma more
_BOUNDS = (-3.0, 8.0)  # log odds of one frame
_SHORT_OF = 4.0  # log odds by which a line found anywhere is less likely a joint than one where a joint is expected


@dataclass(frozen=True)
class Seams:
    """How much each place along the pipe looks like a joint, in one frame.

    Attributes:
        x: (rows) along the pipe, rising [m].
        score: (rows) how far the weaker half of the sectors stands out, in sigmas of the rows about; -inf = unseen.
        sigma: (rows) one-sigma of a line's place: of what a row is, and where a part of the turn alone is seen, of
            what the pose is off [m].
        eye: x of the camera [m].
    """

    x: Array
    score: Array
    sigma: Array
    eye: float

    def at(self, x: float, within: float) -> tuple[float, float, float]:
        """Return the best score within so much of a place [m], where it is and its one-sigma; -inf where unseen."""
        rows = np.flatnonzero(np.abs(self.x - x) <= max(within, float(np.interp(x, self.x, self.sigma))))
        if not len(rows) or self.score[rows].max() == -np.inf:
            return -math.inf, math.nan, math.nan
        return self._placed(int(rows[np.argmax(self.score[rows])]))

    def peaks(self, least: float) -> list[tuple[float, float, float]]:
        """Return score, x and its one-sigma of every line that reaches a score, the best first."""
        found: list[tuple[float, float, float]] = []
        for row in np.argsort(-self.score):
            if self.score[row] < least:
                break
            near = _APART * (self.x[row] - self.eye)
            if all(abs(self.x[row] - other) > max(near, 4.0 * self.sigma[row]) for _, other, _ in found):
                found.append(self._placed(int(row)))
        return found

    def _placed(self, row: int) -> tuple[float, float, float]:
        shift = 0.0
        if 0 < row < len(self.x) - 1 and np.isfinite(self.score[row - 1 : row + 2]).all():
            before, here, after = self.score[row - 1 : row + 2]
            bend = before - 2.0 * here + after
            shift = float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5)) if bend < 0 else 0.0
        at = float(np.interp(row + shift, np.arange(len(self.x)), self.x))
        return float(self.score[row]), at, float(self.sigma[row])


def seam_odds(score: float, *, expected: bool) -> float:
    """Return the log odds that a line of this score is a joint.

    Args:
        score: As of `Seams`.
        expected: Whether a joint was expected there, or the line was found anywhere in the frame.

    >>> seam_odds(20.0, expected=False), seam_odds(-np.inf, expected=True)
    (4.0, 0.0)
    """
    if not math.isfinite(score):
        return 0.0
    odds = min(max(_PER_SIGMA * (score - _EVEN), _BOUNDS[0]), _BOUNDS[1])
    return odds if expected else odds - _SHORT_OF


def seams_of_frame(
    image: NDArray[np.uint8],
    matrix: ArrayLike,
    lens: Lens,
    centre: ArrayLike,
    r1: float,
    r2: float,
    *,
    prior: PosePrior,
    nearest: float = 0.8,
    farthest: float = 5.0,
) -> Seams | None:
    """Return how much each place ahead looks like a joint, or None where the lens sees too little of the wall.

    Args:
        image: (row, column, 3) of 8 bits.
        matrix, lens, centre, r1, r2: As for `wall.marks_of_frame`.
        prior: How far the pose may be off.
        nearest, farthest: Of the wall ahead that is looked at, in radii of the pipe.
    """
    cv2 = opencv()
    matrix = np.asarray(matrix, dtype=float)
    eye = float(camera_eye(matrix)[0])
    radius = math.sqrt(r1 * r2)
    outer = min(math.atan2(1.0, nearest), 0.999 * lens.max_zenith)
    widest, narrowest = float(lens.radius(outer)), float(lens.radius(math.atan2(1.0, farthest)))
    count = int(min(widest - narrowest, _MOST_ROWS))
    if count < _FEWEST_ROWS:
        return None
    row_size = (widest - narrowest) / count
    turn = 3.0 * prior.turn + 1.5 * prior.offset / radius  # a line goes most aside where it is a radius ahead
    reach = min(max(turn * widest / outer / row_size, _LEAST_WAVE), _MOST_WAVE)
    # rows beyond the farthest, for waves to run into
    spare = int(min(math.ceil(reach), 0.6 * narrowest / row_size))
    off = widest - row_size * np.arange(count + spare)
    x = eye + radius / np.tan(lens.zenith(off))
    grid = wall_grid(matrix, lens, centre, r1, r2, x, columns=_SECTORS * _WIDE)
    seen = cv2.erode(grid.seen(image.shape[:2]).astype(np.uint8), np.ones((5, 1), np.uint8), borderValue=0) > 0
    # a row of the wall is so many pixels: finer grain than that is noise
    grey = cv2.cvtColor(image, cv2.COLOR_BGR2GRAY).astype(np.float32)
    grey = cv2.GaussianBlur(grey, (0, 0), 0.8 * max(1.0, row_size))
    light = grid.unwrap(np.log(grey + 10.0) * 50.0)
    waves = _waves(reach)
    score = np.full(count + spare, -np.inf)
    for width in _WIDTHS:
        line = _line(light, seen, width)
        for sense in (1.0, -1.0):
            sectors, known = _by_sector(sense * line, seen)
            score = np.maximum(score, _judged(_best(sectors, known, waves, _QUANTILE)))
    per_turn = ((x - eye) ** 2 + radius**2) / radius  # way along the pipe per radian
    unseen = 1.0 - seen.mean(axis=1)
    aside = unseen * per_turn * max(prior.turn, prior.offset / radius)
    sigma = np.sqrt((_PLACE * np.gradient(x)) ** 2 + aside**2 + (_LEAST_SIGMA * radius) ** 2)
    return Seams(x[:count], score[:count], sigma[:count], eye)


def _waves(reach: float) -> NDArray[np.int64]:
    """Shifts (waves, sectors) in rows of every wave of an amplitude up to `reach`."""
    each = np.arange(-math.floor(reach / _WAVE_STEP), math.floor(reach / _WAVE_STEP) + 1) * _WAVE_STEP
    right, up = (part.ravel() for part in np.meshgrid(each, each))
    inside = np.hypot(right, up) <= reach + 1e-9
    bearing = (np.arange(_SECTORS) + 0.5) * (2.0 * np.pi / _SECTORS)
    return np.rint(np.outer(right[inside], np.cos(bearing)) + np.outer(up[inside], np.sin(bearing))).astype(np.int64)


def _line(light: NDArray[np.float32], seen: NDArray[np.bool_], width: float) -> NDArray[np.float32]:
    """How much each place looks like a bright line across, in sigmas of its surroundings."""
    cv2 = opencv()
    away = np.arange(-int(4 * width) - 1, int(4 * width) + 2) / width
    kernel = (1.0 - away**2) * np.exp(-0.5 * away**2)
    kernel -= kernel.mean()
    kernel /= 0.5 * np.abs(kernel).sum()
    response = cv2.filter2D(light, -1, kernel[:, None].astype(np.float32), borderType=cv2.BORDER_REPLICATE)
    size = _SURROUNDINGS[::-1]
    share = cv2.blur(seen.astype(np.float32), size)
    scatter = cv2.blur(np.abs(response) * seen, size) / np.maximum(share, 0.05)
    return np.clip(response / (1.25 * scatter + _FLOOR), -_LIMIT, _LIMIT)


def _by_sector(line: NDArray[np.float32], seen: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
    """Mean (rows, sectors) over what is seen, and whether half of the sector is."""
    shape = (len(line), _SECTORS, _WIDE)
    there = seen.reshape(shape).sum(axis=2)
    total = np.where(seen, line, 0.0).reshape(shape).sum(axis=2, dtype=float)
    return total / np.maximum(there, 1), 2 * there >= _WIDE


@njit(cache=True)
def _best(sectors, known, waves, quantile):
    """For each row the quantile over sectors along the wave that has the largest mean; -inf where half is unseen."""
    rows, count = sectors.shape
    best = np.full(rows, -np.inf)
    values = np.empty(count)
    for row in range(rows):
        chosen, most = -1, -np.inf
        for wave in range(len(waves)):
            total, there = 0.0, 0
            for k in range(count):
                at = row + waves[wave, k]
                if 0 <= at < rows and known[at, k]:
                    total += sectors[at, k]
                    there += 1
            if 2 * there >= count and total / there > most:
                chosen, most = wave, total / there
        if chosen < 0:
            continue
        there = 0
        for k in range(count):
            at = row + waves[chosen, k]
            if 0 <= at < rows and known[at, k]:
                values[there] = sectors[at, k]
                there += 1
        best[row] = np.quantile(values[:there], quantile)
    return best


def _judged(best: Array) -> Array:
    """The rows' values in robust sigmas of the rows about each."""
    score = np.full(len(best), -np.inf)
    rows = np.flatnonzero(np.isfinite(best))
    for place, row in enumerate(rows):
        near = best[rows[max(place - _WITHIN, 0) : place + _WITHIN + 1]]
        middle = np.median(near)
        score[row] = (best[row] - middle) / max(1.4826 * np.median(np.abs(near - middle)), 0.01)
    return score
