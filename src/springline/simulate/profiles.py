"""Quantities that vary along the pipe, as a scenario writes them.

A profile is a number; or a table of points `[[chainage, value], ...]`, joined by straight lines and held beyond the
ends; or `{mean, amplitude, period, phase_deg}`, a sine along the chainage; or `{mean, waves = [{...}, ...]}`, several.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, field_validator

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]


class Wave(BaseModel):
    """One sine: amplitude times sin(2 pi chainage / period + phase)."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    amplitude: Finite
    period: Positive
    phase_deg: Finite = 0.0


class Waves(BaseModel):
    """A mean and one or several sines upon it."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    mean: Finite = 0.0
    amplitude: Finite = 0.0
    period: Positive = 1.0
    phase_deg: Finite = 0.0
    waves: tuple[Wave, ...] = ()


class Points(BaseModel):
    """Values at chainages, joined by straight lines."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    points: tuple[tuple[Finite, Finite], ...] = Field(min_length=1)

    @field_validator("points")
    @classmethod
    def _in_order(cls, points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if any(b[0] <= a[0] for a, b in pairwise(points)):
            raise ValueError("chainages must increase from point to point")
        return points


def _form(value: object) -> str:
    """Return which form of a profile a value has, so that complaints are of that form alone."""
    if isinstance(value, dict):
        return "<points>" if "points" in value else "<waves>"
    return {Points: "<points>", Waves: "<waves>"}.get(type(value), "<number>")


Profile = Annotated[
    Annotated[Finite, Tag("<number>")] | Annotated[Waves, Tag("<waves>")] | Annotated[Points, Tag("<points>")],
    Discriminator(_form),
]


def as_profile(value: object) -> object:
    """Return what a scenario wrote as something that `Profile` accepts: a bare list becomes points."""
    return {"points": value} if isinstance(value, list | tuple) else value


def evaluate(profile: Profile, chainage: np.ndarray | float) -> np.ndarray:
    """Return the profile's value at each chainage [m].

    >>> evaluate(Waves(mean=1.0, amplitude=0.5, period=4.0), np.array([0.0, 1.0])).tolist()
    [1.0, 1.5]
    >>> evaluate(Points(points=((0.0, 1.0), (2.0, 3.0))), 1.0).tolist()
    2.0
    """
    s = np.asarray(chainage, float)
    if isinstance(profile, Waves):
        own = Wave(amplitude=profile.amplitude, period=profile.period, phase_deg=profile.phase_deg)
        return profile.mean + sum(_sine(wave, s) for wave in (own, *profile.waves))
    if isinstance(profile, Points):
        at, values = np.array(profile.points).T
        return np.interp(s, at, values)
    return np.full(s.shape, float(profile))


def extremes(profile: Profile) -> tuple[float, float]:
    """Return bounds that the profile never leaves."""
    if isinstance(profile, Waves):
        swing = abs(profile.amplitude) + sum(abs(wave.amplitude) for wave in profile.waves)
        return profile.mean - swing, profile.mean + swing
    if isinstance(profile, Points):
        values = [value for _, value in profile.points]
        return min(values), max(values)
    return float(profile), float(profile)


def is_constant(profile: Profile) -> bool:
    """Return whether the profile is the same everywhere."""
    low, high = extremes(profile)
    return low == high


def _sine(wave: Wave, s: np.ndarray) -> np.ndarray:
    return wave.amplitude * np.sin(2.0 * np.pi * s / wave.period + np.radians(wave.phase_deg))
