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
from ..unroll import REASON_WORDS, REASONS

if TYPE_CHECKING:
    from ..results import Results
    from ..unroll import Unrolled

_LARGEST = 32000
"""Departures in ticks stay within this; below it stand the reasons of empty cells."""

_VALUES = (
    "diameter_max",
    "diameter_min",
    "diameter_x",
    "diameter_y",
    "diameter_area",
    "ovality_polar",
    "ovality_polar_low",
    "ovality_polar_high",
    "deflection",
    "deflection_sigma",
    "semi_major",
    "semi_minor",
    "axis_bearing",
    "diameter_max_bearing",
)


def pack(results: Results, wall: Unrolled) -> tuple[dict[str, Any], str]:
    """Return the viewer's header and its arrays, compressed (zlib) and in base64.

    The arrays stand one after the other as the header's `arrays` lists them, little-endian. `shape` holds, for each
    group of stations and bearing, the departure from the circle in ticks; -32768 plus a flag of `unroll.REASONS`
    where there is none. Values of a group are those of its worst station.

    Args:
        results: The finished survey.
        wall: Its unrolled wall.
    """
    station = _representatives(results, wall)
    finite = np.abs(wall.shape[np.isfinite(wall.shape)])
    tick = max(1e-5, float(finite.max(initial=0.0)) / _LARGEST)
    arrays = {
        "start": wall.start.astype("<f8"),
        "end": wall.end.astype("<f8"),
        "chainage": results.chainage[station].astype("<f8"),
        **{name: results.metric(name)[station].astype("<f4") for name in _VALUES},
        "coverage": results.coverage[station].astype("<f4"),
        "status": results.status[station].astype("<f4"),
        "shape": _ticks(wall, tick),
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
        "limits": {"shape": nice_limit(wall.shape), "surface": nice_limit(wall.surface)},
        "joined": -(-results.stations // int(wall.start.size)),
        "palette": [*scale_colours().tolist(), *(list(rgb(colour)) for colour in _reasons().values())],
        "levels": LEVELS,
        "reasons": {flag: LEVELS + k for k, flag in enumerate(_reasons())},
        "reasonWords": {flag: REASON_WORDS[REASONS[flag]] for flag in _reasons()},
        "statusWords": dict(FIT_STATUS),
        "features": _features(results),
        "arrays": [[name, values.dtype.str[1:], int(values.size)] for name, values in arrays.items()],
    }
    packer = zlib.compressobj(6)
    parts = [packer.compress(np.ascontiguousarray(values).data) for values in arrays.values()]
    parts.append(packer.flush())
    return header, base64.b64encode(b"".join(parts)).decode("ascii")


def _representatives(results: Results, wall: Unrolled) -> np.ndarray:
    """Return the worst station of each group: by deflection, else by ovality, else the first."""
    severity = results.metric("deflection")
    if not np.isfinite(severity).any():
        severity = results.metric("ovality_polar")
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
    return {flag: REASON_COLOURS[name] for flag, name in REASONS.items() if flag}


def _features(results: Results) -> list[dict[str, Any]]:
    return [
        {"kind": row.kind, "chainage": float(row.chainage_m), "clock": float(row.clock_h) if row.clock_h > 0 else None}
        for row in features_table(results.survey).itertuples()
        if isfinite(row.chainage_m)
    ]
