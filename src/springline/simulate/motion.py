"""How far the robot has come at any time, and what its odometer reads."""

from __future__ import annotations

import numpy as np

from . import equipment

RAMP = 0.5
"""Time [s] in which the robot reaches its speed or stops."""

_GRID = 0.01


class Clock:
    """Travelled chainage u against time: constant speed, with stops, joined by smooth ramps.

    Args:
        start: Where the robot starts [m] (u).
        end: Where it stops for good [m].
        speed: Cruising speed [m/s].
        stops: (chainage, duration) of each stop.
    """

    def __init__(self, start: float, end: float, speed: float, stops: list[tuple[float, float]]) -> None:
        reach = 0.5 * speed * RAMP
        rows: list[tuple[float, float, float, float]] = []
        t, u, v = 0.0, start, 0.0

        def add(duration: float, to: float) -> None:
            nonlocal t, u, v
            if duration > 0.0:
                rows.append((t, u, v, to))
                t, u, v = t + duration, u + 0.5 * (v + to) * duration, to

        for place, rest in [*sorted(stops), (end, 0.0)]:
            if v == 0.0 and place > u + 2.0 * reach:
                add(RAMP, speed)
            if v > 0.0:
                add((place - reach - u) / speed, speed)
                add(RAMP, 0.0)
            add(rest, 0.0)
        self.duration = t
        self._t, self._u, self._from, self._to = (np.array(column) for column in zip(*rows, strict=True))
        self._lasts = np.append(self._t[1:], t) - self._t
        self.end = u

    def at(self, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return travelled chainage [m] and speed [m/s] at each time [s]; at rest before and after."""
        time = np.asarray(time, float)
        k = np.clip(np.searchsorted(self._t, time, side="right") - 1, 0, len(self._t) - 1)
        share = np.clip((time - self._t[k]) / self._lasts[k], 0.0, 1.0)
        change = self._to[k] - self._from[k]
        u = self._u[k] + self._lasts[k] * (self._from[k] * share + change * (share**3 - 0.5 * share**4))
        moving = (time >= 0.0) & (time <= self.duration)
        return u, np.where(moving, self._from[k] + change * share * share * (3.0 - 2.0 * share), 0.0)

    def when(self, chainage: np.ndarray) -> np.ndarray:
        """Return the time [s] at which the robot reaches each travelled chainage; at a stop, when it arrives."""
        u = np.asarray(chainage, float)
        low, high = np.zeros(u.shape), np.full(u.shape, self.duration)
        for _ in range(60):
            middle = 0.5 * (low + high)
            short = self.at(middle)[0] < u
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return 0.5 * (low + high)


class Counter:
    """The odometer's reading against travelled chainage.

    It counts the length of the robot's own path, scaled, plus slips and a random walk; 0 where the robot starts.

    Args:
        odometer: Its errors.
        chainage: Equal steps of travelled chainage (n,).
        path: Length of the robot's path [m] at each (n,).
        rng: Source of its noise.
    """

    def __init__(
        self,
        odometer: equipment.Odometer,
        chainage: np.ndarray,
        path: np.ndarray,
        start: float,
        rng: np.random.Generator,
    ) -> None:
        steps = np.diff(path)
        noise = odometer.noise * np.sqrt(steps) * rng.standard_normal(steps.size)
        # A counter wheel may count short, but never runs back.
        counted = np.maximum((1.0 + odometer.scale_error) * steps + noise, 1e-3 * steps)
        reading = np.concatenate([[0.0], np.cumsum(counted)])
        for slip in odometer.slip:
            share = np.clip((chainage - slip.chainage) / slip.length + 0.5, 0.0, 1.0)
            reading += slip.extra * share
        self._chainage = chainage
        self._reading = reading - np.interp(start, chainage, reading)

    def reading(self, chainage: np.ndarray | float) -> np.ndarray:
        """Return the reading [m] at each travelled chainage."""
        return np.interp(chainage, self._chainage, self._reading)

    def where(self, reading: np.ndarray) -> np.ndarray:
        """Return the travelled chainage [m] at which the counter shows each reading."""
        return np.interp(reading, self._reading, self._chainage)
