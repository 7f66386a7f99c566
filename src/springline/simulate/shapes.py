"""Sewer shapes as chains of arcs and straight lines, mirrored about the vertical through O.

Each shape lists its right half from the invert up to the crown as (curve, point where it starts); the left half is its
mirror image. Frame: z right, y up, O on the springline line (box: in its middle).
"""

from __future__ import annotations

from math import atan2, hypot, pi

import numpy as np
from scipy.optimize import brentq

from ..errors import ParameterError
from .sections import Section

Point = tuple[float, float]
Curve = tuple[float, ...]


def arc(centre: Point, radius: float) -> Curve:
    """Return the curve (A, B, C, D, E, F) of a circle about `centre` (z, y)."""
    z, y = centre
    w = radius**-2
    return (w, 0.0, w, -2.0 * w * z, -2.0 * w * y, w * (z * z + y * y) - 1.0)


def line(a: Point, b: Point) -> Curve:
    """Return the curve of the straight line through a and b, which must not pass through O."""
    across = a[0] * b[1] - a[1] * b[0]
    return (0.0, 0.0, 0.0, (b[1] - a[1]) / across, (a[0] - b[0]) / across, -1.0)


def symmetric(right: list[tuple[Curve, Point]]) -> Section:
    """Return the section whose right half, from invert to crown, is given, and whose left half mirrors it."""
    starts = [atan2(y, z) for _, (z, y) in right]
    ends = [*starts[1:], 0.5 * pi]
    rows = [(start % (2.0 * pi), *curve) for start, (curve, _) in zip(starts, right, strict=True)]
    for end, ((a, b, c, d, e, f), _) in zip(ends, right, strict=True):
        rows.append(((pi - end) % (2.0 * pi), a, -b, c, -d, e, f))
    rows.sort()
    if rows[0][0] > 0.0:
        rows.insert(0, (0.0, *rows[-1][1:]))
    return Section(np.array(rows))


def upside_down(section: Section) -> Section:
    """Return the section turned over: y becomes -y."""
    starts = section.pieces[:, 0]
    ends = np.append(starts[1:], 2.0 * pi)
    rows = section.pieces * np.array([1, 1, -1, 1, 1, -1, 1])
    rows[:, 0] = 2.0 * pi - ends
    return Section(rows[::-1].copy())


def egg(width: float, height: float, invert_radius: float) -> Section:
    """Return an egg: semicircular crown, side arcs tangent to it at the springline and to the small invert arc.

    The side radius closes the gap at the invert. Standard 2:3 egg: invert radius width/4; new egg: width/8.

    >>> round(float(egg(2.0, 3.0, 0.5).radius(-np.pi / 2)), 12)
    2.0
    """
    r, depth = 0.5 * width, height - 0.5 * width
    low = depth - invert_radius
    if not 0.0 < invert_radius < r or not r < depth:
        raise ParameterError(
            f"an egg {width} m wide, {height} m high with an invert radius of {invert_radius} m",
            expected="height above its width and invert radius below half its width",
        )
    # The side arc touches the invert arc from outside: centres lie as far apart as the radii differ.
    side = brentq(lambda big: hypot(big - r, low) - (big - invert_radius), r, 1e3 * height, xtol=1e-15)
    turn = atan2(-low, side - r)
    touch = (r - side + side * np.cos(turn), side * np.sin(turn))
    return symmetric(
        [
            (arc((0.0, -low), invert_radius), (0.0, -depth)),
            (arc((r - side, 0.0), side), touch),
            (arc((0.0, 0.0), r), (r, 0.0)),
        ]
    )


def horseshoe(width: float) -> Section:
    """Return the standard horseshoe: crown radius half the width, sides about the far springline point and invert
    about the crown, both with the width as radius."""
    r = 0.5 * width
    corner = _meet((-r, 0.0), width, (0.0, r), width)
    return symmetric(
        [
            (arc((0.0, r), width), (0.0, r - width)),
            (arc((-r, 0.0), width), corner),
            (arc((0.0, 0.0), r), (r, 0.0)),
        ]
    )


def loaf(width: float, wall: float, fillet: float = 0.0) -> Section:
    """Return a loaf: semicircular crown, straight walls of height `wall`, corners of radius `fillet`, flat floor."""
    r = 0.5 * width
    _within("a loaf's fillet", fillet, r)
    return symmetric([*_foot(r, -wall - fillet, -wall, fillet, 0.0), (arc((0.0, 0.0), r), (r, 0.0))])


def arch(width: float, rise: float, wall: float) -> Section:
    """Return an arch: a circular crown of `rise` over straight walls and a flat floor, O at mid-height."""
    half, floor = 0.5 * width, -0.5 * (rise + wall)
    _within("an arch's rise", rise, half)
    radius = (half * half + rise * rise) / (2.0 * rise)
    springing = floor + wall
    crown = arc((0.0, springing + rise - radius), radius)
    return symmetric([*_foot(half, floor, floor, 0.0, springing), (crown, (half, springing))])


def box(width: float, height: float, fillet: float = 0.0) -> Section:
    """Return a rectangle with corners of radius `fillet`, O in its middle."""
    half, top = 0.5 * width, 0.5 * height
    _within("a box's fillet", fillet, 0.999 * min(half, top))
    right = _foot(half, -top, fillet - top, fillet, top - fillet)
    if fillet > 0.0:
        right.append((arc((half - fillet, top - fillet), fillet), (half, top - fillet)))
    return symmetric([*right, (line((half - fillet, top), (0.0, top)), (half - fillet, top))])


def _within(what: str, value: float, most: float) -> None:
    if value > most:
        raise ParameterError(f"{what} of {value:g} m", expected=f"at most {most:g} m")


def _foot(half: float, floor: float, wall: float, fillet: float, end: float) -> list[tuple[Curve, Point]]:
    """Return the right half of a flat floor, its corner and the wall from height `wall` to `end`."""
    inner = half - fillet
    out = [(line((0.0, floor), (inner, floor)), (0.0, floor))]
    if fillet > 0.0:
        out.append((arc((inner, wall), fillet), (inner, floor)))
    if end > wall:
        out.append((line((half, wall), (half, end)), (half, wall)))
    return out


def _meet(a: Point, ra: float, b: Point, rb: float) -> Point:
    """Return the lower right of the two points in which two circles meet."""
    dz, dy = b[0] - a[0], b[1] - a[1]
    d = hypot(dz, dy)
    x = (d * d + ra * ra - rb * rb) / (2.0 * d)
    h = (ra * ra - x * x) ** 0.5
    ends = [(a[0] + (x * dz - s * h * dy) / d, a[1] + (x * dy + s * h * dz) / d) for s in (1.0, -1.0)]
    return max(ends, key=lambda p: p[0] - p[1])
