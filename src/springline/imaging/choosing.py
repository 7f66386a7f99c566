"""Which frames are worth looking at: geometry proposes places, a bias says from where each is seen well (6.5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import require

if TYPE_CHECKING:
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

        >>> Bias.of_view(0.15, np.radians(45.0)).high
        0.45
        """
        require(radius > 0, "radius", radius, "radius > 0 m", "give a length in metres")
        require(0 < half_view < np.pi / 2, "half_view", half_view, "0 < half_view < pi/2 rad", "give radians")
        enters = radius / np.tan(half_view)
        return cls(round(float(factors[0] * enters), 9), round(float(factors[1] * enters), 9))

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
    cameras: ArrayLike, places: ArrayLike, bias: Bias, *, each: int = 2
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the frames to look at for places that geometry proposes.

    Args:
        cameras: (frames) x of the camera in every frame [m], unknown ones NaN.
        places: (places) x of what is looked for [m].
        bias: From how far ahead.
        each: How many frames for every place, spread over the interval.

    Returns:
        Numbers of the frames, each once and in order; and for every place (places, each) its frames, -1 where none is.

    Source: 6.5.

    >>> choose_frames([0.0, 0.1, 0.2, 0.3], [0.5], Bias(0.2, 0.4))[0]
    array([1, 3])
    """
    cameras, places = np.asarray(cameras, float), np.atleast_1d(np.asarray(places, float))
    wanted = np.linspace(bias.low, bias.high, each) if each > 1 else np.array([0.5 * (bias.low + bias.high)])
    if not len(cameras) or not len(places) or np.isnan(cameras).all():
        return np.zeros(0, np.int64), np.full((len(places), each), -1)
    spacing = max(float(np.nanmedian(np.abs(np.diff(cameras)))) if len(cameras) > 1 else 0.0, 1e-9)
    off = np.abs(places[:, None, None] - cameras - wanted[:, None])
    off = np.where(np.isnan(off), np.inf, off)
    nearest = np.argmin(off, axis=-1)
    far = np.take_along_axis(off, nearest[..., None], axis=-1)[..., 0] > max(spacing, bias.high - bias.low)
    chosen = np.where(far, -1, nearest)
    return np.unique(chosen[chosen >= 0]), chosen
