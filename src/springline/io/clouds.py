"""From a file's points to the group `/points`: unit, axes, and what was assumed about both."""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from ..errors import InputError
from ..survey import Survey, add_assumption
from .axes import describe, to_contract
from .units import METRES

if TYPE_CHECKING:
    from pathlib import Path

    from .options import ReadOptions

_SAMPLE = 20_000
_SLABS = 24
_NEAR = 3.0
_FARTHEST = 1e10
_PLAUSIBLE = (0.02, 15.0)
# Within which factor of the nominal a unit is believed. Nearly every program writes metres or millimetres; the others
# must fit well, and centimetres must be stated, or a nominal ten times too large would turn millimetres into them.
_BELIEVED = {"m": 3.0, "mm": 3.0, "ft": 1.5, "in": 1.5}


@dataclass(frozen=True)
class RawCloud:
    """Points as a file holds them.

    Args:
        xyz: Coordinates (point, 3) in the file's axes and unit.
        axes: Mapping to x forward, y up, z right as `axes.parse_axes` reads it.
        axes_stated: Whether the file states its axes; the default of its format otherwise.
        unit: Unit that the file states, or None.
        intensity: Per point, or None.
        time: Per point [s], or None.
        sensor_kind: One of `conventions.SENSOR_KINDS`.
        origin_is_sensor: Whether the sensor stands at the file's origin.
        notes: Sentences to add to the assumptions.
    """

    xyz: np.ndarray
    axes: str
    axes_stated: bool = False
    unit: str | None = None
    intensity: np.ndarray | None = None
    time: np.ndarray | None = None
    sensor_kind: str = "unknown"
    origin_is_sensor: bool = False
    notes: tuple[str, ...] = ()


def to_float(values: np.ndarray) -> np.ndarray:
    """Return values as float64; a damaged NaN passes without numpy's warning."""
    with np.errstate(invalid="ignore"):
        return np.asarray(values, np.float64)


def cloud_survey(raw: RawCloud, path: Path, options: ReadOptions) -> Survey:
    """Return a survey with `/points` [m] in x forward, y up, z right, and what was assumed on the way.

    Points with a missing coordinate, and points at exactly (0, 0, 0), are no returns and are left out, counted in the
    assumptions.

    Raises:
        InputError: No point is left, or the unit cannot be told or contradicts the nominal diameter.
    """
    notes = list(raw.notes)
    keep, dropped = _returns(raw.xyz)
    if not keep.any():
        raise InputError("no point has coordinates", where=path, expected="at least one point")
    farthest = float(np.abs(raw.xyz[keep]).max())
    if farthest > _FARTHEST:
        raise InputError(
            f"a coordinate is {farthest:g}", where=path, expected=f"up to {_FARTHEST:g}", mend="the file may be damaged"
        )
    if dropped:
        notes.append(f"{path.name}: {dropped} points without coordinates or at (0, 0, 0) were left out as no return.")
    xyz = raw.xyz if keep.all() else raw.xyz[keep]
    axes = options.axes or raw.axes
    if not (options.axes or raw.axes_stated):
        notes.append(f"{path.name}: the file does not state its axes; taken {describe(axes)} (--axes overrules).")
    x, y, z = to_contract(xyz, axes)
    unit, sentence = _unit(raw, (x, y, z), path, options)
    if sentence:
        notes.append(sentence)
    scale = METRES[unit]
    variables = {name: ("point", values * scale) for name, values in (("x", x), ("y", y), ("z", z))}
    if raw.intensity is not None:
        variables["intensity"] = ("point", np.asarray(raw.intensity, np.float32)[keep])
    if raw.time is not None:
        variables["time"] = ("point", np.asarray(raw.time, np.float64)[keep])
    attrs = {
        "source_axes": axes,
        "sensor_kind": options.sensor or raw.sensor_kind,
        "origin_is_sensor": int(raw.origin_is_sensor),
    }
    return add_assumption(Survey({"points": xr.Dataset(variables, attrs=attrs)}), *notes)


def _returns(xyz: np.ndarray) -> tuple[np.ndarray, int]:
    keep = np.isfinite(xyz).all(axis=1) & (xyz != 0).any(axis=1)
    return keep, int(keep.size - keep.sum())


def _unit(
    raw: RawCloud, xyz: tuple[np.ndarray, np.ndarray, np.ndarray], path: Path, options: ReadOptions
) -> tuple[str, str | None]:
    """Return the unit and the sentence that states an assumed one."""
    nominal = options.nominal_diameter
    stated = options.unit or raw.unit
    if stated:
        check_nominal(*xyz, nominal, path, unit=stated)
        return stated, None
    size = min(_cross_sizes(*xyz))
    if nominal:
        off = {unit: abs(log(max(size, 1e-300) * METRES[unit] / nominal)) for unit in _BELIEVED}
        fitting = [unit for unit, most in _BELIEVED.items() if off[unit] <= log(most)]
        if not fitting:
            raise _off_nominal(size, "m", nominal, path)
        unit = min(fitting, key=off.__getitem__)
        return unit, (
            f"{path.name}: the file states no unit; taken as {unit}, because the points then lie about "
            f"{size * METRES[unit]:.3g} m across, nearest to the nominal {nominal:g} m (--unit overrules)."
        )
    if not _PLAUSIBLE[0] <= size <= _PLAUSIBLE[1]:
        raise InputError(
            f"the file states no unit, and in metres the points would lie about {size:.3g} m across",
            where=path,
            expected=f"a pipe of {_PLAUSIBLE[0]:g} to {_PLAUSIBLE[1]:g} m",
            mend="state the unit with --unit mm|cm|m|in|ft, or the diameter with --nominal",
        )
    return "m", (
        f"{path.name}: the file states no unit; taken as metres, so the points lie about {size:.3g} m across "
        "(--unit overrules)."
    )


def check_nominal(
    x: np.ndarray, y: np.ndarray, z: np.ndarray, nominal: float | None, path: Path, *, unit: str = "m"
) -> None:
    """Refuse points whose rough width is not within a factor of three of the nominal diameter.

    Args:
        x: Forward, in `unit`.
        y: Up, in `unit`.
        z: To the right, in `unit`.
        nominal: Nominal diameter [m]; nothing is checked without one.
        path: The file, for messages.
        unit: Unit of the coordinates.

    Raises:
        InputError: The two are further apart; the unit or the nominal is wrong.
    """
    if nominal is None:
        return
    sizes = _cross_sizes(x, y, z)
    if not any(1 / _NEAR <= size * METRES[unit] / nominal <= _NEAR for size in sizes):
        raise _off_nominal(min(sizes), unit, nominal, path)


def _off_nominal(size: float, unit: str, nominal: float, path: Path) -> InputError:
    return InputError(
        f"in {unit} the points lie about {size * METRES[unit]:.3g} m across, far from the nominal {nominal:g} m",
        where=path,
        expected=f"between a third and three times the nominal, {nominal / _NEAR:.3g} to {nominal * _NEAR:.3g} m",
        mend="state the right unit with --unit mm|cm|m|in|ft, or mend --nominal",
    )


def _cross_sizes(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[float, float]:
    """Return two rough diameters in file units: about the sensor's own axis, and from slabs across the cloud.

    The first holds for a sensor inside the pipe, the second for a cloud whose origin lies elsewhere; scenery seen
    beyond the pipe's end inflates either, so the smaller is the better guess.
    """
    step = max(1, len(x) // _SAMPLE)
    points = np.column_stack([v[::step] for v in (x, y, z)])
    about_axis = 2.0 * float(np.median(np.hypot(points[:, 1], points[:, 2])))
    if len(points) < _SLABS:
        return about_axis, about_axis
    centred = points - np.median(points, axis=0)
    _, directions = np.linalg.eigh(np.cov(centred.T))
    order = np.argsort(centred @ directions[:, -1])
    # A slab of a curved run is nearly straight, and the median over slabs passes over scenery.
    slabs = np.array_split(centred[order], min(_SLABS, len(points) // _SLABS))
    return about_axis, float(np.median([_two_alike(slab) for slab in slabs]))


def _two_alike(points: np.ndarray) -> float:
    """Return the mean of those two principal extents that are most alike: a pipe's width and height."""
    _, directions = np.linalg.eigh(np.cov(points.T))
    low, high = np.quantile(points @ directions, (0.05, 0.95), axis=0)
    extents = np.maximum(np.sort(high - low), 1e-12)
    k = int(np.argmin(extents[1:] / extents[:-1]))
    return float(np.sqrt(extents[k] * extents[k + 1]))
