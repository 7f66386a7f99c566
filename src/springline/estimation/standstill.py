"""Standstills, found in what the odometer and the inertial log say together."""

from __future__ import annotations

import numpy as np

from .data import Inertial

LEAST = 3.0
"""Shortest standstill that is looked for [s]."""
_BIN = 0.5
_QUIET = 5.0
_FLOOR = 2e-4


def still_samples(inertial: Inertial, ring_time: np.ndarray) -> np.ndarray:
    """Return whether the robot stood still at each inertial sample (m,).

    A standstill is a time of `LEAST` seconds or more without a new ring, during which the half-second means of all
    three rates stay where they are, to the noise they have there.

    Args:
        inertial: The log.
        ring_time: Times of the rings, moved to the inertial clock [s] (n,).
    """
    time = inertial.time
    still = np.zeros(len(time), bool)
    gaps = np.concatenate([[time[0], ring_time[0]], np.repeat(ring_time, 2)[1:-1], [ring_time[-1], time[-1]]])
    starts, ends = gaps[::2], gaps[1::2]
    usual = np.median(np.diff(ring_time))
    wide = ends - starts > max(LEAST, 5.0 * usual)
    # Only the few gaps that are long enough to stop in are looked at, one by one.
    for start, end in zip(starts[wide], ends[wide], strict=True):
        rows = np.arange(np.searchsorted(time, start), np.searchsorted(time, end))
        still[_quiet(inertial, rows)] = True
    return still


def _quiet(inertial: Inertial, rows: np.ndarray) -> np.ndarray:
    """Return the longest run of rows whose half-second mean rates do not move; empty when it is too short."""
    if len(rows) < 20:
        return rows[:0]
    time = inertial.time[rows]
    per_bin = max(round(_BIN / np.median(np.diff(time))), 1)
    count = len(rows) // per_bin
    means = inertial.gyro[rows[: count * per_bin]].reshape(count, per_bin, 3).mean(axis=1)
    middle = np.median(means, axis=0)
    spread = 1.4826 * np.median(np.abs(means - middle), axis=0)
    calm = (np.abs(means - middle) < _QUIET * np.maximum(spread, _FLOOR * 0.25)).all(axis=1)
    # Half a second at either end of a run may hold the last of the braking.
    edges = np.flatnonzero(np.diff(np.concatenate([[0], calm.astype(np.int8), [0]])))
    begins, stops = edges[::2] + 1, edges[1::2] - 1
    if not len(begins) or (stops - begins).max() * _BIN < LEAST:
        return rows[:0]
    longest = int(np.argmax(stops - begins))
    return rows[begins[longest] * per_bin : stops[longest] * per_bin]
