"""Which section stands where along the pipe."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from . import pipes
from .profiles import evaluate, is_constant
from .sections import Section, ellipse, mode, top_severity
from .shapes import arch, box, egg, horseshoe, loaf, upside_down

SHAPES = ("circle", "ellipse", "mode 1", "mode 2", "mode 3", "mode 4", "mode 5", "egg", "horseshoe")
SHAPES += ("inverted_horseshoe", "loaf", "arch", "box")
"""Names of section shapes, by the code that `/truth` holds for each station."""

NEEDS = {
    "circle": (),
    "ellipse": ("semi_major", "semi_minor"),
    "mode": ("mode", "s1"),
    "egg": ("width", "height", "invert_radius"),
    "horseshoe": ("width",),
    "inverted_horseshoe": ("width",),
    "loaf": ("width", "wall"),
    "arch": ("width", "rise", "wall"),
    "box": ("width", "height"),
}
"""Keys that each shape needs."""

_FIXED: dict[str, Callable[[pipes.Stretch], Section]] = {
    "egg": lambda one: egg(one.width, one.height, one.invert_radius),
    "horseshoe": lambda one: horseshoe(one.width),
    "inverted_horseshoe": lambda one: upside_down(horseshoe(one.width)),
    "loaf": lambda one: loaf(one.width, one.wall, one.fillet),
    "arch": lambda one: arch(one.width, one.rise, one.wall),
    "box": lambda one: box(one.width, one.height, one.fillet),
}
_VARYING = ("diameter", "semi_major", "semi_minor", "axis_deg", "s1", "s02", "s01")


def stretches(pipe: pipes.Pipe, length: float) -> list[pipes.Stretch]:
    """Return stretches that cover the pipe from 0 to `length` without a hole: a circle where nothing is said."""
    out, here = [], 0.0
    for one in sorted(pipe.section, key=lambda stretch: stretch.start or 0.0):
        start, end = one.start or 0.0, length if one.end is None else one.end
        if start > here:
            out.append(pipes.Stretch(start=here, end=start, shape="circle"))
        out.append(one.model_copy(update={"start": start, "end": end}))
        here = end
    if here < length:
        out.append(pipes.Stretch(start=here, end=length, shape="circle"))
    return out


def is_uniform(one: pipes.Stretch) -> bool:
    """Return whether the section stays the same along the stretch."""
    return all(is_constant(value) for name in _VARYING if (value := getattr(one, name)) is not None)


def sections_at(pipe: pipes.Pipe, one: pipes.Stretch, chainage: np.ndarray) -> Section:
    """Return the sections (k, n, 7) of a stretch at chainages (k,)."""
    s = np.asarray(chainage, float)
    if one.shape in _FIXED:
        section = _FIXED[one.shape](one)
        section = Section(np.repeat(section.pieces[None], s.size, axis=0))
    elif one.shape == "ellipse":
        turn = np.radians(evaluate(one.axis_deg, s))
        section = ellipse(evaluate(one.semi_major, s), evaluate(one.semi_minor, s), turn)
    else:
        r = 0.5 * evaluate(pipe.diameter if one.diameter is None else one.diameter, s)
        if one.shape == "circle":
            section = ellipse(r, r)
        else:
            section = mode(one.mode, r, *_severities(one, s), rule=pipe.perimeter)
    if one.inverted:
        section = Section(np.stack([upside_down(Section(pieces)).pieces for pieces in section.pieces]))
    return section


def parameters_at(pipe: pipes.Pipe, one: pipes.Stretch, chainage: np.ndarray) -> dict[str, np.ndarray]:
    """Return what `/truth` says of the section at chainages (k,): shape code, and severities of modes (else NaN)."""
    s = np.asarray(chainage, float)
    name = f"mode {one.mode}" if one.shape == "mode" else one.shape
    out = {"shape": np.full(s.size, SHAPES.index(name), np.uint8)}
    s1 = s2 = s01 = s02 = np.full(s.size, np.nan)
    if one.shape == "mode":
        s1, s02, s01 = _severities(one, s)
        s2 = top_severity(one.mode, s1, s02, s01, rule=pipe.perimeter)
        s02 = s02 if one.mode >= 4 else np.full(s.size, np.nan)
        s01 = s01 if one.mode == 5 else np.full(s.size, np.nan)
    return out | {"s1": s1, "s2": s2, "s01": s01, "s02": s02, "inverted": np.full(s.size, one.inverted, np.uint8)}


def _severities(one: pipes.Stretch, s: np.ndarray) -> tuple[np.ndarray, ...]:
    return tuple(evaluate(1.0 if value is None else value, s) for value in (one.s1, one.s02, one.s01))
