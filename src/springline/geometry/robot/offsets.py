"""How far the scanner's origin leaves the pipe's axis: wheels on a deformed pipe, and pitch about a wheel.

Lengths in metres (any one unit works), angles in radians, heights positive up.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.geometry.checks import acute, finite, positive, require

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

_SEVERITY_MAX = (3.0 + 2.0 * np.sqrt(6.0)) / 5.0
"""Where the radicand of (4.3) ends: 3 + 6 s - 5 s^2 = 0."""


def deformed_r1(s: ArrayLike, *, r: ArrayLike = 1.0) -> Array:
    """Return the horizontal semi-axis of a pipe pressed to the vertical semi-axis s r at constant perimeter.

    Args:
        s: Vertical semi-axis over the radius of the undeformed pipe, from 0 to 1.5798.
        r: Radius of the undeformed pipe [m].

    Returns:
        Horizontal semi-axis [m], with Ramanujan's first perimeter kept at 2 pi r.

    Raises:
        ParameterError: `s` or `r` is out of range.

    Source: (4.3).

    >>> round(float(deformed_r1(0.9, r=10.0)), 6)
    10.952218
    """
    s, r = finite("s", s), positive("r", r)
    require(
        np.isnan(s) | ((s >= 0) & (s <= _SEVERITY_MAX)),
        "s",
        s,
        f"0 <= s <= {_SEVERITY_MAX:.6g}",
        "s is the vertical semi-axis over the undeformed radius",
    )
    return (3.0 - 2.0 * s + np.sqrt(np.maximum(3.0 + 6.0 * s - 5.0 * s * s, 0.0))) * r / 3.0


def ride_height(r: ArrayLike, *, wheel_radius: ArrayLike, half_span: ArrayLike = 0.0) -> Array:
    """Return the height of a centred scanner above the wheel axles.

    Args:
        r: Radius of the undeformed pipe in which the scanner sits on the axis [m].
        wheel_radius: Radius of the wheels [m].
        half_span: Half the distance between left and right wheel [m].

    Returns:
        sqrt(r^2 - half_span^2) - wheel_radius [m].

    Raises:
        ParameterError: The wheels do not fit the pipe.

    Source: 4.1.2 with the half-span of 4.1.1 (erratum 26: H = r - R_w holds for half_span = 0 only).

    >>> round(float(ride_height(0.15, wheel_radius=0.03, half_span=0.09)), 6)
    0.09
    """
    r, wheel_radius = positive("r", r), positive("wheel_radius", wheel_radius)
    half_span = _half_span(half_span, r)
    height = np.sqrt(r * r - half_span**2) - wheel_radius
    require(~(height <= 0), "wheel_radius", wheel_radius, "wheels below the pipe's axis", "give smaller wheels")
    return height


def offset_deformation(s: ArrayLike, *, half_span: ArrayLike, r: ArrayLike = 1.0) -> Array:
    """Return how far a scanner that is centred in the round pipe sits above the centre of the deformed one.

    Args:
        s: Vertical semi-axis over `r`.
        half_span: Half the distance between left and right wheel [m], at most r.
        r: Radius of the undeformed pipe [m].

    Returns:
        Rise [m]; negative where wide wheels sink as the floor flattens. A value beyond +-s r means that the robot
        does not fit; it is returned as it is, for the caller to discard.

    Raises:
        ParameterError: `s`, `r` or `half_span` is out of range.

    Source: (4.2); W is the half-span (erratum 25).

    >>> round(float(offset_deformation(0.9, half_span=3.0, r=10.0)), 6)
    0.883612
    """
    r = positive("r", r)
    half_span = _half_span(half_span, r)
    r1 = deformed_r1(s, r=r)
    spread = r1 * r1 - half_span**2
    require(
        ~(spread < 0),
        "half_span",
        half_span,
        "half_span <= the deformed pipe's horizontal semi-axis",
        "give narrower wheels",
    )
    # r1 reaches 0 only together with half_span: there the wheels stand in the bottom of a closed slit.
    with np.errstate(invalid="ignore", divide="ignore"):
        drop = np.where(r1 > 0, np.sqrt(spread) / r1, 1.0)
    return np.sqrt(r * r - half_span**2) - np.asarray(s, float) * r * drop


def offset_pitch(pitch: ArrayLike, *, length: ArrayLike, height: ArrayLike) -> Array:
    """Return how far pitching about a wheel lifts the scanner's origin.

    Args:
        pitch: Nose up [rad].
        length: Along the robot from the axle it turns about to the scanner [m]; negative when nosing down about the
            rear axle puts the scanner behind the pivot, or about a front axle ahead of it (erratum 26).
        height: Of the scanner above the axles [m], see `ride_height`.

    Returns:
        length sin(pitch) - height (1 - cos(pitch)) [m].

    Raises:
        ParameterError: A length is infinite or the pitch is not inside +-pi/2.

    Source: 4.1.2; exact, since the wheel's centre keeps its height while the body turns about it.

    >>> round(float(offset_pitch(np.radians(30), length=10.0, height=7.5)), 6)
    3.995191
    """
    pitch, length, height = acute("pitch", pitch), finite("length", length), finite("height", height)
    return length * np.sin(pitch) - 2.0 * height * np.sin(pitch / 2.0) ** 2


def _half_span(half_span: Array, r: Array) -> Array:
    half_span = finite("half_span", half_span)
    require(
        np.isnan(half_span + r) | ((half_span >= 0) & (half_span <= r)),
        "half_span",
        half_span,
        "0 <= half_span <= r",
        "it is HALF the distance between the wheels",
    )
    return half_span
