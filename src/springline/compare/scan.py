"""Patches of changed wall: a bank of dents of many sizes is slid over the difference map, at a stated false-alarm rate.

Each template has unit depth in its middle and falls as cos^2 to its edges, which lie at twice its size; a size is that
at half depth. Its best depth at a place, over the depth's sigma, is a unit normal where nothing changed. How many
peaks of such a field pass a threshold u by chance follows from its correlation alone: per unit of area, for both signs,
2 (2 pi)^(-3/2) sqrt(lx lt) u exp(-u^2 / 2), with lx, lt the second spectral moments along and around.

Source: R. J. Adler, The Geometry of Random Fields (1981), theorem 5.4.1 and its corollary for high levels.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft
from scipy.optimize import brentq

from .sharpen import dent_fit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .difference import Difference

LENGTHS = (0.05, 0.1, 0.2, 0.4, 0.8)
"""Lengths of the templates at half depth [m]."""

WIDTHS = tuple(np.radians((9.0, 18.0, 36.0, 72.0)).tolist())
"""Widths of the templates at half depth [rad]."""

FALSE_ALARMS = 1.0
"""False alarms per 100 m of pipe, over all sizes and both signs."""

DETECTION = 1.6449
"""One-sided 95 % quantile of the unit normal: a change is detectable when it passes the threshold so often."""

_LEAST_SEEN = 0.6
_SLOW = 3.5e-4  # of the radius: sections bend by so much where attitude is a degree off, over a metre or so
_MOST_PATCHES = 400
_SHARPENED = 60
_FEWEST_CELLS = 3
_HUNDRED = 100.0
_OWN_SHARE = 0.35  # of a patch's depth, by which a peak on its rings must differ from what the patch explains


@dataclass(frozen=True)
class Template:
    """One size of dent, sampled on the map's grid.

    Attributes:
        length: At half depth [m].
        width: At half depth [rad].
        along: Its shape along the pipe, centred.
        around: (m,) its shape round the whole ring from its middle on, less what moves the middle of the section.
        reach: Cells to each side of its middle round the ring.
    """

    length: float
    width: float
    along: NDArray[np.float64]
    around: NDArray[np.float64]
    reach: int

    @property
    def moments(self) -> tuple[float, float]:
        """Second spectral moments of the scan along [1/cell^2] and around [1/cell^2]."""
        along = np.sum(np.diff(self.along, prepend=0, append=0) ** 2) / np.sum(self.along**2)
        around = np.sum(np.diff(self.around, append=self.around[0]) ** 2) / np.sum(self.around**2)
        return float(along), float(around)


@dataclass(frozen=True)
class Patch:
    """A patch of changed wall.

    Attributes:
        chainage: Of its middle in A [m].
        bearing: Of its middle [rad].
        length: At half depth [m].
        width: At half depth [rad].
        change: Depth of its middle [m], outward positive.
        sigma: One-sigma of that [m].
        score: The change over its sigma, in the scan.
        false_alarms: How many as clear appear by chance in 100 m of unchanged pipe.
    """

    chainage: float
    bearing: float
    length: float
    width: float
    change: float
    sigma: float
    score: float
    false_alarms: float


@dataclass(frozen=True)
class Scan:
    """What a scan found.

    Attributes:
        patches: The clearest first.
        threshold: Score from which a patch is told.
        templates: The bank.
        inflation: (k,) scatter of each template's scores over that of independent cells, at least 1.
        searched: Length of pipe with cells that were compared [m].
    """

    patches: tuple[Patch, ...]
    threshold: float
    templates: tuple[Template, ...]
    inflation: NDArray[np.float64]
    searched: float


def bank(step: float, rows: int) -> tuple[Template, ...]:
    """Return the templates that a map of this `step` [m] and number of bearings resolves."""
    turn = 2 * np.pi / rows
    return tuple(
        Template(length, width, _bump(length / step), _ring(width / turn, rows), len(_bump(width / turn)) // 2)
        for length in LENGTHS
        for width in WIDTHS
        if 2 * length / step >= _FEWEST_CELLS and 2 * width / turn >= _FEWEST_CELLS
    )


def _bump(size: float) -> NDArray[np.float64]:
    """Return cos^2 of half-depth width `size` [cells], centred."""
    half = int(np.ceil(size)) - 1
    return np.cos(0.5 * np.pi * np.arange(-half, half + 1) / size) ** 2


def _ring(size: float, rows: int) -> NDArray[np.float64]:
    """Return cos^2 of half-depth width `size` [cells] round a ring (rows,), less its first order."""
    bump = _bump(size)
    ring = np.zeros(rows)
    np.add.at(ring, (np.arange(len(bump)) - len(bump) // 2) % rows, bump)
    turn = np.arange(rows) * (2 * np.pi / rows)
    return ring - (2.0 / rows) * (ring @ np.cos(turn)) * np.cos(turn)


def false_alarms(score: float, templates: tuple[Template, ...], rows: int, step: float) -> float:
    """Return how many peaks of either sign pass `score` by chance in 100 m of pipe, over all templates.

    >>> small = bank(0.01, 180)
    >>> false_alarms(5.0, small, 180, 0.01) > false_alarms(5.5, small, 180, 0.01)
    True
    """
    cells = rows * _HUNDRED / step
    density = sum(np.sqrt(t.moments[0] * t.moments[1]) for t in templates)
    return float(2.0 * cells * density * (2 * np.pi) ** -1.5 * score * np.exp(-0.5 * score**2))


def threshold(templates: tuple[Template, ...], rows: int, step: float, rate: float = FALSE_ALARMS) -> float:
    """Return the score that peaks pass by chance `rate` times in 100 m."""
    return float(brentq(lambda u: np.log(false_alarms(u, templates, rows, step) / rate), 2.0, 12.0))


def scan(found: Difference, rate: float = FALSE_ALARMS) -> Scan:
    """Return the patches of changed wall.

    Args:
        found: The difference map.
        rate: False alarms per 100 m.
    """
    n, rows = found.change.shape
    templates = bank(found.step, rows)
    known = np.isfinite(found.change) & np.isfinite(found.sigma)
    searched = float(known.any(axis=1).sum() * found.step)
    if not templates or not known.any():
        return Scan((), np.inf, templates, np.ones(len(templates)), searched)
    limit = threshold(templates, rows, found.step, rate)
    weight = np.where(known, 1.0 / np.square(found.sigma), 0.0).astype(np.float32)
    pull = np.where(known, found.change, 0.0).astype(np.float32) * weight
    size = fft.next_fast_len(n + max(len(t.along) for t in templates), real=True)
    waves = [fft.rfft2(part, s=(size, rows)) for part in (pull, weight)]
    typical = float(np.median(weight[known]))
    best = np.zeros((n, rows), np.float32)
    which = np.zeros((n, rows), np.uint8)
    depth, sigma, inflation = np.zeros((n, rows), np.float32), np.zeros((n, rows), np.float32), []
    for k, template in enumerate(templates):
        top, bottom = (_slide(w, template, p, (size, rows), n) for w, p in zip(waves, (1, 2), strict=True))
        full = typical * float(np.sum(template.along**2) * np.sum(template.around**2))
        seen = bottom > _LEAST_SEEN * full
        root = np.sqrt(np.where(seen, bottom, 1.0))
        score = np.where(seen, top / root, 0.0)
        spread = max(1.0, 1.4826 * float(np.median(np.abs(score[seen])))) if seen.any() else 1.0
        inflation.append(spread)
        own = spread / root
        total = np.hypot(own, _slow(found, template))
        score *= own / total / spread
        better = np.abs(score) > np.abs(best)
        best[better], which[better] = score[better], k
        depth[better], sigma[better] = (top / np.where(seen, bottom, 1.0))[better], total[better]
    patches = _pick(found, templates, best, which, depth, sigma, limit)
    patches = (*(sharpened(found, p) for p in patches[:_SHARPENED]), *patches[_SHARPENED:])
    return Scan(patches, limit, templates, np.array(inflation), searched)


def _slow(found: Difference, template: Template) -> float:
    """Return the one-sigma [m] of what a template as long as errors of attitude last takes from them."""
    return _SLOW * found.radius * min(template.length / LENGTHS[-1], 1.0)


def _slide(wave: NDArray, template: Template, power: int, shape: tuple[int, int], n: int) -> NDArray[np.float32]:
    """Return the map summed under the template (to a power) about each cell."""
    along = np.zeros(shape[0], np.float32)
    half = len(template.along) // 2
    along[np.arange(-half, half + 1)] = template.along**power
    around = (template.around**power).astype(np.float32)
    product = wave * fft.fft(along)[:, None] * fft.rfft(around)[None, :]
    return fft.irfft2(product, s=shape)[:n].astype(np.float32)


def _pick(
    found: Difference, templates: tuple[Template, ...], best: NDArray, which: NDArray, depth: NDArray, sigma: NDArray,
    limit: float,
) -> tuple[Patch, ...]:  # fmt: skip
    """Return the peaks above the limit, the clearest first; each takes what it covers with it."""
    left = np.where(np.isfinite(found.change), np.abs(best), 0.0)
    rows = best.shape[1]
    patches: list[Patch] = []
    taken: list[tuple[int, int, Template, float]] = []
    while len(patches) < _MOST_PATCHES:
        i, j = (int(v) for v in np.unravel_index(int(np.argmax(left)), left.shape))
        if left[i, j] < limit:
            break
        t = templates[which[i, j]]
        least = limit * float(sigma[i, j])
        if not any(_belongs(i, j, t, float(depth[i, j]), least, one) for one in taken):
            patches.append(
                Patch(
                    float(found.chainage[i]), float(found.bearing[j]), t.length, t.width, float(depth[i, j]),
                    float(sigma[i, j]), float(best[i, j]), false_alarms(float(left[i, j]), templates, rows, found.step),
                )
            )  # fmt: skip
            taken.append((i, j, t, float(depth[i, j])))
        left[
            max(i - len(t.along) // 2, 0) : i + len(t.along) // 2 + 1, (j + np.arange(-t.reach, t.reach + 1)) % rows
        ] = 0
    return tuple(patches)


def _belongs(i: int, j: int, t: Template, depth: float, least: float, other: tuple[int, int, Template, float]) -> bool:
    """Return whether a peak is but what a patch found before shows in another template: its flank, or its far side.

    Args:
        i, j, t, depth: Row, column and template of the peak, and its depth.
        least: Depth of which a peak is told.
        other: The same of the patch found before.
    """
    row, column, wide, deep = other
    if abs(i - row) > (len(t.along) + len(wide.along)) // 2:
        return False
    along = np.correlate(t.along, wide.along, "full")
    at = i - row + len(wide.along) // 2 + len(t.along) // 2
    lag = float(along[len(along) - 1 - at]) if 0 <= at < len(along) else 0.0
    round_ring = float(t.around @ np.roll(wide.around, column - j))
    shown = deep * lag * round_ring / float(np.sum(t.along**2) * np.sum(t.around**2))
    return abs(depth - shown) < max(least, _OWN_SHARE * abs(deep))


def sharpened(found: Difference, patch: Patch) -> Patch:
    """Return a patch with place, size and depth by least squares; as it was where they do not settle.

    The bank's sizes lie a factor of two apart, and a dent moves the middle of the section that it stands on.
    """
    fitted = dent_fit(found, patch.chainage, patch.bearing, patch.length, patch.width, patch.change)
    if fitted is None:
        return patch
    chainage, bearing, length, width, change, sigma = fitted
    return replace(
        patch, chainage=chainage, bearing=bearing, length=length, width=width, change=change,
        sigma=max(sigma, patch.sigma),
    )  # fmt: skip


def detectable(
    found: Difference, scanned: Scan, length: float, width: float, *, at_half_depth: bool = False
) -> NDArray[np.float64]:
    """Return the depth (n,) [m] of a dent that the scan tells in 95 % of cases, at each row of the map.

    Args:
        found: The difference map.
        scanned: Its scan.
        length: Of the dent [m].
        width: Of the dent [rad].
        at_half_depth: Whether length and width are those at half depth, rather than from edge to edge.
    """
    if not scanned.templates:
        return np.full(len(found.chainage), np.nan)
    halve = 1.0 if at_half_depth else 0.5
    turn = 2 * np.pi / found.change.shape[1]
    along = _bump(max(halve * length / found.step, 1.0))
    around = _ring(max(halve * width / turn, 1.0), found.change.shape[1])
    known = np.isfinite(found.change)
    sigma = np.where(known.any(axis=1), found.sigma[:, 0], np.nan)
    least = np.full(len(sigma), np.inf)
    for t, spread in zip(scanned.templates, scanned.inflation, strict=True):
        norm = float(np.sum(t.along**2) * np.sum(t.around**2))
        shown = _overlap(along, t.along) * float(around @ t.around) / norm
        if shown > 0:
            least = np.fmin(least, np.hypot(spread * sigma / np.sqrt(norm), _slow(found, t)) / shown)
    return (scanned.threshold + DETECTION) * np.where(np.isfinite(sigma), least, np.nan)


def _overlap(a: NDArray, b: NDArray) -> float:
    """Return the sum of the product of two centred shapes."""
    half = min(len(a), len(b)) // 2
    return float(a[len(a) // 2 - half : len(a) // 2 + half + 1] @ b[len(b) // 2 - half : len(b) // 2 + half + 1])
