"""Sewer shapes, each a short table of arcs and lines: circle, ellipse, egg, horseshoe, loaf, arch, box.

Every shape is symmetric about the y axis. O is the springline's midpoint where the shape has a springline (circle, egg,
horseshoe, loaf), else the axis at mid-height (arch, box). All numbers broadcast to a batch, in one unit of length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import between, positive

from .arcs import ArcSection, Pieces
from .profiles import Arc, Corner, Line, symmetric

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

QUARTER = np.pi / 2


def circle(radius: ArrayLike) -> ArcSection:
    """Return circles about O.

    >>> round(float(circle(0.5).perimeter), 12) == round(np.pi, 12)
    True
    """
    radius = positive("radius", radius)
    return symmetric([Arc(radius, QUARTER), Arc(radius, QUARTER)], radius)


def ellipse(semi_a: ArrayLike, semi_b: ArrayLike, tilt: ArrayLike = 0.0) -> ArcSection:
    """Return ellipses about O.

    Args:
        semi_a: Semi-axis at the bearing `tilt`.
        semi_b: The other semi-axis.
        tilt: Bearing of `semi_a` [rad].

    Source: (3.1).

    >>> ellipse(1.2, 1.0, np.pi / 2).polar_radius([0.0, np.pi / 2]).round(12).tolist()
    [1.0, 1.2]
    """
    a, b = positive("semi_a", semi_a), positive("semi_b", semi_b)
    shape = (*np.broadcast_shapes(a.shape, b.shape, np.shape(tilt)), 4)
    a, b, tilt = (np.broadcast_to(np.asarray(x, float)[..., None], shape) for x in (a, b, tilt))
    t0 = np.broadcast_to(np.arange(4) * QUARTER, shape)
    centre = np.zeros(shape, complex)
    node = np.exp(1j * tilt) * (a * np.cos(t0) + 1j * b * np.sin(t0))
    return ArcSection(Pieces(np.zeros(4, bool), node, centre, a, b, tilt, t0, t0 + QUARTER))


def egg(width: ArrayLike, height: ArrayLike, invert_radius: ArrayLike) -> ArcSection:
    """Return eggs: a semicircular crown, tangent side arcs, an invert arc; O at the springline's midpoint.

    The standard egg has height 1.5 width and invert radius width/4; the new egg has width/8.

    Args:
        width: Width at the springline.
        height: From invert to crown, at least the width.
        invert_radius: Radius of the invert arc, below half the width.

    Raises:
        ParameterError: A number outside its range.

    Source: errata E.

    >>> round(float(egg(2.0, 3.0, 0.5).area), 4), round(float(egg(2.0, 3.0, 0.25).area), 4)
    (4.5941, 4.4602)
    """
    side = egg_side_radius(width, height, invert_radius)
    r, rho = 0.5 * np.asarray(width, float), np.asarray(invert_radius, float)
    swing = np.arctan2(height - r - rho, side - r)
    return symmetric([Arc(r, QUARTER), Arc(side, swing), Arc(rho, QUARTER - swing)], r)


def egg_side_radius(width: ArrayLike, height: ArrayLike, invert_radius: ArrayLike) -> Array:
    """Return the radius of an egg's side arcs, from tangency to the crown and to the invert arc.

    Args:
        width, height, invert_radius: As for `egg`.

    Source: errata E.

    >>> float(egg_side_radius(2.0, 3.0, 0.5))
    3.0
    """
    width = positive("width", width)
    height = between("height", height, width, np.inf, bounds="[)", given={"width": width})
    rho = between("invert_radius", invert_radius, 0.0, 0.5 * width, bounds="()", given={"width": width})
    r = 0.5 * width
    below = height - r
    return (r * r + (below - rho) ** 2 - rho * rho) / (2.0 * (r - rho))


def horseshoe(diameter: ArrayLike) -> ArcSection:
    """Return standard horseshoes: a crown semicircle of the diameter, sides and invert of twice its radius.

    The sides are struck about the far end of the springline, the invert about the crown; they meet in corners. O is the
    springline's midpoint. Turned over (`flipped`) it is the inverted horseshoe.

    Source: errata E.

    >>> round(float(horseshoe(1.0).area), 5), round(float(horseshoe(1.0).perimeter), 5)
    (0.82932, 3.26692)
    """
    diameter = positive("diameter", diameter)
    swing = np.arcsin((np.sqrt(7.0) - 1.0) / 4.0)
    r = 0.5 * diameter
    return symmetric([Arc(r, QUARTER), Arc(diameter, swing), Corner(QUARTER - 2 * swing), Arc(diameter, swing)], r)


def inverted_horseshoe(diameter: ArrayLike) -> ArcSection:
    """Return standard horseshoes upside down.

    >>> bool(inverted_horseshoe(1.0).polar_radius(-np.pi / 2) == 0.5)
    True
    """
    return horseshoe(diameter).flipped()


def loaf(width: ArrayLike, wall: ArrayLike, fillet: ArrayLike) -> ArcSection:
    """Return loaves: a semicircular crown, straight walls, filleted corners, a flat floor.

    There is no standard: state the three numbers with every result. O is the springline's midpoint.

    Args:
        width: Inside width.
        wall: Height of the straight walls, from the springline down to the fillets.
        fillet: Radius of the fillets, from 0 (corners) to half the width.

    Source: errata E.

    >>> round(float(loaf(2.0, 1.0, 0.25).area), 6)
    4.043971
    """
    width = positive("width", width)
    wall = between("wall", wall, 0.0, np.inf, bounds="[)")
    fillet = between("fillet", fillet, 0.0, 0.5 * width, given={"width": width})
    positive("wall + fillet", wall + fillet)
    r = 0.5 * width
    return symmetric([Arc(r, QUARTER), Line(wall), Arc(fillet, QUARTER), Line(r - fillet)], r)


def arch(width: ArrayLike, rise: ArrayLike, wall: ArrayLike) -> ArcSection:
    """Return arches: a circular crown over straight walls, a flat floor; O on the axis at mid-height.

    Args:
        width: Inside width.
        rise: Height of the crown above the springing, from above 0 to half the width.
        wall: Height of the straight walls, from 0.

    >>> round(float(arch(2.0, 1.0, 0.5).area), 6) == round(np.pi / 2 + 1.0, 6)
    True
    """
    width = positive("width", width)
    rise = between("rise", rise, 0.0, 0.5 * width, bounds="(]", given={"width": width})
    wall = between("wall", wall, 0.0, np.inf, bounds="[)")
    r = 0.5 * width
    half = 2.0 * np.arctan2(rise, r)
    radius = (r * r + rise * rise) / (2.0 * rise)
    walk = [Arc(radius, half), Corner(QUARTER - half), Line(wall), Corner(QUARTER), Line(r)]
    return symmetric(walk, 0.5 * (rise + wall))


def box(width: ArrayLike, height: ArrayLike, fillet: ArrayLike = 0.0) -> ArcSection:
    """Return boxes with filleted corners; O at the middle.

    Args:
        width, height: Inside dimensions.
        fillet: Radius of the fillets, from 0 (corners) to half the smaller dimension.

    >>> round(float(box(2.0, 1.0, 0.25).area), 6)
    1.94635
    """
    width, height = positive("width", width), positive("height", height)
    most = 0.5 * np.minimum(width, height)
    fillet = between("fillet", fillet, 0.0, most, given={"width": width, "height": height})
    across, up = 0.5 * width - fillet, height - 2.0 * fillet
    walk = [Line(across), Arc(fillet, QUARTER), Line(up), Arc(fillet, QUARTER), Line(across)]
    return symmetric(walk, 0.5 * height)


@dataclass(frozen=True)
class Shape:
    """A listed shape.

    Attributes:
        build: Makes it from its numbers.
        parameters: Their names, in order.
        example: Some of them.
        ranges: The limits of each number for the given ones.
    """

    build: Callable[..., ArcSection]
    parameters: tuple[str, ...]
    example: tuple[float, ...]
    ranges: Callable[..., tuple[tuple[ArrayLike, ArrayLike], ...]]

    def limits(self, parameters: Array) -> tuple[Array, Array]:
        """Return lower and upper limits (..., K) of the numbers, for the given ones (..., K)."""
        pairs = self.ranges(*np.moveaxis(parameters, -1, 0))
        low, high = (
            np.stack(np.broadcast_arrays(parameters[..., 0], *side)[1:], -1) for side in zip(*pairs, strict=True)
        )
        return low, high


_ANY = (0.0, np.inf)


def _egg_ranges(width: Array, height: Array, invert_radius: Array) -> tuple:
    return (2.0 * invert_radius, height), (width, np.inf), (0.0, 0.5 * width)


SHAPES = {
    "circle": Shape(circle, ("radius",), (0.5,), lambda radius: (_ANY,)),
    "ellipse": Shape(
        ellipse, ("semi_a", "semi_b", "tilt"), (0.6, 0.5, 0.3), lambda a, b, tilt: (_ANY, _ANY, (-np.inf, np.inf))
    ),
    "egg": Shape(egg, ("width", "height", "invert_radius"), (0.6, 0.9, 0.15), _egg_ranges),
    "new egg": Shape(egg, ("width", "height", "invert_radius"), (0.6, 0.9, 0.075), _egg_ranges),
    "horseshoe": Shape(horseshoe, ("diameter",), (1.2,), lambda diameter: (_ANY,)),
    "inverted horseshoe": Shape(inverted_horseshoe, ("diameter",), (1.2,), lambda diameter: (_ANY,)),
    "loaf": Shape(
        loaf,
        ("width", "wall", "fillet"),
        (1.2, 0.4, 0.15),
        lambda width, wall, fillet: ((2.0 * fillet, np.inf), _ANY, (0.0, 0.5 * width)),
    ),
    "arch": Shape(
        arch,
        ("width", "rise", "wall"),
        (1.6, 0.5, 0.7),
        lambda width, rise, wall: ((2.0 * rise, np.inf), (0.0, 0.5 * width), _ANY),
    ),
    "box": Shape(
        box,
        ("width", "height", "fillet"),
        (1.5, 1.0, 0.1),
        lambda w, h, fillet: ((2.0 * fillet, np.inf), (2.0 * fillet, np.inf), (0.0, 0.5 * np.minimum(w, h))),
    ),
}
"""The listed shapes by name; each is tested against polygons by being listed."""
