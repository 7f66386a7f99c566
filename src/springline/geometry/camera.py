"""A camera in the pipe: pose matrix, camera coordinates, projection through a lens, and rays back out (6.3, 6.4).

Pipe frame of `springline.conventions`. Camera axes as the text has them: n backwards, v up, u right, the rows of a
4 by 4 matrix V, so that points ahead of the camera have a negative first coordinate and det V = -1 (erratum 36).
Images have z to the right and y up, in the lens's unit from the principal point. Angles in radians.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.checks import finite

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from springline.geometry.lenses import Lens

    Array = NDArray[np.float64]

_PARALLEL = 1e-9


def spherical(points: ArrayLike) -> tuple[Array, Array, Array]:
    """Return distance, zenith and azimuth of points seen from the origin along +x.

    Args:
        points: (..., 3) x, y, z [m].

    Returns:
        Three arrays (...): distance [m]; zenith from +x [rad], in [0, pi]; azimuth from +z towards +y [rad], in
        (-pi, pi]. The angles of the origin itself are NaN; on the axis the azimuth is 0.

    Raises:
        ParameterError: `points` are not (..., 3), or infinite.

    Source: 2.7 with four-quadrant angles (erratum 27): what lies behind stays behind.

    >>> np.degrees(spherical([-1.0, 2.0, 3.0])[1:]).round(3)
    array([105.501,  33.69 ])
    """
    x, y, z = np.moveaxis(_triples("points", points), -1, 0)
    across = np.hypot(y, z)
    distance = np.hypot(across, x)
    nowhere = distance == 0
    # + 0.0 turns a negative zero, which would put the azimuth on the other side, into a positive one
    azimuth = np.where(across == 0, 0.0 * across, np.arctan2(y + 0.0, z + 0.0))
    return distance, np.where(nowhere, np.nan, np.arctan2(across, x)), np.where(nowhere, np.nan, azimuth)


def from_spherical(distance: ArrayLike, zenith: ArrayLike, azimuth: ArrayLike) -> Array:
    """Return the points (..., 3) at a distance [m], zenith and azimuth [rad]: the inverse of `spherical`.

    >>> from_spherical(2.0, np.pi / 2, np.pi / 2).round(12) + 0.0
    array([0., 2., 0.])
    """
    distance, zenith, azimuth = (
        finite(name, value) for name, value in (("distance", distance), ("zenith", zenith), ("azimuth", azimuth))
    )
    across = distance * np.sin(zenith)
    parts = (distance * np.cos(zenith), across * np.sin(azimuth), across * np.cos(azimuth))
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


def camera_matrix(eye: ArrayLike, look: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0)) -> Array:
    """Return the matrix V that takes pipe to camera coordinates.

    Args:
        eye: (..., 3) the camera [m].
        look: (..., 3) a point on its optical axis, ahead of it [m].
        up: (..., 3) roughly upwards; need be neither of unit length nor perpendicular to the axis.

    Returns:
        Array (..., 4, 4) with rows n (backwards), v (up), u (right), orthonormal, and the homogeneous row.

    Raises:
        ParameterError: `eye` and `look` coincide, or `up` lies along the axis.

    Source: 6.3, with u normalised (erratum 35).

    >>> camera_matrix([-30.0, 0.0, 0.0], [0.0, 0.0, 0.0])[:3].round(12) + 0.0
    array([[ -1.,   0.,   0., -30.],
           [  0.,   1.,   0.,   0.],
           [  0.,   0.,   1.,   0.]])
    """
    eye, look, up = _triples("eye", eye), _triples("look", look), _triples("up", up)
    back = eye - look
    far = np.linalg.norm(back, axis=-1, keepdims=True)
    if np.any(far == 0):
        raise ParameterError("eye and look coincide", mend="let look lie ahead of the camera on its optical axis")
    n = back / far
    right = np.cross(up, n)
    length = np.linalg.norm(right, axis=-1, keepdims=True)
    if np.any(length <= _PARALLEL * np.linalg.norm(up, axis=-1, keepdims=True)):
        raise ParameterError("up lies along the optical axis", mend="give another direction that points upwards")
    u = right / length
    return _matrix(np.stack(np.broadcast_arrays(n, np.cross(n, u), u), axis=-2), eye)


def camera_at(eye: ArrayLike, frame: ArrayLike) -> Array:
    """Return the matrix V of a camera that sits at `eye` and looks along the first axis of `frame`.

    Args:
        eye: (..., 3) the camera [m].
        frame: (..., 3, 3) rows forward, up and right, as `robot.frame(pitch, yaw, roll)` makes them.

    Returns:
        Array (..., 4, 4) as of `camera_matrix`.

    Raises:
        ParameterError: `frame` is not (..., 3, 3).

    Source: 6.3 for the robot attitude of chapter 5.

    >>> bool(np.allclose(camera_at([-3.0, 0.0, 0.0], np.eye(3)), camera_matrix([-3.0, 0.0, 0.0], [0.0, 0.0, 0.0])))
    True
    """
    frame = finite("frame", frame)
    if frame.shape[-2:] != (3, 3):
        raise ParameterError(f"frame has shape {frame.shape}", expected="(..., 3, 3), rows forward, up and right")
    return _matrix(frame * np.array([-1.0, 1.0, 1.0])[:, None], _triples("eye", eye))


def turn_camera(matrix: ArrayLike, pitch: ArrayLike = 0.0, yaw: ArrayLike = 0.0, roll: ArrayLike = 0.0) -> Array:
    """Return the matrix V of a camera turned about its own axes: yaw, then pitch, then roll.

    Args:
        matrix: (..., 4, 4) as of `camera_matrix`.
        pitch: Optical axis towards the camera's up [rad].
        yaw: Optical axis towards the camera's right [rad].
        roll: Right towards up [rad], counter-clockwise as the camera looks.

    Returns:
        Array (..., 4, 4); the camera stays where it is.

    Raises:
        ParameterError: `matrix` is not (..., 4, 4), or an angle is infinite.

    Source: the orientation errors of 6.6, for which the text states no order.

    >>> ahead = camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    >>> (-turn_camera(ahead, pitch=np.pi / 2)[0, :3]).round(12) + 0.0
    array([0., 1., 0.])
    """
    matrix = _matrices(matrix)
    n, v, u = (matrix[..., i, :3] for i in range(3))
    n, u = _turned(n, u, -finite("yaw", yaw))
    n, v = _turned(n, v, -finite("pitch", pitch))
    u, v = _turned(u, v, finite("roll", roll))
    return _matrix(np.stack(np.broadcast_arrays(n, v, u), axis=-2), camera_eye(matrix))


def camera_eye(matrix: ArrayLike) -> Array:
    """Return where the camera of `matrix` (..., 4, 4) sits, (..., 3) [m].

    >>> camera_eye(camera_matrix([-8.0, 1.0, -1.0], [0.0, 0.0, 0.0])).round(12)
    array([-8.,  1., -1.])
    """
    matrix = _matrices(matrix)
    return -np.einsum("...ij,...i->...j", matrix[..., :3, :3], matrix[..., :3, 3])


def to_camera(matrix: ArrayLike, points: ArrayLike) -> Array:
    """Return camera coordinates of pipe points.

    Args:
        matrix: (..., 4, 4) as of `camera_matrix`.
        points: (..., n, 3) x, y, z [m]; leading axes broadcast against those of `matrix`.

    Returns:
        Array (..., n, 3) of components along n, v and u [m]; negative first where ahead.

    Raises:
        ParameterError: A shape does not fit.

    Source: 6.3.

    >>> to_camera(camera_matrix([-5.0, 0.0, 0.0], [0.0, 0.0, 0.0]), [[0.0, 1.0, 2.0]]).round(12)
    array([[-5.,  1.,  2.]])
    """
    matrix = _matrices(matrix)
    rows = np.swapaxes(matrix[..., :3, :3], -1, -2)
    return (_triples("points", points) - camera_eye(matrix)[..., None, :]) @ rows


def project(matrix: ArrayLike, points: ArrayLike, lens: Lens) -> Array:
    """Return where pipe points appear in the image.

    Args:
        matrix: (..., 4, 4) as of `camera_matrix`.
        points: (..., n, 3) x, y, z [m].
        lens: The lens; its `view_angle` and its model's one-to-one range bound what is seen.

    Returns:
        Array (..., n, 2) of z (right) and y (up) [px]; NaN where the lens does not see the point, such as behind it.

    Raises:
        ParameterError: A shape does not fit.

    Source: 6.4; the zenith is that of -n, so nothing from behind folds into the image (errata 36, 37).

    >>> from springline.geometry.lenses import Lens
    >>> ahead = camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    >>> project(ahead, [[1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]], Lens("sine", 100.0)).round(3)
    array([[70.711,  0.   ],
           [   nan,    nan]])
    """
    back, up, right = np.moveaxis(to_camera(matrix, points), -1, 0)
    across = np.hypot(up, right)
    zenith = np.where((across == 0) & (back == 0), np.nan, np.arctan2(across, -back))
    scale = lens.radius(zenith) / np.where(across == 0, 1.0, across)
    return np.stack([scale * right, scale * up], axis=-1)


def rays(matrix: ArrayLike, image: ArrayLike, lens: Lens) -> Array:
    """Return the directions in the pipe that image points look along: the inverse of `project` up to distance.

    Args:
        matrix: (..., 4, 4) as of `camera_matrix`.
        image: (..., n, 2) z (right) and y (up) from the principal point [px].
        lens: The lens.

    Returns:
        Array (..., n, 3) of unit vectors from `camera_eye`; NaN where no ray lands.

    Raises:
        ParameterError: A shape does not fit.

    Source: inverse of 6.4.

    >>> from springline.geometry.lenses import Lens
    >>> ahead = camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    >>> rays(ahead, [[0.0, 50.0]], Lens("sine", 100.0)).round(6)
    array([[0.866025, 0.5     , 0.      ]])
    """
    matrix = _matrices(matrix)
    image = finite("image", image)
    if image.shape[-1:] != (2,):
        raise ParameterError(f"image has shape {image.shape}", expected="(..., n, 2), z and y")
    radius = np.hypot(image[..., 0], image[..., 1])
    zenith = lens.zenith(radius)
    scale = np.sin(zenith) / np.where(radius == 0, 1.0, radius)
    along = np.stack([-np.cos(zenith), scale * image[..., 1], scale * image[..., 0]], axis=-1)
    return along @ matrix[..., :3, :3]


def to_pixels(image: ArrayLike, centre: ArrayLike) -> Array:
    """Return (column, row) of image points; rows count downwards.

    Args:
        image: (..., 2) z (right) and y (up) from the principal point [px].
        centre: (2,) column and row of the principal point [px].

    Returns:
        Array (..., 2).

    >>> to_pixels([10.0, 20.0], [384.0, 384.0])
    array([394., 364.])
    """
    return finite("centre", centre) + finite("image", image) * np.array([1.0, -1.0])


def from_pixels(pixels: ArrayLike, centre: ArrayLike) -> Array:
    """Return z (right) and y (up) from the principal point of (column, row) pixels: the inverse of `to_pixels`.

    >>> from_pixels([394.0, 364.0], [384.0, 384.0])
    array([10., 20.])
    """
    return (finite("pixels", pixels) - finite("centre", centre)) * np.array([1.0, -1.0])


def _turned(first: Array, second: Array, angle: Array) -> tuple[Array, Array]:
    """Turn `first` towards `second` by `angle`."""
    cos, sin = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return cos * first + sin * second, cos * second - sin * first


def _matrix(rows: Array, eye: Array) -> Array:
    shape = np.broadcast_shapes(rows.shape[:-2], eye.shape[:-1])
    matrix = np.zeros((*shape, 4, 4))
    matrix[..., :3, :3] = rows
    matrix[..., :3, 3] = -np.einsum("...ij,...j->...i", rows, eye)
    matrix[..., 3, 3] = 1.0
    return matrix


def _matrices(matrix: ArrayLike) -> Array:
    matrix = finite("matrix", matrix)
    if matrix.shape[-2:] != (4, 4):
        raise ParameterError(f"matrix has shape {matrix.shape}", expected="(..., 4, 4), as of camera_matrix")
    return matrix


def _triples(name: str, value: ArrayLike) -> Array:
    array = finite(name, value)
    if array.shape[-1:] != (3,):
        raise ParameterError(f"{name} has shape {array.shape}", expected="(..., 3), x, y and z")
    return array
