"""Each kind of candidate sized: joints, laterals, and what stands inward."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...geometry.marks import fit_bore, size_bump, size_gap, size_step

if TYPE_CHECKING:
    from collections.abc import Iterator

    import xarray as xr

    from ...config import DetectConfig
    from ...geometry.marks import Bump
    from .wall import Wall

Row = dict[str, object]

_STEP_WINDOW, _STEP_MOST = 0.1, 0.03
_PAD = 1.0
_OPEN = 0.02
_INTRUSION = 0.7
_LOWER_THIRD = np.radians(60.0)
_KIND_SURE = 0.8
_SURE, _SURE_DEPTH = 4.0, 6.0
"""Sigmas by which a bore must be wide, and a bump deep, to be reported."""
_BLUR, _UNSURE = 0.75, 0.05
_WHEEL = 0.025  # m: radius of the small wheels that robots for small pipes run on
_INVERT, _AT_INVERT = -0.64, 0.4
"""Sine of the bearing below which an opening is doubted, and by how much: there water and beds mislead rings."""
_SMALL, _LONE = 0.15, 0.4
"""Part of the diameter under which an opening that one ring alone shows is doubted, and by how much: a joint cuts a
tilted ring at a few bearings, too."""


class Sizer:
    """Sizes candidates seen in rings.

    Args:
        wall: The corrected pipe's wall.
        found: `/candidates`.
        which: Indices of those seen in rings.
        settings: `detect` of the settings.
    """

    def __init__(self, wall: Wall, found: xr.Dataset, which: np.ndarray, settings: DetectConfig) -> None:
        self.wall, self.settings = wall, settings
        names = ("kind", "bearing", "size", "depth", "probability", "first_ring", "last_ring")
        columns = [found[name].values for name in names]
        self.seen = [dict(zip(names, row, strict=True)) for row in zip(*(c[which] for c in columns), strict=True)]
        self.count = int(np.clip(round(min(_STEP_WINDOW * wall.diameter, _STEP_MOST) / wall.spacing), 6, 60))
        self.ring_noise = np.full(3, float(np.median(wall.noise)) * np.sqrt(2.0 / len(wall.bearings)))

    def rows(self) -> Iterator[Row]:
        """Yield the features."""
        openings = [one for one in self.seen if one["kind"] == "lateral"]
        for one in self.seen:
            row = None
            if one["kind"] == "joint":
                row = self._joint(one)
            elif one["kind"] == "lateral":
                row = self._lateral(one)
            elif not any(self._touch(one, other) for other in openings):
                row = self._bump(one)
            if row is not None:
                yield row | {"source": "rings", "first_ring": one["first_ring"], "last_ring": one["last_ring"]}

    def _touch(self, one: Row, other: Row) -> bool:
        """Return whether an inward patch adjoins an opening."""
        reach = 0.1 * self.wall.diameter
        x = self.wall.chainage
        apart = max(x[other["first_ring"]] - x[one["last_ring"]], x[one["first_ring"]] - x[other["last_ring"]])
        turn = abs(np.angle(np.exp(1j * (one["bearing"] - other["bearing"]))))
        return bool(apart < reach and turn * self.wall.diameter / 2 < 0.5 * (one["size"] + other["size"]) + reach)

    def _place(self, x: float, sigma: float, bearing: float) -> Row:
        """Return chainage and bearing on the pipe of what was measured in a ring's frame, tilt and roll corrected."""
        wall = self.wall
        ring = int(np.argmin(np.abs(wall.chainage - x)))
        row: Row = {}
        unknown = wall.diameter / 2 * wall.tilt_sigma[ring]
        if np.isfinite(bearing):
            x = x + float(wall.ahead(slice(ring, ring + 1), np.array([[bearing]]))[0, 0])
            row["bearing"] = (bearing + wall.roll[ring]) % (2.0 * np.pi)
        else:
            unknown = 0.0
        row["chainage"] = x
        row["chainage_sigma"] = float(np.sqrt(sigma**2 + unknown**2 + wall.chainage_sigma[ring] ** 2))
        return row

    def _joint(self, one: Row) -> Row | None:
        wall, x = self.wall, self.wall.chainage
        first, last = int(one["first_ring"]), int(one["last_ring"])
        reach = max(3, round(0.05 * wall.diameter / wall.spacing))
        rows = slice(max(first - reach, 0), min(last + reach + 1, len(x)))
        noise = float(np.median(wall.noise[rows]))
        gap = None
        if np.isfinite(one["depth"]):
            before, after = (wall.deviation(rows, self._carried(rows, first, last, side)) for side in (-1, 1))
            gap = size_gap(before, after, x[rows], wall.bearings, noise=noise, radius=0.5 * wall.diameter)
            if gap and gap.gap_sigma > _BLUR * wall.spacing + 0.2 * gap.gap:
                gap = None
        half = 0.5 * max(x[last] - x[first], 0.0) + wall.spacing
        at, at_sigma = (gap.middle, gap.middle_sigma) if gap else (0.5 * (x[first] + x[last]), half / np.sqrt(3.0))
        # A tilted ring beside a joint in which none stands may be cut by it.
        reach = gap.reach if gap else 0.5 * (x[last] - x[first]) + wall.tilt_reach((first + last) // 2)
        off = size_step(x, wall.steps, at, at_sigma=at_sigma, reach=reach, noise=self.ring_noise)
        # Rings of a cloud share an axis: what one of them is off it tells of the camera, not of the pipe.
        cloud = wall.rings.attrs.get("distance_source") == "axis"
        if off and (cloud or not (off.step_sigma[:2] < _UNSURE * wall.diameter).all()):
            off = None
        if gap is None and off is None:
            return None
        row: Row = {"kind": "joint", "confidence": one["probability"]}
        row |= self._place(at, at_sigma, np.nan)
        if gap and not cloud:
            # Oblique rays blur a gap along a cloud.
            sigma = gap.gap_sigma if off is None else float(np.hypot(gap.gap_sigma, _climb(off.step)))
            row |= {"size": gap.gap, "size_sigma": sigma, "length": gap.gap, "length_sigma": sigma}
        if gap:
            row |= {"depth": gap.depth, "depth_sigma": gap.depth_sigma}
        if off:
            row |= _set_off(off.step, off.step_sigma, off.turn, off.turn_sigma)
        return row

    def _carried(self, rows: slice, first: int, last: int, side: int) -> np.ndarray:
        """Return the sections (ring, 5) of the pipe before (side -1) or after (+1) a joint, carried on across it."""
        wall, x = self.wall, self.wall.chainage
        known = np.flatnonzero(np.isfinite(wall.steps).all(axis=1))
        near = known[known < first][-self.count :] if side < 0 else known[known > last][: self.count]
        out = wall.sections[rows].copy()
        if len(near) < 3:
            return out
        for column in (0, 1):
            slope, level = np.polyfit(x[near] - x[near[0]], wall.steps[near, column], 1)
            out[:, column] = level + slope * (x[rows] - x[near[0]])
        out[:, 2] = np.median(wall.steps[near, 2])
        return out

    def _lateral(self, one: Row) -> Row | None:
        wall = self.wall
        first, last = int(one["first_ring"]), int(one["last_ring"])
        rows = wall.window(first, last, max(4.0 * wall.spacing, 0.15 * wall.diameter))
        theta = wall.pipe_bearing(rows)
        middle = float(np.angle(np.exp(1j * theta[:, self._column(one["bearing"])]).mean()))
        half = one["size"] / wall.diameter + np.radians(20.0)
        turn = np.angle(np.exp(1j * (theta - middle)))
        order = np.argsort(np.median(turn, axis=0))
        order = order[np.abs(np.median(turn, axis=0))[order] < min(half, np.radians(150.0))]
        turn = turn[:, order]
        noise = float(np.median(wall.noise[rows]))
        least = max(_OPEN * wall.diameter / 2, 5.0 * noise)
        height = wall.deviation(rows)[:, order]
        missing = _dense(wall.unseen(rows)[:, order])
        with np.errstate(invalid="ignore"):
            inside = (height > least) | missing
        known = (np.isfinite(height) | missing) & ~wall.in_joint[rows, None]
        bearing = middle + turn
        x = wall.chainage[rows, None] + wall.ahead(rows, bearing)
        radius = wall.radius(rows, bearing)
        near = self._near(inside, turn, rows, one)
        bore = fit_bore(
            x, bearing, radius + least, near, known, wall=float(np.median(radius)), noise=0.3 * wall.spacing + noise
        )
        if bore is None or not bore.values[2] > _SURE * np.sqrt(bore.covariance[2, 2]):
            return None
        sigma = np.sqrt(np.diag(bore.covariance))
        bearing = float(bore.values[1])
        ring = int(np.argmin(np.abs(wall.chainage - bore.values[0])))
        tilt = wall.diameter / 2 * wall.tilt_sigma[ring]
        cos = np.cos(bore.values[3])
        sure = float(one["probability"]) * float(np.clip((bore.agreement - 0.2) / 0.5, 0.0, 1.0))
        if np.sin(bearing) < _INVERT:
            sure *= _AT_INVERT
        if first == last and 2.0 * bore.values[2] < _SMALL * wall.diameter:
            sure *= _LONE
        row: Row = {
            "kind": "lateral",
            "chainage": float(bore.values[0]),
            "chainage_sigma": float(np.sqrt(sigma[0] ** 2 + tilt**2 + wall.chainage_sigma[ring] ** 2)),
            "bearing": (bearing + wall.roll[ring]) % (2.0 * np.pi),
            "bearing_sigma": float(np.hypot(sigma[1], wall.roll_sigma[ring])),
            "size": 2.0 * float(bore.values[2]),
            "size_sigma": 2.0 * float(sigma[2]),
            "length": 2.0 * float(bore.values[2] / cos),
            "length_sigma": 2.0 * float(np.hypot(sigma[2] / cos, bore.values[2] * np.sin(bore.values[3]) * sigma[3])),
            "inclination": float(bore.values[3]),
            "inclination_sigma": float(sigma[3]),
            "confidence": sure,
        }
        return row | self._protrusion(height, inside, x, middle + turn, bore.values)

    def _near(self, inside: np.ndarray, turn: np.ndarray, rows: slice, one: Row) -> np.ndarray:
        """Return the readings beyond the wall that belong to the opening, not to another one in the window."""
        x, reach = self.wall.chainage, 2.0 * self.wall.spacing + 0.05 * self.wall.diameter
        along = (x[rows] > x[one["first_ring"]] - reach) & (x[rows] < x[one["last_ring"]] + reach)
        half = 0.5 * one["size"] / (self.wall.diameter / 2) + np.radians(12.0)
        return inside & along[:, None] & (np.abs(turn) < half)

    def _protrusion(
        self, height: np.ndarray, inside: np.ndarray, x: np.ndarray, bearing: np.ndarray, bore: np.ndarray
    ) -> Row:
        """Return how far a lateral's end stands into the pipe, where it does: inward readings about its bore."""
        radius = self.wall.diameter / 2
        apart = np.hypot(x - bore[0], radius * np.sin(bearing - bore[1])) - bore[2]
        about = (np.abs(apart) < 0.08 * self.wall.diameter) & ~inside & np.isfinite(height)
        inward = about & (height < -max(0.03 * radius, 6.0 * float(np.median(self.wall.noise))))
        if inward.sum() < 6 or inward.sum() < 0.1 * about.sum():
            return {}
        deepest = -np.sort(height[inward])[: max(3, int(0.1 * inward.sum()))]
        return {"protrusion": float(np.median(deepest)), "protrusion_sigma": float(np.std(deepest) + self.wall.spacing)}

    def _column(self, bearing: float) -> int:
        return int(np.argmin(np.abs(np.angle(np.exp(1j * (self.wall.bearings - bearing))))))

    def _bump(self, one: Row) -> Row | None:
        wall = self.wall
        first, last = int(one["first_ring"]), int(one["last_ring"])
        ring = (first + last) // 2
        middle = float(wall.pipe_bearing(slice(ring, ring + 1))[0, self._column(one["bearing"])])
        length, span = wall.chainage[last] - wall.chainage[first] + wall.spacing, one["size"] / (wall.diameter / 2)
        patch = wall.patch(first, last, middle, pad=_PAD * wall.diameter, box=(0.3 * length, 0.3 * span))
        found = size_bump(
            patch.x,
            patch.bearing,
            patch.height,
            (0.5 * (wall.chainage[first] + wall.chainage[last]), middle),
            radius=wall.diameter / 2,
            reach=(length, span),
            noise=float(np.median(wall.noise[patch.rows])),
            alike=patch.alike,
        )
        if found is None or -found.depth[0] < max(
            self.settings.least_depth * wall.diameter, _SURE_DEPTH * found.depth[1]
        ):
            return None
        if not np.isfinite([*found.depth, *found.length, *found.span]).all():
            return None
        kind, sure = self._kind(found)
        row: Row = {"kind": kind, "confidence": float(one["probability"]) * sure}
        row["bearing_sigma"] = float(np.hypot(found.bearing[1], wall.roll_sigma[ring]))
        row |= self._place(found.x[0], found.x[1], found.bearing[0])
        row |= {"depth": found.depth[0], "depth_sigma": found.depth[1]}
        row |= {"length": found.length[0], "length_sigma": found.length[1]}
        row |= {"size": found.span[0] * wall.diameter / 2, "size_sigma": found.span[1] * wall.diameter / 2}
        return row

    def _kind(self, bump: Bump) -> tuple[str, float]:
        """Return what stands inward and how sure that is: rings alone tell a deposit from a dent by where it lies."""
        if bump.steep > _INTRUSION:
            return "intrusion", _KIND_SURE
        low = abs(np.angle(np.exp(1j * (bump.bearing[0] + 0.5 * np.pi)))) < _LOWER_THIRD
        return ("deposit" if low else "dent"), _KIND_SURE


def _climb(step: np.ndarray) -> float:
    """Return how far a counter is off [m] while its wheel climbs a step (right, up, radius) [m].

    A wheel of radius r that rolls over a step h turns by r acos(1 - h / r) while it goes sqrt(2 r h - h^2): by up to
    h^2 / r less, for steps up to a third of it.
    """
    return float(np.hypot(step[0], step[1]) ** 2 / _WHEEL)


def _set_off(step: np.ndarray, step_sigma: np.ndarray, turn: np.ndarray, turn_sigma: np.ndarray) -> Row:
    """Return the columns of a joint's displacement (right, up, radius) and turn (right, up)."""
    row: Row = {}
    for name, k in (("step_z", 0), ("step_y", 1), ("step_radius", 2)):
        row[name], row[f"{name}_sigma"] = float(step[k]), float(step_sigma[k])
    for name, k in (("kink_right", 0), ("kink_up", 1)):
        row[name], row[f"{name}_sigma"] = float(turn[k]), float(turn_sigma[k])
    for name, values, sigma in (("step", step[:2], step_sigma[:2]), ("kink", turn, turn_sigma)):
        size = float(np.hypot(*values))
        row[name] = size
        row[f"{name}_sigma"] = float(np.hypot(*(values * sigma)) / size) if size > 0 else float(np.max(sigma))
    return row


def _dense(missing: np.ndarray) -> np.ndarray:
    """Return the missing readings that are not alone: most of the three about them round the ring are missing too."""
    padded = np.pad(missing, ((0, 0), (1, 1)), mode="edge").astype(int)
    return missing & (padded[:, :-2] + padded[:, 1:-1] + padded[:, 2:] >= 2)
