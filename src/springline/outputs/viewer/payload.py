"""What the viewer draws, packed: small facts as JSON, arrays as one compressed block."""

from __future__ import annotations

import base64
import zlib
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from ...conventions import FIT_STATUS
from ..colours import LEVELS, REASON_COLOURS, nice_limit, rgb, scale_colours
from ..tables import features_table
from ..unroll import NO_STATION, REASON_WORDS, REASONS
from .brightness import GREYS, brightness_of

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled
    from .epochs import Epoch

_LARGEST = 32000
"""Departures in ticks stay within this; below it stand the reasons of empty cells."""

_DIAMETERS = ("diameter_max", "diameter_min", "diameter_x", "diameter_y", "diameter_area")
_VALUES = (
    *_DIAMETERS,
    *(f"{name}_sigma" for name in _DIAMETERS),
    "ovality_polar",
    "ovality_polar_low",
    "ovality_polar_high",
    "deflection",
    "deflection_sigma",
    "area_loss",
    "capacity_loss",
    "semi_major",
    "semi_minor",
    "axis_bearing",
    "diameter_max_bearing",
)


_LAYOUT = ("elevation", "gradient")


def pack(results: Results, wall: Unrolled, other: Epoch | None = None) -> tuple[dict[str, Any], str]:
    """Return the viewer's header and its arrays, compressed (zlib) and in base64.

    The arrays stand one after the other as the header's `arrays` lists them, little-endian. `shape` holds, for each
    group of stations and bearing, the departure from the circle in ticks; -32768 plus a flag of `unroll.REASONS`
    where there is none. `other` holds the same of another inspection, when there is one. Values of a group are those of
    its worst station.

    Args:
        results: The finished survey.
        wall: Its unrolled wall.
        other: Another inspection on the same cells.
    """
    station = _representatives(results, wall)
    walls = [wall] if other is None else [wall, other.wall]
    furthest = max(float(np.abs(one.shape[np.isfinite(one.shape)]).max(initial=0.0)) for one in walls)
    tick = max(1e-5, furthest / _LARGEST)
    brightness = brightness_of(wall)
    shades = GREYS if brightness is None else brightness.shades
    arrays = {
        "start": wall.start.astype("<f8"),
        "end": wall.end.astype("<f8"),
        "chainage": results.chainage[station].astype("<f8"),
        **{name: results.metric(name)[station].astype("<f4") for name in _VALUES},
        "coverage": results.coverage[station].astype("<f4"),
        "status": results.status[station].astype("<f4"),
        **{name: results.station("layout", name)[station].astype("<f4") for name in _layout(results)},
        "shape": _ticks(wall, tick),
        **({} if other is None else {"other": _ticks(other.wall, tick)}),
        # Bytes stand last, so that what is wider keeps its place in memory.
        "speaks": results.speaks[station].astype(np.uint8),
        **({} if brightness is None else {"intensity": brightness.cells}),
    }
    reference = results.metrics_attr("reference_diameter")
    header = {
        "name": str(results.survey.attrs.get("name") or "Pipe without a name"),
        "groups": int(wall.start.size),
        "rows": int(wall.bearing.size),
        "tick": tick,
        "circle": wall.circle_diameter,
        "reference": reference if isfinite(reference) else None,
        "referenceKind": str(results.survey.metrics.attrs.get("reference_kind", "none")),
        "limits": _limits(wall, other),
        "otherName": None if other is None else other.name,
        "otherLater": other is not None and other.later,
        "joined": -(-results.stations // int(wall.start.size)),
        "palette": [*scale_colours().tolist(), *(list(rgb(colour)) for colour in _reasons().values()), *shades],
        "brightnessOf": None if brightness is None else brightness.name,
        "greys": LEVELS + len(_reasons()),
        "levels": LEVELS,
        "reasons": {flag: LEVELS + k for k, flag in enumerate(_reasons())},
        "reasonWords": {flag: REASON_WORDS[{**REASONS, NO_STATION: "no_station"}[flag]] for flag in _reasons()},
        "statusWords": dict(FIT_STATUS),
        "features": _features(results),
        "arrays": [[name, values.dtype.str[1:], int(values.size)] for name, values in arrays.items()],
    }
    packer = zlib.compressobj(6)
    parts = [packer.compress(np.ascontiguousarray(values).data) for values in arrays.values()]
    parts.append(packer.flush())
    return header, base64.b64encode(b"".join(parts)).decode("ascii")


def _layout(results: Results) -> list[str]:
    return [name for name in _LAYOUT if np.isfinite(results.station("layout", name)).any()]


def _limits(wall: Unrolled, other: Epoch | None) -> dict[str, float]:
    limits = {"shape": nice_limit(wall.shape), "surface": nice_limit(wall.surface)}
    if other is None:
        return limits
    # Two inspections are compared by the same colours.
    limits["shape"] = limits["other"] = max(limits["shape"], nice_limit(other.wall.shape))
    return limits | {"difference": nice_limit(wall.shape - other.wall.shape)}


def _representatives(results: Results, wall: Unrolled) -> np.ndarray:
    """Return the worst speaking station of each group: by deflection, else by ovality, else the first."""
    severity = results.judged("deflection")
    if not np.isfinite(severity).any():
        severity = results.judged("ovality_polar")
    severity = np.nan_to_num(severity, nan=-np.inf, posinf=np.inf, neginf=-np.inf)
    first = np.searchsorted(results.extents[0], wall.start)
    counts = np.diff(np.append(first, results.stations))
    most = np.repeat(np.maximum.reduceat(severity, first), counts)
    place = np.where(severity == most, np.arange(results.stations), results.stations)
    return np.minimum.reduceat(place, first)


def _ticks(wall: Unrolled, tick: float) -> np.ndarray:
    ticks = np.rint(np.nan_to_num(wall.shape) / np.float32(tick))
    return np.where(wall.reason == 0, ticks, -32768.0 + wall.reason).astype("<i2")


def _reasons() -> dict[int, str]:
    named = {**REASONS, NO_STATION: "no_station"}
    return {flag: REASON_COLOURS[name] for flag, name in named.items() if flag}


def _features(results: Results) -> list[dict[str, Any]]:
    def known(value: float, factor: float = 1.0) -> float | None:
        return float(value) * factor if isfinite(value) else None

    return [
        {
            "number": number,
            "kind": row.kind,
            "chainage": float(row.chainage_m),
            "sigma": known(row.chainage_sigma_m),
            "clock": known(row.clock_h),
            "size": known(row.size_mm, 1e-3),
            "length": known(row.length_mm, 1e-3),
            "depth": known(row.depth_mm, 1e-3),
            "confidence": known(row.confidence),
            "source": row.source,
            "image": row.image,
        }
        for number, row in enumerate(features_table(results.survey).itertuples(), 1)
        if isfinite(row.chainage_m)
    ]
