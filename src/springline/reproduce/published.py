"""The single-ended method of chapter 5 as published, flaws included: what Figures 5.5 to 5.8 and the noise study need.

Angles in degrees and lengths in any unit, as in Appendix C; pitch first. `springline.geometry.robot` is right.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from springline.geometry.robot import oblique_ellipse

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


class Ring(NamedTuple):
    """The ellipse that a ring measures: semi-axes, and the bearing of the major one [degrees]."""

    major: Array
    minor: Array
    beta: Array


def ring(pitch: ArrayLike, yaw: ArrayLike, r1: ArrayLike, r2: ArrayLike) -> Ring:
    """Return an exact ring with an unsigned beta, as Appendix C makes it.

    Source: Appendix C, `abs(acosd(abs(.)))`; erratum 2.

    >>> [round(float(v), 4) for v in ring(15.0, -7.5, 11.0, 10.0)]
    [11.1352, 10.3094, 13.0421]
    """
    found = oblique_ellipse(r1, r2, *np.radians([pitch, yaw]))
    return Ring(found.major, found.minor, np.abs(np.degrees(found.beta)))


def coefficients(pitch: ArrayLike, yaw: ArrayLike, beta: ArrayLike, *, minor: bool) -> tuple[Array, ...]:
    """Return A, B, C and D of f(w) = A sqrt(C - w^2) + B w - D, whose root is the axis' component on z.

    Source: (5.21) to (5.24).
    """
    a, b, c = _axis(pitch, yaw)
    square = a * a + b * b
    turn = np.radians(beta)
    of_beta = -np.sin(turn) if minor else np.cos(turn)
    return b * c * (1.0 - a), a * c * c + b * b, square, square * (b * b + c * c) * of_beta


def axis_component(pitch: ArrayLike, yaw: ArrayLike, beta: ArrayLike, *, minor: bool, sign: float = -1.0) -> Array:
    """Return w of the major or minor axis by the quadratic's root, the one with the minus sign unless told.

    Source: 5.3, `(-F - sqrt(abs(F^2 - E G)))/E`; erratum 3: the sign that is right depends on the pose, and abs()
    hides where there is no root.
    """
    a, b, c, d = coefficients(pitch, yaw, beta, minor=minor)
    e = a * a + b * b
    return (b * d + sign * np.sqrt(np.abs(b * b * d * d - e * (d * d - a * a * c)))) / e


def squares(pitch: ArrayLike, yaw: ArrayLike, beta: ArrayLike, *, minor: bool) -> tuple[Array, Array]:
    """Return v^2 and w^2 of the major or minor axis, a row of (5.28). Source: (5.18), Appendix C."""
    a, b, c = _axis(pitch, yaw)
    square = a * a + b * b
    w = axis_component(pitch, yaw, beta, minor=minor)
    v = (-w * b * c + a * np.sqrt(np.maximum(square - w * w, 0.0))) / square
    return v * v, w * w


def section(measured: Ring, pitch: ArrayLike, yaw: ArrayLike) -> tuple[Array, Array]:
    """Return r1 and r2 from one ring and a known attitude; NaN where the 2 by 2 system gives no real axes.

    Source: (5.28).

    >>> [round(float(r), 6) for r in section(ring(15.0, 7.5, 11.0, 10.0), 15.0, 7.5)]
    [11.0, 10.0]
    """
    rows = [squares(pitch, yaw, measured.beta, minor=minor) for minor in (False, True)]
    right = [measured.major**-2.0, measured.minor**-2.0]
    determinant = rows[0][0] * rows[1][1] - rows[1][0] * rows[0][1]
    of_r2 = (right[0] * rows[1][1] - right[1] * rows[0][1]) / determinant
    of_r1 = (rows[0][0] * right[1] - rows[1][0] * right[0]) / determinant
    return tuple(np.where(x > 0.0, np.abs(x), np.nan) ** -0.5 for x in (of_r1, of_r2))


def system(
    rings: Sequence[Ring], steps: Sequence[Sequence[float]], *, unknown_roll: bool = False
) -> Callable[[Array], Array]:
    """Return the equations to be solved, as a function of (pitch, yaw[, roll], r1, r2).

    Args:
        rings: The measured rings.
        steps: Increments of (pitch, yaw, roll) from the first ring to each.
        unknown_roll: Solve for roll too; the last equation is then left out, five of six.

    Source: (5.31) and the system after it, in Appendix C's form 1/(v^2/r2^2 + w^2/r1^2) - radius^2. Appendix C orders
    the unknowns yaw first, which changes nothing.
    """

    def equations(x: Array) -> Array:
        pitch, yaw, roll = x[0], x[1], x[2] if unknown_roll else 0.0
        left = []
        for measured, step in zip(rings, steps, strict=True):
            for minor, radius in ((False, measured.major), (True, measured.minor)):
                beta = measured.beta - (roll + step[2])
                v, w = squares(pitch + step[0], yaw + step[1], beta, minor=minor)
                left.append(1.0 / (v / x[-1] ** 2 + w / x[-2] ** 2) - radius**2)
        return np.array(left[:-1] if unknown_roll else left, float)

    return equations


def _axis(pitch: ArrayLike, yaw: ArrayLike) -> tuple[Array, Array, Array]:
    """Return (a, b, c) of (5.1) to (5.3) for any angles: the solver may wander beyond those a robot can have."""
    b, c = np.tan(np.radians(pitch)), np.tan(np.radians(yaw))
    a = (1.0 + b * b + c * c) ** -0.5
    return a, a * b, a * c
