"""A run that goes out and comes back, as the two passes that it is."""

from __future__ import annotations

import numpy as np

from ..survey import Survey, add_assumption
from ..survey.overrides import changes
from ..survey.turning import turn_of


def out_and_back(survey: Survey) -> tuple[Survey, Survey | None]:
    """Return the way out, and the way back where the counter of the rings comes back; None where it does not.

    A robot cannot turn round in a pipe: on its way back it is taken to face as before, so backwards. Ties hold for both
    ways, as they are told by the counter; the inertial log is parted at the turn, a standstill there being of both.

    Args:
        survey: As read; `/rings` in the order in which they were taken.
    """
    if not survey.has("rings"):
        return survey, None
    turn = turn_of(survey.rings["distance"].values)
    if turn is None:
        return survey, None
    ways: tuple[dict, dict] = ({}, {})
    times = survey.rings["time"].values if "time" in survey.rings else None
    between = None if times is None or not np.isfinite(times).all() else (float(times[turn]), float(times[turn + 1]))
    for name in survey.groups:
        data = survey.group(name)
        if name in ("rings", "rings_rear"):
            last = turn_of(data["distance"].values)
            parts = (slice(0, None), slice(0, 0)) if last is None else (slice(0, last + 1), slice(last + 1, None))
            halves = tuple(data.isel(ring=part) for part in parts)
        elif name == "inertial" and between is not None:
            time = data["time"].values
            halves = data.isel(sample=time <= between[1]), data.isel(sample=time >= between[0])
        elif name == "frames" and between is not None and "time" in data:
            halves = data.isel(frame=~(data["time"].values > between[0])), None
        else:
            halves = data, (None if name in ("truth", "frames", "points") else data)
        for way, half in zip(ways, halves, strict=True):
            if half is not None and 0 not in (half.sizes.get("ring", 1), half.sizes.get("sample", 1)):
                way[name] = half
    out = add_assumption(
        Survey(ways[0], survey.attrs),
        f"The counter goes out to {float(survey.rings['distance'].values[turn]):.2f} m and comes back: the way back is "
        "taken as a second pass, the robot facing as before.",
    )
    if changes(survey, "mask"):
        out = add_assumption(out, "Masks by hand hold for the way out alone.")
    return out, Survey(ways[1], survey.attrs).with_attrs(facing="backwards", overrides=None)
