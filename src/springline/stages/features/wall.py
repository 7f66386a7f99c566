"""The corrected pipe's wall: what each reading stands off the section that would be there without the candidates."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter

from ...conventions import MASK_REASONS
from ...geometry.marks import centre_rings, steady_shape, tracked_centres, wall_deviation
from ...geometry.measures import polar_radius

if TYPE_CHECKING:
    import xarray as xr

    from ...survey import Survey

_BLOCK = 4096
_STEADY = 4.0
_CODE = {name: code for code, name in MASK_REASONS.items()}
_NO_WALL = [_CODE[name] for name in ("outlier", "water", "by_hand", "no_return", "out_of_range")]
_UNSEEN = [_CODE[name] for name in ("no_return", "out_of_range")]
_WIDEN = np.radians(8.0)
_FOOT = 1.4
"""How much farther a smooth bump reaches than it stands in by a fifth of its depth."""
_MARGIN = 0.08
_MOST_OFFSET = 0.004
_BRIDGED = 0.7
_WHOLE = 0.85
_TILT = np.radians(1.0)
_ROLL = np.radians(2.0)
"""One-sigma of a robot's tilt and of its roll where nothing tells them."""


class Patch(NamedTuple):
    """The wall about a candidate, unrolled by pipe bearing.

    Attributes:
        rows: Rings of the window.
        x: (ring,) chainage [m].
        bearing: (bearing,) [rad], rising, the candidate's in the middle.
        height: (ring, bearing) how far out a reading stands [m]; NaN = none.
        alike: Variance of a mean over `box` cells elsewhere in the window, over that of independent readings.
    """

    rows: slice
    x: np.ndarray
    bearing: np.ndarray
    height: np.ndarray
    alike: float


class Wall:
    """The wall of a survey's rings, with sections that no candidate bends.

    Args:
        survey: With `/rings`, `/mask`, `/section`, `/pose` and `/candidates`.

    Attributes:
        sections: (ring, 5) centre_z, centre_y, mean_radius, oval_cos, oval_sin [m].
        steps: (ring, 3) centre_z, centre_y and mean radius as each ring by itself shows them; NaN where it cannot.
        chainage: (ring,) [m].
        noise: (ring,) one-sigma of a reading [m].
        pitch, yaw, roll, tilt_sigma, roll_sigma: (ring,) how the ring lies in the pipe [rad], 0 where it is not known.
        diameter, spacing: Typical ones [m].
    """

    def __init__(self, survey: Survey) -> None:
        self.rings, self.mask = survey.rings, survey.mask
        self.bearings = self.rings["bearing"].values
        section, found = survey.section, survey.candidates
        self.chainage = section["chainage"].values
        count = len(self.chainage)
        self.chainage_sigma = _or(section, "chainage_sigma", count)
        self.noise = _filled(section["noise"].values)
        self._tilt(survey, count)
        shape = section["parameters"].values
        self.diameter = 2.0 * float(np.nanmedian(shape[:, 0]))
        self.spacing = float(np.median(np.diff(self.chainage))) if len(self.chainage) > 1 else self.diameter
        self.excluded = self._footprints(found)
        self._centre(section, found)

    def _tilt(self, survey: Survey, count: int) -> None:
        """Take over how the rings are tilted in the pipe; rings about its axis are not."""
        pose, names = survey.pose, ("pitch", "yaw", "roll")
        about_axis = self.rings.attrs.get("referred_to") == "axis"
        values = [np.zeros(count) if about_axis else _or(pose, name, count) for name in names]
        self.pitch, self.yaw, self.roll = values
        known = [np.isfinite(pose[name].values) if name in pose else np.zeros(count, bool) for name in names[:2]]
        sigma = np.hypot(*(_or(pose, f"{name}_sigma", count) for name in names[:2]))
        self.tilt_sigma = np.zeros(count) if about_axis else np.where(known[0] & known[1], sigma, _TILT)
        rolled = "roll" in pose and np.isfinite(pose["roll"].values).any()
        self.roll_sigma = np.zeros(count) if about_axis else _or(pose, "roll_sigma", count)
        if not (rolled or about_axis):
            self.roll_sigma = np.full(count, _ROLL)

    def _footprints(self, found: xr.Dataset) -> np.ndarray:
        """Return which readings (ring, bearing) candidates take: openings and bumps with a margin about them."""
        shape = len(self.chainage), len(self.bearings)
        out = found["opening"].values.astype(bool) if "opening" in found else np.zeros(shape, bool)
        for k in np.flatnonzero((found["kind"].values == "inward") & (found["first_ring"].values >= 0)):
            half = _FOOT * 0.5 * float(found["size"].values[k]) / (0.5 * self.diameter) + _WIDEN
            off = np.abs(np.angle(np.exp(1j * (self.bearings - float(found["bearing"].values[k])))))
            rows = self._foot(int(found["first_ring"].values[k]), int(found["last_ring"].values[k]))
            out[rows] |= off < half
        return out

    def _foot(self, first: int, last: int) -> slice:
        """Return the rings of a candidate and of the slopes before and behind it, too low to have been found."""
        margin = round(0.5 * (_FOOT - 1.0) * (last - first) + max(1.0, _MARGIN * self.diameter / self.spacing))
        return slice(max(first - margin, 0), min(last + margin + 1, len(self.chainage)))

    def _centre(self, section: xr.Dataset, found: xr.Dataset) -> None:
        """Place the lasting section in every ring."""
        count = len(self.chainage)
        taken = self.excluded.mean(axis=1) > 0.05
        joint = (found["kind"].values == "joint") & np.isfinite(found["depth"].values)
        self.in_joint = np.zeros(count, bool)
        for first, last in zip(found["first_ring"].values[joint], found["last_ring"].values[joint], strict=True):
            if first >= 0:
                self.in_joint[max(first - 1, 0) : last + 2] = True
        shape = section["parameters"].values.copy()
        if not (taken | self.in_joint).all():
            shape[taken | self.in_joint] = np.nan
        shape = steady_shape(shape, self.chainage, window=_STEADY * self.diameter)
        start = np.column_stack([_filled(section["centre_z"].values), _filled(section["centre_y"].values)])
        placed = np.full((count, 5), np.nan)
        for low in range(0, count, _BLOCK):
            rows = slice(low, min(low + _BLOCK, count))
            ranges = np.where(self.excluded[rows], np.float32(np.nan), self._ranges(rows))
            placed[rows] = centre_rings(ranges, self.bearings, shape[rows], start[rows], self.noise[rows])
        own = np.column_stack([placed[:, 0], placed[:, 1], shape[:, 0] + placed[:, 2]])
        whole = (placed[:, 4] > _WHOLE) & (np.abs(placed[:, 2]) < _MOST_OFFSET * self.diameter)
        self.steps = np.where(whole[:, None], own, np.nan)
        placed[self.in_joint] = np.nan
        centre, _ = tracked_centres(
            self.chainage, placed, most_offset=_MOST_OFFSET * self.diameter, longest=_BRIDGED * self.diameter
        )
        self.sections = np.concatenate([centre, shape], axis=1)

    def _ranges(self, rows: slice) -> np.ndarray:
        away = np.isin(self.mask["reason"][rows].values, _NO_WALL)
        return np.where(away, np.float32(np.nan), self.rings["range"][rows].values)

    def window(self, first: int, last: int, pad: float) -> slice:
        """Return the rings from `pad` [m] before the first to as far behind the last."""
        low, high = np.searchsorted(self.chainage, [self.chainage[first] - pad, self.chainage[last] + pad])
        return slice(int(min(low, first)), int(max(high, last + 1)))

    def radius(self, rows: slice | np.ndarray, bearing: np.ndarray) -> np.ndarray:
        """Return the section's radius (ring, bearing) about its centre [m]."""
        return polar_radius(self.sections[rows][:, None, 2:], bearing)

    def deviation(self, rows: slice, sections: np.ndarray | None = None) -> np.ndarray:
        """Return how far out the readings (ring, bearing) of some rings stand [m], about their sections or others."""
        return wall_deviation(self._ranges(rows), self.bearings, self.sections[rows] if sections is None else sections)

    def unseen(self, rows: slice) -> np.ndarray:
        """Return which readings (ring, bearing) sent nothing back where others do."""
        missing = np.isin(self.mask["reason"][rows].values, _UNSEEN) & (
            self.rings.attrs.get("distance_source") != "axis"
        )
        wet = (self.mask["reason"][rows].values == _CODE["water"]).any(axis=0)
        return missing & ~wet

    def pipe_bearing(self, rows: slice) -> np.ndarray:
        """Return the bearing (ring, bearing) about the section's centre at which each ray meets the wall [rad]."""
        z0, y0, m = -self.sections[rows, 0:1], -self.sections[rows, 1:2], self.sections[rows, 2:3]
        cos, sin = np.cos(self.bearings), np.sin(self.bearings)
        along = z0 * cos + y0 * sin
        reach = np.sqrt(np.maximum(m**2 - z0**2 - y0**2 + along**2, 1e-12)) - along
        return np.arctan2(y0 + reach * sin, z0 + reach * cos)

    def ahead(self, rows: slice | np.ndarray, bearing: np.ndarray) -> np.ndarray:
        """Return how far ahead of the ring's chainage (ring, bearing) a tilted ring meets the wall [m]."""
        pitch, yaw = np.tan(self.pitch[rows])[:, None], np.tan(self.yaw[rows])[:, None]
        return -self.radius(rows, bearing) * (np.sin(bearing) * pitch + np.cos(bearing) * yaw)

    def tilt_reach(self, ring: int) -> float:
        """Return how far before or behind its chainage a ring may meet the wall [m], by its tilt and that's sigma."""
        tilt = np.hypot(self.pitch[ring], self.yaw[ring]) + self.tilt_sigma[ring]
        return float(0.5 * self.diameter * np.tan(tilt))

    def unrolled(self, rows: slice, bearing: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Return values (ring, bearing) of the sensor's bearings at bearings of the pipe: those of the nearest ray."""
        z0, y0, m = -self.sections[rows, 0:1], -self.sections[rows, 1:2], self.sections[rows, 2:3]
        seen = np.arctan2(m * np.sin(bearing) - y0, m * np.cos(bearing) - z0)
        step = 2.0 * np.pi / len(self.bearings)
        index = np.round((seen - self.bearings[0]) / step).astype(int) % len(self.bearings)
        return np.take_along_axis(values, index, axis=1)

    def patch(self, first: int, last: int, middle: float, *, pad: float, box: tuple[float, float]) -> Patch:
        """Return the wall about a candidate, less what the wall before and behind it goes on to show.

        Args:
            first, last: Rings of the candidate.
            middle: Its bearing [rad].
            pad: Length of wall on each side [m].
            box: Extents along [m] and round [rad] of the patches whose means tell how much readings err alike.
        """
        rows = self.window(first, last, pad)
        count = len(self.bearings)
        bearing = middle + (np.arange(count) - count // 2) * (2.0 * np.pi / count)
        height = self.unrolled(rows, bearing, self.deviation(rows))
        away = self.unrolled(rows, bearing, self.excluded[rows]) | self.in_joint[rows, None]
        foot = self._foot(first, last)
        low, high = max(foot.start - rows.start, 0), min(foot.stop - rows.start, len(height))
        height = height - self._going_on(height, away, self.chainage[rows], low, high)
        plain = np.where(away, np.nan, height)
        alike = _alike(plain, float(np.median(self.noise[rows])), self._cells(box))
        return Patch(rows, self.chainage[rows], bearing, height, alike)

    def _cells(self, box: tuple[float, float]) -> tuple[int, int]:
        return max(1, round(box[0] / self.spacing)), max(1, round(box[1] * len(self.bearings) / (2.0 * np.pi)))

    @staticmethod
    def _going_on(height: np.ndarray, away: np.ndarray, x: np.ndarray, low: int, high: int) -> np.ndarray:
        """Return what the wall shows before and behind the candidate's rings, bearing by bearing, linear between."""
        kept = np.isfinite(height) & ~away
        parts = []
        for part in (slice(0, low), slice(high, len(height))):
            seen = kept[part].sum(axis=0)
            mean = np.where(kept[part], height[part], 0.0).sum(axis=0) / np.maximum(seen, 1)
            if (seen > 2).mean() > 0.3:
                parts.append((float(x[part].mean()), np.where(seen > 2, mean, 0.0)))
        if not parts:
            return np.zeros_like(height)
        if len(parts) == 1:
            return np.broadcast_to(parts[0][1], height.shape)
        (x0, one), (x1, two) = parts
        share = np.clip((x - x0) / max(x1 - x0, 1e-9), 0.0, 1.0)[:, None]
        return (1.0 - share) * one + share * two


def _alike(height: np.ndarray, noise: float, box: tuple[int, int]) -> float:
    """Return the variance of means over boxes of the plain wall, over that of as many independent readings."""
    seen = np.isfinite(height)
    size = (min(box[0], height.shape[0]), min(box[1], height.shape[1]))
    share = uniform_filter(seen.astype(float), size, mode=("nearest", "wrap"))
    total = uniform_filter(np.where(seen, height, 0.0), size, mode=("nearest", "wrap"))
    fine = share > 0.7
    if fine.sum() < 50:
        return 1.0
    means = total[fine] / share[fine]
    spread = 1.4826 * np.median(np.abs(means - np.median(means)))
    return float(max(1.0, spread**2 * size[0] * size[1] / max(noise, 1e-9) ** 2))


def _filled(values: np.ndarray) -> np.ndarray:
    known = np.isfinite(values)
    return np.where(known, values, np.median(values[known]) if known.any() else np.nan)


def _or(data: xr.Dataset, name: str, count: int) -> np.ndarray:
    """Return a variable with 0 where it is missing, or all through where there is none."""
    return np.nan_to_num(data[name].values) if name in data else np.zeros(count)
