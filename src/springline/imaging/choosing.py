"""Which frames are worth looking at: geometry proposes places, a bias says from where each is seen well (6.5)."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import require

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Bias:
    """How far ahead of the camera things are looked for, learned step by step.

    Attributes:
        low, high: Interval of the way ahead from which frames are taken [m].
        learned: From how many places it was learned.
        needed: The farthest clear view that was needed so far, and a quarter more [m].
    """

    low: float
    high: float
    learned: int = 0
    needed: float = 0.0

    @classmethod
    def of_view(cls, radius: float, half_view: float, *, factors: tuple[float, float] = (1.5, 3.0)) -> Bias:
        """Return the interval that the viewing angle gives: so many times the way at which the wall enters view.

        Args:
            radius: Of the pipe [m].
            half_view: Half the viewing angle across the frame's shorter side [rad], inside 0 to pi/2.
            factors: mu of the text, 1.5 to 3.

        Raises:
            ParameterError: A number is out of range.

        Source: 6.5, x - mu delta, with the cotangent of erratum 34.

        >>> round(Bias.of_view(0.15, np.radians(45.0)).high, 9)
        0.45
        """
        require(radius > 0, "radius", radius, "radius > 0 m", "give a length in metres")
        require(0 < half_view < np.pi / 2, "half_view", half_view, "0 < half_view < pi/2 rad", "give radians")
        enters = radius / np.tan(half_view)
        return cls(float(factors[0] * enters), float(factors[1] * enters))

    def learn(self, ahead: float) -> Bias:
        """Return the interval after the nearest clear view of a place was found `ahead` of the camera [m].

        Until three places are known the interval is kept; then its upper end comes down to a quarter above the
        farthest clear view that was needed, and goes up again when one more is needed.

        Source: the stepwise training of 6.5.

        >>> bias = Bias(0.1, 1.0)
        >>> for ahead in (0.3, 0.25, 0.32):
        ...     bias = bias.learn(ahead)
        >>> round(bias.high, 3), bias.learned
        (0.4, 3)
        """
        needed = 1.25 * ahead
        if self.learned == 0:
            return replace(self, learned=1, high=max(self.high, needed), needed=needed)
        most = max(self.needed, needed)
        high = most if self.learned >= 2 else self.high
        return replace(self, learned=self.learned + 1, high=high, needed=most)


def choose_frames(
    cameras: ArrayLike,
    places: ArrayLike,
    low: ArrayLike,
    high: ArrayLike,
    *,
    worth: ArrayLike = 1.0,
    without: Collection[int] = (),
) -> NDArray[np.int64]:
    """Return few frames from which every place is seen well: one frame may serve several.

    The frame that serves most is taken first, then the one that serves most of what is left. Nearer the middle of a
    place's interval counts for more, by up to a third. A place without a frame in its interval gets the nearest to it,
    no farther from it than frames usually are apart.

    Args:
        cameras: (frames) x of the camera in every frame [m], unknown ones NaN.
        places: (places) x of what is looked for [m].
        low, high: (places) or scalars, from how far ahead each is seen well [m].
        worth: (places) or a scalar: below 1 a place is no reason to look at a frame, but makes it worth more.
        without: Frames that are not to be chosen.

    Returns:
        Numbers of the frames, each once and in order.

    Source: 6.5; the greedy cover.

    >>> choose_frames([0.0, 0.1, 0.2, 0.3], [0.5, 0.55], 0.2, 0.4)
    array([2])
    """
    cameras = np.asarray(cameras, dtype=float)
    places, low, high, worth = np.broadcast_arrays(
        *(np.atleast_1d(np.asarray(value, dtype=float)) for value in (places, low, high, worth))
    )
    allowed = np.isfinite(cameras)
    allowed[list(without)] = False
    frames = np.flatnonzero(allowed)
    frames = frames[np.argsort(cameras[frames], kind="stable")]
    if not len(frames):
        return np.zeros(0, np.int64)
    x = cameras[frames]
    apart = float(np.median(np.diff(x))) if len(x) > 1 else 0.0
    serves: dict[int, list[tuple[int, float]]] = {}
    for place in range(len(places)):
        nearest, farthest = places[place] - low[place], places[place] - high[place]
        first, last = np.searchsorted(x, farthest, "left"), np.searchsorted(x, nearest, "right")
        if first == last:
            beside = [at for at in (first - 1, last) if 0 <= at < len(x)]
            at = min(beside, key=lambda at: max(farthest - x[at], x[at] - nearest))
            if max(farthest - x[at], x[at] - nearest) > apart:
                continue
            first, last = at, at + 1
        half = max(0.5 * (nearest - farthest), 1e-9)
        for at in range(first, last):
            off = min(abs(x[at] - 0.5 * (nearest + farthest)) / half, 1.0)
            serves.setdefault(int(frames[at]), []).append((place, float(worth[place]) * (1.0 - off / 3.0)))
    return _cover(serves, worth)


def _cover(serves: dict[int, list[tuple[int, float]]], worth: NDArray[np.float64]) -> NDArray[np.int64]:
    """The frames of the greedy cover of all places of worth 1 or more that any frame serves."""
    done: set[int] = set()

    def gain(frame: int) -> float:
        left = [(place, value) for place, value in serves[frame] if place not in done]
        return sum(value for _, value in left) if any(worth[place] >= 1.0 for place, _ in left) else 0.0

    heap = [(-gain(frame), frame) for frame in serves]
    heapq.heapify(heap)
    chosen = []
    while heap:
        before, frame = heapq.heappop(heap)
        now = gain(frame)
        if now <= 0.0:
            continue
        if now < -before - 1e-12:  # others have served some of its places since
            heapq.heappush(heap, (-now, frame))
            continue
        chosen.append(frame)
        done.update(place for place, _ in serves[frame])
    return np.array(sorted(chosen), np.int64)
