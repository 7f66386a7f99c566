"""Profiles of two inspections on one chainage: diameters, ovality, mode, and the layout."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from .changes import Change, Profile
from .edges import COMPARED
from .verdicts import CHANGE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .difference import Difference
    from .epochs import Epoch
    from .registration import Registration

_ROLL_ASSUMED = np.radians(3.0)
_MODE_SURE = 0.95
_MODE_LENGTH = 0.3  # m: the least stretch of another mode that is told


def section_profiles(a: Epoch, b: Epoch, placed: Registration, found: Difference) -> list[Profile]:
    """Return the changes of diameters and ovality along the pipe.

    The ranges' common scale is taken out of B first. A sensor's tilt that was not estimated makes any pipe look oval by
    half its square, in all stations alike; that doubt stands in `fixed`.

    Args:
        a, b: The inspections.
        placed: Where A's rings lie in B.
        found: The difference map, for its chainage, its scale and the rows at joints.
    """
    turned = b.wall.mirrored(placed.extent_b) if placed.reversed else b.wall
    y = sum(placed.extent_b) - found.chainage_b if placed.reversed else found.chainage_b
    p_a, v_a = _along(a.wall, found.chainage)
    p_b, v_b = _along(turned, y)
    p_b = _turned(p_b, placed.roll_at(found.chainage)) / (1.0 + found.scale)
    good = placed.reliable(found.chainage) & (found.why == COMPARED).any(axis=1)
    p_a[~good] = np.nan
    tilt = np.hypot(a.wall.tilt_sigma, b.wall.tilt_sigma) ** 2 / 2.0
    radius = a.wall.radius
    scale = 2.0 * radius * found.scale_sigma
    mean, shape = np.sqrt(np.clip(v_a[:, 0] + v_b[:, 0], 0, None)), np.sqrt(np.clip(v_a[:, 1] + v_b[:, 1], 0, None))
    both = np.hypot(mean, shape)
    rows = (
        ("diameter_mean", lambda m, c, s: 2 * m, 2 * mean, radius * tilt),
        ("diameter_x", lambda m, c, s: 2 * (m + c), 2 * both, 2 * radius * tilt),
        ("diameter_y", lambda m, c, s: 2 * (m - c), 2 * both, 2 * radius * tilt),
        ("diameter_max", lambda m, c, s: 2 * (m + np.hypot(c, s)), 2 * both, 2 * radius * tilt),
        ("diameter_min", lambda m, c, s: 2 * (m - np.hypot(c, s)), 2 * both, 2 * radius * tilt),
        ("ovality", lambda m, c, s: np.hypot(c, s) / m, shape / radius, tilt / 2.0),
    )
    # An oval that is turned against the other changes its horizontal and vertical diameter.
    turn = 4.0 * np.hypot(p_a[:, 1], p_a[:, 2]) * np.nan_to_num(placed.roll_sigma_at(found.chainage), nan=_ROLL_ASSUMED)
    profiles = []
    for name, of, sigma, fixed in rows:
        before, after = of(*p_a.T), of(*p_b.T)
        wide = np.full(len(before), np.hypot(fixed, scale if name.startswith("diameter") else 0.0))
        if name in ("diameter_x", "diameter_y"):
            wide = np.hypot(wide, turn)
        profiles.append(Profile(name, before, after - before, sigma, wide))
    return profiles


def _along(wall: object, x: NDArray) -> tuple[NDArray, NDArray]:
    """Return section parameters (n, 3) and variances (n, 2) at chainage x [m]; NaN beyond the rings."""
    return tuple(
        np.column_stack([np.interp(x, wall.chainage, column, left=np.nan, right=np.nan) for column in table.T])
        for table in (wall.parameters, wall.variance)
    )


def _turned(p: NDArray, roll: NDArray) -> NDArray[np.float64]:
    mean, c, s = p.T
    cos, sin = np.cos(2 * roll), np.sin(2 * roll)
    return np.column_stack((mean, c * cos - s * sin, c * sin + s * cos))


def layout_profiles(a: Epoch, b: Epoch, placed: Registration, found: Difference) -> list[Profile]:
    """Return the changes of gradient, and of the place of the axis where both inspections are tied to known points.

    Errors of an inertial log run on along the pipe, so every sigma is one that neighbouring stations share.
    """
    if not (a.survey.has("layout") and b.survey.has("layout")):
        return []
    ties = all(e.survey.group("layout").attrs.get("frame") == "ties" for e in (a, b))
    names = ("gradient", "easting", "northing", "elevation") if ties else ("gradient",)
    good = placed.reliable(found.chainage)
    profiles = []
    for name in names:
        (v_a, s_a), (v_b, s_b) = (_layout(e, name, x) for e, x in ((a, found.chainage), (b, found.chainage_b)))
        if name == "gradient" and placed.reversed:
            v_b = -v_b
        sigma = np.hypot(s_a, s_b)
        change = np.where(good, v_b - v_a, np.nan)
        profiles.append(Profile(name, v_a, change, 0.1 * sigma, sigma))
    return profiles


def _layout(epoch: Epoch, name: str, x: NDArray) -> tuple[NDArray, NDArray]:
    data = epoch.survey.group("layout")
    at = data["chainage"].values.astype(float)
    missing = np.full(len(at), np.nan)
    columns = (data[k].values.astype(float) if k in data else missing for k in (name, f"{name}_sigma"))
    return tuple(np.interp(x, at, column, left=np.nan, right=np.nan) for column in columns)


def mode_changes(a: Epoch, b: Epoch, placed: Registration, found: Difference) -> list[Change]:
    """Return the stretches in which both inspections are sure of the section's mode, and name another."""
    modes, sure = [], []
    for epoch, x in ((a, found.chainage), (b, found.chainage_b)):
        section = epoch.survey.section
        if "mode" not in section or "mode_probability" not in section:
            return []
        at = np.searchsorted(section["chainage"].values, np.nan_to_num(x)).clip(0, section.sizes["station"] - 1)
        modes.append(section["mode"].values.astype(str)[at])
        sure.append(np.nan_to_num(section["mode_probability"].values[at]) > _MODE_SURE)
    named = [np.isin(m, ("", "undecided"), invert=True) for m in modes]
    other = (modes[0] != modes[1]) & sure[0] & sure[1] & named[0] & named[1] & placed.reliable(found.chainage)
    pair = np.where(other, np.char.add(np.char.add(modes[0], " to "), modes[1]), "")
    edges = np.flatnonzero(np.concatenate(([True], pair[1:] != pair[:-1], [True])))
    changes = []
    for first, last in pairwise(edges):
        length = (last - first) * found.step
        if pair[first] and length >= _MODE_LENGTH:
            middle, nan = float(found.chainage[(first + last - 1) // 2]), float("nan")
            words = f"mode {pair[first]}"
            changes.append(Change("mode", middle, length, nan, nan, nan, nan, nan, nan, nan, CHANGE, words))
    return changes
