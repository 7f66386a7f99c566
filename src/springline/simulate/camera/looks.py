"""What walls look like: the colours and grains of clay, concrete and PVC, dirt, cracks and stains."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from .. import pipes
from ..strewn import cracks, stains
from ..wall import CRACK, STAIN

LOOK = np.dtype(
    [("colour", "f8", 3), ("other", "f8", 3), ("dirt", "f8", 3), ("inner", "f8", 3)]
    + [(name, "f8") for name in ("mottle", "mottle_size", "grain", "grain_size", "streak", "pores", "bump", "gloss")]
    + [("shine", "f8"), ("tint", "f8"), ("dirt_from", "f8"), ("dirt_most", "f8"), ("radius", "f8"), ("seed", "u8")]
)
"""A wall's looks: colours (wall, its second, dirt, laterals' inside), strengths and sizes [m] of its grains, how it
shines, how pipes differ, above which value of its field dirt lies, the pipe's radius [m]."""

DECAL = np.dtype(
    [("form", "i8"), ("seed", "u8")]
    + [(name, "f8") for name in ("chainage", "bearing", "half_length", "half_width", "turn", "darkness")]
)
"""A crack or a stain: middle, half extents [m], a crack's turn from along the pipe [rad], share of light it takes."""

_LOOKS = {
    "clay": {
        "colour": (0.52, 0.25, 0.115), "other": (0.40, 0.21, 0.12), "mottle": 0.09, "mottle_size": 0.15,
        "grain": 0.045, "grain_size": 0.004, "streak": 0.03, "pores": 0.12, "bump": 0.05, "gloss": 0.10, "shine": 30.0,
        "tint": 0.08,
    },
    "concrete": {
        "colour": (0.40, 0.385, 0.35), "other": (0.30, 0.285, 0.25), "mottle": 0.13, "mottle_size": 0.20,
        "grain": 0.075, "grain_size": 0.005, "streak": 0.03, "pores": 0.4, "bump": 0.10, "gloss": 0.02, "shine": 12.0,
        "tint": 0.08,
    },
    "pvc": {
        "colour": (0.55, 0.40, 0.26), "other": (0.50, 0.37, 0.25), "mottle": 0.05, "mottle_size": 0.25,
        "grain": 0.025, "grain_size": 0.004, "streak": 0.03, "pores": 0.03, "bump": 0.02, "gloss": 0.22, "shine": 60.0,
        "tint": 0.03,
    },
}  # fmt: skip


def look_of(pipe: pipes.Pipe) -> str:
    """Return by which look a pipe is drawn: the one it states, or the one its material names, or concrete."""
    if pipe.surface.look is not None:
        return pipe.surface.look
    said = pipe.material.lower()
    plastic = ("pvc", "plastic", "polyethylene", "polypropylene", "pe-", "pp", "grp")
    return "clay" if "clay" in said else "pvc" if any(word in said for word in plastic) else "concrete"


def look_record(pipe: pipes.Pipe) -> np.ndarray:
    """Return the look (1,) of a pipe, as the shading kernel reads it."""
    surface = pipe.surface
    out = np.zeros(1, LOOK)
    for name, value in _LOOKS[look_of(pipe)].items():
        out[name] = value
    out["dirt"], out["inner"] = (0.085, 0.06, 0.04), 0.45 * out["other"]
    share = min(max(surface.dirt, 1e-6), 1.0 - 1e-6)
    out["dirt_from"], out["dirt_most"] = NormalDist().inv_cdf(1.0 - share), 0.9 if surface.dirt > 0.0 else 0.0
    out["radius"], out["seed"] = 0.5 * pipe.diameter, 40503 * (pipe.seed + 1)
    return out


def decal_records(pipe: pipes.Pipe, bearing) -> np.ndarray:
    """Return the pipe's cracks and stains, in order of chainage; `bearing` gives a clock's bearing."""
    radius = 0.5 * pipe.diameter
    rows = []
    for k, one in enumerate(cracks(pipe)):
        turn = np.radians(one.direction_deg)
        rows.append((CRACK, 7 + k, one.chainage, bearing(one.clock_h), 0.5 * one.length, 0.5 * one.width, turn, 0.85))
    for k, one in enumerate(stains(pipe)):
        wide = 0.5 * radius * np.radians(one.width_deg)
        rows.append((STAIN, 900 + k, one.chainage, bearing(one.clock_h), 0.5 * one.length, wide, 0.0, one.darkness))
    return np.sort(np.array(rows, DECAL), order="chainage")
