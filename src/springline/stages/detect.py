"""Detect: what stands on the wall or opens it, for other stages to mask and for `features` to confirm and size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..conventions import MASK_REASONS
from ..geometry.fitting import fit_ellipses_to_ranges
from ..geometry.marks import (
    Rings,
    add_rings,
    at_readings,
    centre_rings,
    empty_map,
    find_bumps,
    find_grooves,
    find_openings,
    find_steps,
    lasting_shape,
    steady_shape,
    tracked_centres,
    wall_deviation,
)

if TYPE_CHECKING:
    from ..config import Config, DetectConfig
    from ..geometry.marks import Seen, WallMap
    from ..survey import Survey

_BLOCK = 4096
_FEWEST = 3
_COLUMNS = 72
_PER_DIAMETER = 20
_STEADY = 4.0
_LASTING = 6.0
_FAR = 0.03
_SIGMAS = 6.0
_SCATTERED = 3.0
_MOST_OFFSET = 0.004
_BRIDGED = 0.7
_GROOVE = 0.005
_SECTORS = 36
_CODE = {name: code for code, name in MASK_REASONS.items()}
_NO_WALL = [_CODE[name] for name in ("outlier", "water", "by_hand")]
_UNSEEN = [_CODE[name] for name in ("no_return", "out_of_range")]


def detect(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/candidates`: what rings show that is not plain wall.

    Rings are compared with the section that goes on along the pipe, so that neither a dent nor an open joint draws it
    after itself. Joints are short runs of rings that stand out all round, and places where the pipe's middle or radius
    jumps; openings are patches that are missing or stand far out (6.5); what stands inward over a patch is a dent, a
    deposit or an intrusion, and `features` says which. A bump may come by chance in `detect.false_alarm` of surveys.
    `opening` flags the readings that fall on openings, so that no section is bent into a hole.

    Args:
        survey: With `/rings` and `/mask`.
        config: `detect.false_alarm`, `detect.least_depth`.

    Source: dissertation 6.5: outward or missing readings are laterals, inward ones deposits and deformation.
    """
    rings, mask = survey.rings, survey.mask
    seen, opening = seen_in_rings(rings, mask, config.detect)
    return survey.with_group("candidates", candidates(rings, seen, opening))


def seen_in_rings(rings: xr.Dataset, mask: xr.Dataset, settings: DetectConfig) -> tuple[list[Seen], np.ndarray]:
    """Return the marks of a survey's rings, and which readings (ring, bearing) fall on openings.

    Args:
        rings: `/rings`.
        mask: `/mask`.
        settings: `detect` of the settings.
    """
    count = rings.sizes["ring"]
    distance, bearings = rings["distance"].values, rings["bearing"].values
    opening = np.zeros((count, len(bearings)), bool)
    sections, noise, own = _sections(rings, mask)
    if count < _FEWEST or not np.isfinite(sections).all(axis=1).any():
        return [], opening
    diameter = 2.0 * float(np.nanmedian(sections[:, 2]))
    spacing = float(np.median(np.diff(distance))) if count > 1 else diameter
    cells, height, standing = _map(rings, mask, sections, noise, diameter, spacing)
    known = Rings(distance, own[:, :2], own[:, 2], *standing, diameter)
    joints = find_grooves(known)
    window = int(np.clip(round(0.15 * diameter / spacing), 4, 40))
    cloud = rings.attrs.get("distance_source") == "axis"
    # Rings of a cloud share an axis: what one of them is off it tells of the camera, not of the pipe.
    steps = [] if cloud else find_steps(known, joints, window=window, false_alarms=settings.false_alarm)
    rows = np.zeros(len(cells.possible), bool)
    for one in joints:
        rows[cells.row[one.first_ring] : cells.row[one.last_ring] + 1] = True
    openings = find_openings(known, cells, rows, window=_window(cells, diameter, distance))
    height[rows] = np.nan
    row_noise = cells.row_means(noise)
    if cloud:
        height[row_noise > _SCATTERED * np.quantile(row_noise, 0.25)] = np.nan
    _flag(opening, height, cells, openings)
    least = settings.least_depth * diameter
    bumps = find_bumps(cells, height, row_noise, false_alarms=settings.false_alarm, least=least)
    return sorted([*joints, *steps, *openings, *bumps], key=lambda one: one.first_ring + one.last_ring), opening


def candidates(rings: xr.Dataset, seen: list[Seen], opening: np.ndarray) -> xr.Dataset:
    """Return `/candidates` of marks seen in rings; images add theirs with the source `images`.

    Args:
        rings: `/rings`.
        seen: The marks.
        opening: (ring, bearing) readings that fall on openings.
    """
    distance = rings["distance"].values
    first, last = (np.array([getattr(one, name) for one in seen], np.int64) for name in ("first_ring", "last_ring"))
    radius = float(np.nanmedian(rings["range"].values[:: max(1, len(distance) // 200)]))

    def column(name: str) -> np.ndarray:
        return np.array([getattr(one, name) for one in seen], float)

    length = distance[last] - distance[first]
    step = np.gradient(distance)[first] if len(distance) > 1 else np.full(len(first), radius)
    joint = np.array([one.kind == "joint" for one in seen], bool)
    columns = {
        "distance": 0.5 * (distance[first] + distance[last]),
        "distance_sigma": np.hypot(0.25 * length, step / np.sqrt(12.0)),
        "bearing": column("bearing"),
        "bearing_sigma": np.where(joint, np.nan, 0.25 * column("span")),
        "size": np.where(joint, length, radius * column("span")),
        "size_sigma": np.where(joint, step, 0.25 * radius * column("span")),
        "length": length,
        "length_sigma": np.maximum(step, 0.25 * length),
        "depth": column("depth"),
        "depth_sigma": np.abs(0.25 * column("depth")),
        "score": column("score"),
        "probability": column("probability"),
    }
    words = {
        "kind": np.array([one.kind for one in seen], "U16"),
        "source": np.full(len(seen), "rings", "U8"),
        "image": np.full(len(seen), "", "U1"),
    }
    return xr.Dataset(
        {
            **{name: ("candidate", values) for name, values in (words | columns).items()},
            "first_ring": ("candidate", first),
            "last_ring": ("candidate", last),
            "opening": (("ring", "bearing"), opening.astype(np.uint8)),
        },
    )


def _sections(rings: xr.Dataset, mask: xr.Dataset) -> tuple[np.ndarray, ...]:
    """Return each ring's lasting section (ring, 5), its noise, and (ring, 3) its own centre and mean radius."""
    count, distance, bearings = rings.sizes["ring"], rings["distance"].values, rings["bearing"].values
    own, noise = np.full((count, 5), np.nan), np.full(count, np.nan)
    for rows in _blocks(count):
        fits = fit_ellipses_to_ranges(_ranges(rings, mask, rows, used=True), bearings)
        own[rows], noise[rows] = fits.parameters, fits.noise_sigma
    if not np.isfinite(own).any():
        return own, noise, own[:, :3]
    noise = np.where(np.isfinite(noise), noise, np.nanmedian(noise))
    shape = steady_shape(own[:, 2:], distance, window=_STEADY * 2.0 * float(np.nanmedian(own[:, 2])))
    start = np.where(np.isfinite(own[:, :2]), own[:, :2], np.nanmedian(own[:, :2], axis=0))
    placed = np.full((count, 5), np.nan)
    for rows in _blocks(count):
        ranges = _ranges(rings, mask, rows, used=False)
        placed[rows] = centre_rings(ranges, bearings, shape[rows], start[rows], noise[rows])
    diameter = 2.0 * float(np.nanmedian(shape[:, 0]))
    centre, good = tracked_centres(distance, placed, most_offset=_MOST_OFFSET * diameter, longest=_BRIDGED * diameter)
    own = np.where(good[:, None], np.column_stack([placed[:, :2], shape[:, 0] + placed[:, 2]]), np.nan)
    return np.concatenate([centre, shape], axis=1), noise, own


def _map(
    rings: xr.Dataset, mask: xr.Dataset, sections: np.ndarray, noise: np.ndarray, diameter: float, spacing: float
) -> tuple[WallMap, np.ndarray, tuple[np.ndarray, ...]]:
    """Return the unrolled wall, its height over what goes on, and how far and in which arcs each ring stands out."""
    count, bearings = rings.sizes["ring"], rings["bearing"].values
    length = max(spacing, diameter / _PER_DIAMETER)
    distance = rings["distance"].values
    first = empty_map(distance, len(bearings), length=length, columns=_COLUMNS)
    far = np.maximum(_FAR * diameter / 2, _SIGMAS * noise)[:, None]
    parts = list(_blocks(count))
    for rows in parts:
        deviation = wall_deviation(_ranges(rings, mask, rows, used=False), bearings, sections[rows])
        blank = np.zeros(deviation.shape, bool)
        add_rings(first, rows.start, deviation, blank, blank, far=np.inf)
    lasting = lasting_shape(first.mean, window=_window(first, diameter, distance))
    cells = empty_map(distance, len(bearings), length=length, columns=_COLUMNS)
    offset = np.zeros(count)
    sectors = min(_SECTORS, len(bearings))
    outside, known = np.zeros((count, sectors), bool), np.zeros((count, sectors), bool)
    arcs = np.searchsorted(np.arange(len(bearings)) * sectors // len(bearings), np.arange(sectors))
    for rows in parts:
        deviation = wall_deviation(_ranges(rings, mask, rows, used=False), bearings, sections[rows])
        deviation -= at_readings(cells.row[rows], cells, lasting)
        reason = mask["reason"][rows].values
        wet = reason == _CODE["water"]
        # What a cloud lacks it may never have looked at.
        missing = np.isin(reason, _UNSEEN) & (rings.attrs.get("distance_source") != "axis")
        add_rings(cells, rows.start, deviation, missing, wet, far=far[rows])
        with np.errstate(invalid="ignore"):
            out = deviation > np.maximum(_GROOVE * diameter, 4.0 * noise[rows])[:, None]
        seen = np.add.reduceat(np.isfinite(deviation), arcs, axis=1)
        known[rows], outside[rows] = seen > 0, 2 * np.add.reduceat(out, arcs, axis=1) > seen
        offset[rows] = np.where(out, deviation, 0.0).sum(axis=1) / np.maximum(out.sum(axis=1), 1)
    return cells, cells.mean, (offset, outside, known)


def _window(cells: WallMap, diameter: float, distance: np.ndarray) -> int:
    """Return over how many rows a property of the wall must go on to be the pipe's own."""
    length = (distance[-1] - distance[0]) / max(len(cells.possible) - 1, 1)
    return max(3, round(_LASTING * diameter / max(length, 1e-9)))


def _flag(opening: np.ndarray, height: np.ndarray, cells: WallMap, openings: list[Seen]) -> None:
    """Flag the readings of openings and of the cells about them, and blank these in the map of heights."""
    columns = height.shape[1]
    for one in openings:
        first, last = cells.row[one.first_ring], cells.row[one.last_ring]
        left = int(np.floor((one.bearing - 0.5 * one.span) / (2.0 * np.pi) * columns + 0.5)) - 1
        around = np.arange(left, left + round(one.span / (2.0 * np.pi) * columns) + 2) % columns
        rows = np.arange(max(first - 1, 0), min(last + 2, len(height)))
        height[np.ix_(rows, around)] = np.nan
        low, high = np.searchsorted(cells.row, [rows[0], rows[-1] + 1])
        opening[low:high] |= np.isin(cells.column, around)


def _ranges(rings: xr.Dataset, mask: xr.Dataset, rows: slice, *, used: bool) -> np.ndarray:
    """Return the ranges of some rings: those that are used, or all of the wall and what stands before or behind it."""
    reason = mask["reason"][rows].values
    kept = reason == 0 if used else ~np.isin(reason, _NO_WALL + _UNSEEN)
    return np.where(kept, rings["range"][rows].values, np.float32(np.nan))


def _blocks(count: int) -> list[slice]:
    return [slice(start, min(start + _BLOCK, count)) for start in range(0, count, _BLOCK)]
