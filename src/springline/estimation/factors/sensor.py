"""Where the sensor is between two knots, and the ellipse that its ring then cuts from the pipe.

The one kernel here is run by every ring, step by step for its derivatives, so it is compiled.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import atan2, cos, sin, sqrt

import numpy as np
from numba import njit

from ..rotations import pipe_frame, rotate
from ..states import AXLES, BLOCK, CLOCK, LEVER, LEVER_UP, OFFSET, SCALE, SLIP_RIGHT, SLIP_UP, State
from ..track import REACH
from .base import DERIVATIVE_STEPS

OUTPUTS = 19
"""What `locate` tells: offset y, z; robot x, y, z axes on the pipe's axes; section; way along the axis; direction."""
OUT = 13
"""What `evaluate` tells of a place: offset y, z, pitch, yaw, roll; section; way along the axis; direction."""


@dataclass(frozen=True)
class Places:
    """Places between knots, with the track's reach to them.

    Attributes:
        interval: Knot before each place (n,).
        share: Of the interval that is passed (n,).
        step: Between knots [m].
        reach: From the knot before to the place (n, 3, REACH).
        reach_by_clock: Its change per second of clock offset.
        span: From the knot before to the knot after (n, 3, REACH).
        span_by_clock: The same of `span`.
        axes: Robot axes in columns as integrated (n, 3, 3).
        axes_by_clock: The same of `axes`.
        clock: Clock offset [s] at which all these were taken.
        lever: Sensor ahead, above and right of the robot's middle [m].
    """

    interval: np.ndarray
    share: np.ndarray
    step: float
    reach: np.ndarray
    reach_by_clock: np.ndarray
    span: np.ndarray
    span_by_clock: np.ndarray
    axes: np.ndarray
    axes_by_clock: np.ndarray
    clock: float
    lever: tuple[float, float, float]

    def rows(self, chosen: np.ndarray | slice) -> Places:
        """Return the chosen places."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return Places(**{k: v[chosen] if isinstance(v, np.ndarray) else v for k, v in values.items()})

    def tracks(self) -> np.ndarray:
        """Return reach, span and axes with their changes by the clock, flat for the kernel (n, 102)."""
        parts = (self.reach, self.reach_by_clock, self.span, self.span_by_clock, self.axes, self.axes_by_clock)
        return np.concatenate([part.reshape(len(part), -1) for part in parts], axis=1)

    def evaluate(self, kind: int, state: State, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what `evaluate` tells of every place, and its slopes on the columns."""
        return evaluate(
            kind,
            self.interval,
            state.knots,
            state.scalars,
            self.share,
            self.step,
            self.tracks(),
            self.clock,
            np.asarray(self.lever, float),
            columns,
            DERIVATIVE_STEPS,
        )


def reach_weights(scalars: np.ndarray, lever: tuple[float, float, float]) -> np.ndarray:
    """Return the weights (REACH,) by which a reach adds up to a way of the sensor."""
    counted = 1.0 + scalars[SCALE]
    way = [counted, counted * scalars[SLIP_UP], counted * scalars[SLIP_RIGHT]]
    return np.array([*way, lever[0] + scalars[LEVER], lever[1] + scalars[LEVER_UP], lever[2], scalars[AXLES]])


def off_axis(knots: np.ndarray) -> np.ndarray:
    """Return the way from the axis to the sensor on Earth (n, 3) at knots (n, BLOCK)."""
    _, y, z = pipe_frame(knots[:, 8], knots[:, 9])
    return knots[:, OFFSET.start, None] * y + knots[:, OFFSET.start + 1, None] * z


def way(reach: np.ndarray, by_clock: np.ndarray, tilt: np.ndarray, scalars: np.ndarray, places: Places) -> np.ndarray:
    """Return the way of the sensor on Earth (n, 3) that a reach stands for, turned by the inertial error."""
    late = scalars[CLOCK] - places.clock
    return rotate(tilt, (reach + late * by_clock) @ reach_weights(scalars, places.lever))


@njit(cache=True)
def _turn(px, py, pz, x, y, z):
    """Return the vector x, y, z turned by the rotation vector px, py, pz."""
    square = px * px + py * py + pz * pz
    first, second = 1.0 - square / 6.0, 0.5 - square / 24.0
    if square > 1e-6:
        angle = sqrt(square)
        first, second = sin(angle) / angle, (1.0 - cos(angle)) / square
    along = px * x + py * y + pz * z
    return (
        x + first * (py * z - pz * y) + second * (along * px - square * x),
        y + first * (pz * x - px * z) + second * (along * py - square * y),
        z + first * (px * y - py * x) + second * (along * pz - square * z),
    )


@njit(cache=True)
def _point(chord, first, last, along):
    """Return the cubic's value at `along` over one coordinate, and its slope."""
    a, b = first - chord, last - chord
    rest = 1.0 - along
    value = along * chord + along * rest * (rest * a - along * b)
    return value, chord + rest * (1.0 - 3.0 * along) * a + along * (3.0 * along - 2.0) * b


@njit(cache=True)
def locate(before, after, weights, late, share, step, tracks, out):
    """Write where the sensor is and what surrounds it, as OUTPUTS says, into `out`.

    The axis is the cubic that the knots' way and directions make; the sensor follows the integrated track, its
    misclosure over the interval shared out evenly.

    Args:
        before: States of the knot before (BLOCK,).
        after: States of the knot after.
        weights: Of a reach (REACH,).
        late: Clock offset less that of the track [s].
        share: Of the interval that is passed.
        step: Between knots [m].
        tracks: One row of `Places.tracks`.
        out: (OUTPUTS,).
    """
    s0, c0, u0, l0 = sin(before[8]), cos(before[8]), sin(before[9]), cos(before[9])
    s1, c1, u1, l1 = sin(after[8]), cos(after[8]), sin(after[9]), cos(after[9])
    # Way from the axis to the sensor at either knot: y up and z right of the pipe's frame there.
    ox = -before[3] * s0 * u0 + before[4] * c0
    oy = -before[3] * c0 * u0 - before[4] * s0
    oz = before[3] * l0
    ex = before[0] - after[3] * s1 * u1 + after[4] * c1
    ey = before[1] - after[3] * c1 * u1 - after[4] * s1
    ez = before[2] + after[3] * l1
    rx = ry = rz = wx = wy = wz = 0.0
    for k in range(REACH):
        w = weights[k]
        rx += w * (tracks[k] + late * tracks[21 + k])
        ry += w * (tracks[7 + k] + late * tracks[28 + k])
        rz += w * (tracks[14 + k] + late * tracks[35 + k])
        wx += w * (tracks[42 + k] + late * tracks[63 + k])
        wy += w * (tracks[49 + k] + late * tracks[70 + k])
        wz += w * (tracks[56 + k] + late * tracks[77 + k])
    mx, my, mz = 0.5 * (before[5] + after[5]), 0.5 * (before[6] + after[6]), 0.5 * (before[7] + after[7])
    rx, ry, rz = _turn(mx, my, mz, rx, ry, rz)
    wx, wy, wz = _turn(mx, my, mz, wx, wy, wz)
    px = ox + rx + share * (ex - ox - wx)
    py = oy + ry + share * (ey - oy - wy)
    pz = oz + rz + share * (ez - oz - wz)
    length = sqrt(before[0] ** 2 + before[1] ** 2 + before[2] ** 2)
    along = share
    ax = ay = az = 0.0
    for turn in range(3):
        ax, tx = _point(before[0], s0 * l0 * length, s1 * l1 * length, along)
        ay, ty = _point(before[1], c0 * l0 * length, c1 * l1 * length, along)
        az, tz = _point(before[2], u0 * length, u1 * length, along)
        if turn < 2:
            along += ((px - ax) * tx + (py - ay) * ty + (pz - az) * tz) / (tx * tx + ty * ty + tz * tz)
    heading = before[8] + along * (after[8] - before[8])
    grade = before[9] + along * (after[9] - before[9])
    s, c, u, l = sin(heading), cos(heading), sin(grade), cos(grade)  # noqa: E741
    px, py, pz = px - ax, py - ay, pz - az
    out[0] = -px * s * u - py * c * u + pz * l
    out[1] = px * c - py * s
    tx = before[5] + share * (after[5] - before[5])
    ty = before[6] + share * (after[6] - before[6])
    tz = before[7] + share * (after[7] - before[7])
    for k in range(3):
        x = tracks[84 + k] + late * tracks[93 + k]
        y = tracks[87 + k] + late * tracks[96 + k]
        z = tracks[90 + k] + late * tracks[99 + k]
        x, y, z = _turn(tx, ty, tz, x, y, z)
        out[2 + 3 * k] = x * s * l + y * c * l + z * u
        out[3 + 3 * k] = -x * s * u - y * c * u + z * l
        out[4 + 3 * k] = x * c - y * s
    for k in range(3):
        value, _ = _point(after[10 + k] - before[10 + k], before[13 + k] * step, after[13 + k] * step, along)
        out[11 + k] = before[10 + k] + value
    out[14], out[15], out[16], out[17], out[18] = ax, ay, az, heading, grade


@njit(cache=True)
def ellipse(found, out):
    """Write the ellipse that a ring cuts from a straight pipe: centre_z, centre_y, mean_radius, oval_cos, oval_sin.

    Source: (5.4)-(5.7) as a linear map of the section onto the ring's plane; exact, and smooth at the circle.
    """
    # What one metre along the robot's z and y moves on the pipe's z and y.
    a, b, c, d = found[10], found[7], found[9], found[6]
    whole = a * d - b * c
    out[0] = -(d * found[1] - b * found[0]) / whole
    out[1] = -(a * found[0] - c * found[1]) / whole
    m, p, q = found[11], found[12], found[13]
    level = m * m + p * p + q * q
    zz, yy, zy = level + 2.0 * m * p, level - 2.0 * m * p, 2.0 * m * q
    square = whole * whole
    ring_zz = (d * d * zz - 2.0 * b * d * zy + b * b * yy) / square
    ring_yy = (c * c * zz - 2.0 * a * c * zy + a * a * yy) / square
    ring_zy = (-c * d * zz + (a * d + b * c) * zy - a * b * yy) / square
    product = sqrt(ring_zz * ring_yy - ring_zy * ring_zy)
    mean = 0.5 * sqrt(ring_zz + ring_yy + 2.0 * product)
    out[2], out[3], out[4] = mean, 0.25 * (ring_zz - ring_yy) / mean, 0.5 * ring_zy / mean


@njit(cache=True)
def pose(found, out):
    """Write offset y, z, pitch, yaw and roll, in the direct order of `conventions`."""
    a, b, c = found[2], found[3], found[4]
    out[0], out[1] = found[0], found[1]
    out[2], out[3] = atan2(b, a), atan2(c, a)
    # The direct frame's y and z, on which the robot's own z is read.
    mixed = -b * c / (1.0 + a)
    up = -b * found[8] + (1.0 - b * b / (1.0 + a)) * found[9] + mixed * found[10]
    right = -c * found[8] + mixed * found[9] + (1.0 - c * c / (1.0 + a)) * found[10]
    out[4] = atan2(up, right)


@njit(cache=True)
def _weights(scalars, lever, out):
    counted = 1.0 + scalars[SCALE]
    out[0], out[1], out[2] = counted, counted * scalars[SLIP_UP], counted * scalars[SLIP_RIGHT]
    out[3], out[4] = lever[0] + scalars[LEVER], lever[1] + scalars[LEVER_UP]
    out[5], out[6] = lever[2], scalars[AXLES]


@njit(cache=True)
def evaluate(kind, interval, knots, scalars, share, step, tracks, clock, lever, columns, steps):
    """Return values (n, r) of every place, and their slopes (n, r, c) on `columns`.

    `kind` 0: the ellipse (5); 1: pose (5), section (3), way (3), heading and grade (2).
    """
    size = 5 if kind == 0 else OUT
    count = len(interval)
    value, slopes = np.empty((count, size)), np.empty((count, size, len(columns)))
    before, after, own = np.empty(BLOCK), np.empty(BLOCK), scalars.copy()
    weights, found, moved = np.empty(REACH), np.empty(OUTPUTS), np.empty(size)
    for n in range(count):
        before[:], after[:] = knots[interval[n]], knots[interval[n] + 1]
        for k in range(-1, len(columns)):
            column = columns[k] if k >= 0 else 0
            change = steps[column] if k >= 0 else 0.0
            if column < BLOCK:
                before[column] += change
            elif column < 2 * BLOCK:
                after[column - BLOCK] += change
            else:
                own[column - 2 * BLOCK] += change
            _weights(own, lever, weights)
            locate(before, after, weights, own[CLOCK] - clock, share[n], step, tracks[n], found)
            if kind == 0:
                ellipse(found, moved)
            else:
                pose(found, moved)
                moved[5:] = found[11:]
            if k < 0:
                value[n] = moved
            else:
                slopes[n, :, k] = (moved - value[n]) / change
            if column < BLOCK:
                before[column] = knots[interval[n], column]
            elif column < 2 * BLOCK:
                after[column - BLOCK] = knots[interval[n] + 1, column - BLOCK]
            else:
                own[column - 2 * BLOCK] = scalars[column - 2 * BLOCK]
    return value, slopes
