"""Patches of changed wall: a bank of dents of many sizes is slid over the difference map, at a stated false-alarm rate.

The templates and their thresholds stand in `templates`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy import fft

from .doubt import sigma_in_doubt, slope_along
from .shape import shape_rows
from .sharpen import dent_fit
from .templates import DISTINCT, FALSE_ALARMS, LENGTHS, bank, false_alarms, slide, template, thresholds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .difference import Difference
    from .templates import Template

DETECTION = 1.6449
"""One-sided 95 % quantile of the unit normal: a change is detectable when it passes the threshold so often."""

_LEAST_SEEN = 0.6
_SLOW = 3.5e-4  # of the radius: sections bend by so much where attitude is a degree off, over a metre or so
_MOST_PATCHES = 400
_SHARPENED = 60
_LEAST_QUIET = 0.5  # of the cells: where more are beside patches, all tell how far scores scatter
_OWN_SHARE = 0.35  # of a patch's depth, by which a peak on its rings must differ from what the patch explains


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
        templates: The bank.
        thresholds: (k,) score from which each template's patch is told.
        inflation: (k,) scatter of each template's scores over that of independent cells, at least 1.
        searched: Length of pipe with cells that were compared [m].
    """

    patches: tuple[Patch, ...]
    templates: tuple[Template, ...]
    thresholds: NDArray[np.float64]
    inflation: NDArray[np.float64]
    searched: float


@dataclass(frozen=True)
class _Best:
    """At each cell (n, m) the template that stands out most.

    Attributes:
        over: Its score, less its threshold, whatever the sign; -inf where too little is seen.
        which: Index of the template.
        depth: [m].
        sigma: Of the depth [m].
        inflation: (k,) as `Scan` has it.
    """

    over: NDArray[np.float32]
    which: NDArray[np.uint8]
    depth: NDArray[np.float32]
    sigma: NDArray[np.float32]
    inflation: NDArray[np.float64]


def scan(found: Difference, rate: float = FALSE_ALARMS) -> Scan:
    """Return the patches of changed wall.

    How far scores scatter is taken from the map itself, beside the patches: a first look finds them.

    Args:
        found: The difference map.
        rate: False alarms per 100 m.
    """
    rows = found.change.shape[1]
    templates = bank(found.step, rows)
    known = np.isfinite(found.change) & np.isfinite(found.sigma)
    searched = float(known.any(axis=1).sum() * found.step)
    limits = thresholds(templates, rows, found.step, rate)
    if not templates or not known.any():
        return Scan((), templates, limits, np.ones(len(templates)), searched)
    slope = slope_along(found)
    best = _slid(found, templates, limits, known, ())
    patches = _pick(found, templates, best, limits, slope)
    if patches:
        best = _slid(found, templates, limits, known, patches)
        patches = _pick(found, templates, best, limits, slope)
    patches = (*(sharpened(found, p) for p in patches[:_SHARPENED]), *patches[_SHARPENED:])
    return Scan(patches, templates, limits, best.inflation, searched)


def _slid(
    found: Difference, templates: tuple[Template, ...], limits: NDArray, known: NDArray, patches: tuple[Patch, ...]
) -> _Best:
    """Return what stands out most at each cell; rows beside `patches` do not tell how far scores scatter."""
    n, rows = known.shape
    weight = np.where(known, 1.0 / np.square(found.sigma), 0.0).astype(np.float32)
    pull = np.where(known, found.change, 0.0).astype(np.float32) * weight
    size = fft.next_fast_len(n + max(len(t.along) for t in templates), real=True)
    waves = [fft.rfft2(part, s=(size, rows)) for part in (pull, weight)]
    typical = float(np.median(weight[known]))
    over, which = np.full((n, rows), -np.inf, np.float32), np.zeros((n, rows), np.uint8)
    depth, sigma, inflation = np.zeros((n, rows), np.float32), np.zeros((n, rows), np.float32), []
    for k, t in enumerate(templates):
        top, bottom = (slide(w, t, p, (size, rows), n) for w, p in zip(waves, (1, 2), strict=True))
        seen = bottom > _LEAST_SEEN * typical * t.energy
        root = np.sqrt(np.where(seen, bottom, 1.0))
        score = np.where(seen, top / root, 0.0)
        calm = seen & _quiet(found, t, patches)[:, None]
        spread = max(1.0, 1.4826 * float(np.median(np.abs(score[calm])))) if calm.any() else 1.0
        inflation.append(spread)
        total = np.hypot(spread / root, _slow(found, t))
        score = np.where(seen, np.abs(score) / (root * total) - limits[k], -np.inf)
        better = score > over
        over[better], which[better] = score[better], k
        depth[better], sigma[better] = (top / np.where(seen, bottom, 1.0))[better], total[better]
    return _Best(over, which, depth, sigma, np.array(inflation))


def _quiet(found: Difference, one: Template, patches: tuple[Patch, ...]) -> NDArray[np.bool_]:
    """Return the rows (n,) where a template meets no patch; all of them when few are left."""
    quiet = np.ones(len(found.chainage), bool)
    for p in patches:
        quiet &= np.abs(found.chainage - p.chainage) > p.length + one.length
    return quiet if quiet.mean() > _LEAST_QUIET else np.ones_like(quiet)


def _slow(found: Difference, one: Template) -> float:
    """Return the one-sigma [m] of what a template as long as errors of attitude last takes from them."""
    return _SLOW * found.radius * min(one.length / LENGTHS[-1], 1.0)


def _pick(
    found: Difference, templates: tuple[Template, ...], best: _Best, limits: NDArray, slope: NDArray
) -> tuple[Patch, ...]:
    """Return the peaks above the limits, the clearest first; each takes what it covers with it."""
    left = np.where(np.isfinite(found.change), best.over, -np.inf)
    rows = left.shape[1]
    patches: list[Patch] = []
    taken: list[tuple[int, int, Template, float]] = []
    while len(patches) < _MOST_PATCHES:
        i, j = (int(v) for v in np.unravel_index(int(np.argmax(left)), left.shape))
        if left[i, j] < 0.0:
            break
        t, limit = templates[best.which[i, j]], float(limits[best.which[i, j]])
        depth, sigma = float(best.depth[i, j]), float(best.sigma[i, j])
        if not any(_belongs(i, j, t, depth, limit * sigma, one) for one in taken):
            spread = float(best.inflation[best.which[i, j]])
            sigma = sigma_in_doubt(found, slope, t, i, j, depth, sigma, spread)
            score = abs(depth) / sigma
            if score >= limit:
                chance = len(templates) * DISTINCT * false_alarms(score, t, rows, found.step)
                patches.append(
                    Patch(
                        float(found.chainage[i]), float(found.bearing[j]), t.length, t.width, depth, sigma,
                        float(np.copysign(score, depth)), chance,
                    )
                )  # fmt: skip
                taken.append((i, j, t, depth))
        left[
            max(i - len(t.along) // 2, 0) : i + len(t.along) // 2 + 1, (j + np.arange(-t.reach, t.reach + 1)) % rows
        ] = -np.inf
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
    shown = deep * lag * float(t.around @ np.roll(wide.around, column - j)) / t.energy
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

    One wider than 60 degrees must stand clear of ovality as well, and may need half as much again.

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
    dent = template(halve * length, halve * width, found.step, found.change.shape[1])
    known = np.isfinite(found.change)
    sigma = np.where(known.any(axis=1), found.sigma[:, 0], np.nan)
    least = np.full(len(sigma), np.inf)
    for t, limit, spread in zip(scanned.templates, scanned.thresholds, scanned.inflation, strict=True):
        shown = _shown(dent, t, shape_rows(found.step)) / t.energy
        if shown > 0:
            own = np.hypot(spread * sigma / np.sqrt(t.energy), _slow(found, t))
            least = np.fmin(least, (limit + DETECTION) * own / shown)
    return np.where(np.isfinite(sigma), least, np.nan)


def _shown(dent: Template, t: Template, width: int) -> float:
    """Return what a template sums of a dent of unit depth, less the orders 0 and 2 averaged over `width` rows."""
    taken = np.convolve(dent.along, np.full(width, 1.0 / width))
    slow = [np.fft.rfft(one.around)[[0, 2]] for one in (dent, t)]
    low = float(np.real(slow[0] * np.conj(slow[1])) @ (1.0, 2.0)) / len(t.around)
    return _overlap(dent.along, t.along) * float(dent.around @ t.around) - _overlap(taken, t.along) * low


def _overlap(a: NDArray, b: NDArray) -> float:
    """Return the sum of the product of two centred shapes."""
    half = min(len(a), len(b)) // 2
    return float(a[len(a) // 2 - half : len(a) // 2 + half + 1] @ b[len(b) // 2 - half : len(b) // 2 + half + 1])
