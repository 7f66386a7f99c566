"""Rings from pictures of a laser ring: what ring profilers record.

A laser plane stands across the robot's axis at a known distance ahead of the camera and draws a ring on the wall. So
each point of the picture is a point of that plane, through the lens and the camera's tilt on the robot. The line is a
ridge of the plane laid out by bearing and radius; the ridge that goes once round and is brightest is followed by
dynamic programming, and placed to a fraction of a pixel by its centre of light. What is too faint to be told from the
picture's own noise, or lies off the ring's smooth course without being joined to it, is left missing: an arc that is
not seen is never filled.

Bearings are seen looking ahead, from the robot's +z (right) counter-clockwise to its +y (up); radii are about the
point where the robot's forward direction from the camera meets the laser plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import ParameterError
from springline.geometry.camera import camera_at, project, to_pixels
from springline.geometry.checks import choice
from springline.imaging._ridge import brightest_path, centre_of_light, smooth_course

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from springline.imaging.lens_table import MountedCamera

COLOURS = ("auto", "red", "green", "blue", "white")
"""Colour of the line; auto takes that in which the ring stands out most."""

_WEIGHTS = {  # of blue, green, red
    "red": (-0.5, -0.5, 1.0),
    "green": (-0.5, 1.0, -0.5),
    "blue": (1.0, -0.5, -0.5),
    "white": (1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0),
}
_WIDTHS = (0.8, 1.2, 1.7, 2.4, 3.4, 4.8, 6.8, 9.6)
"""Widths of the ridge that are tried [px], each 1.4 times the last; a line stands out most at 1.4 of its one-sigma."""
_OVERSAMPLING = 4
_LEAST_CONTRAST = 5.0
"""A ridge below so many robust sigmas of its own ray's response is not told from noise."""
_DIM = 0.5
"""Off course, a line under this share of the ring's own brightness is a reflection."""
_OFF_COURSE = 0.03
_JUMP = 0.02
"""Share of the radius by which the ring may move between neighbouring bearings and still be one line."""
_LEAST_ARC = 8
_END = 2
_STEEPEST = np.radians(85.0)
"""A point of the plane seen flatter than this is not laid out."""
_OUTSIDE = -1e4


@dataclass(frozen=True)
class RingReading:
    """What one picture shows of the ring.

    Attributes:
        range: (bearing,) radius in the laser plane [m]; NaN where the line was not seen.
        contrast: (bearing,) height of the ridge over the noise of its ray.
        reason: Why nothing was read; empty when something was.
    """

    range: NDArray[np.float64]
    contrast: NDArray[np.float64]
    reason: str = ""

    def __bool__(self) -> bool:
        return not self.reason


class RingReader:
    """Reads rings from pictures of one camera.

    The line's width and colour are taken from the first picture that shows a ring and kept for the others.

    Args:
        camera: The camera, with its laser plane.
        bearings: Readings per ring, at equal steps from +z.
        colour: One of `COLOURS`.

    Raises:
        ParameterError: A setting is out of range.
        MissingExtraError: OpenCV is not installed.

    Source: section 2.7 for the lens; the centre of light under a window that follows it, as is usual for laser lines.
    """

    def __init__(self, camera: MountedCamera, *, bearings: int = 360, colour: str = "auto") -> None:
        choice("colour", colour, COLOURS)
        if camera.laser_ahead is None:
            raise ParameterError("the camera has no laser ring", expected="laser_ahead, in metres")
        if bearings < _LEAST_ARC * 4:
            raise ParameterError(f"bearings = {bearings} is out of range", expected=f"{_LEAST_ARC * 4} or more")
        self.camera, self.bearings = camera, bearings
        self.reach = _reach(camera)
        self._colour = None if colour == "auto" else colour
        self._width: float | None = None
        self._map = self._laid_out()
        self._on_picture = self._pictured()

    def _laid_out(self) -> NDArray[np.float32]:
        """Return (fine bearing, step, 2) pixels; each bearing is the mean of the fine ones about it."""
        fine = self.bearings * _OVERSAMPLING
        theta = (np.arange(fine) - 0.5 * (_OVERSAMPLING - 1)) * 2.0 * np.pi / fine
        pixels = plane_pixels(self.camera, theta, np.arange(self.reach, dtype=float))
        return np.where(np.isfinite(pixels), pixels, _OUTSIDE).astype(np.float32)

    def read(self, picture: NDArray[np.uint8]) -> RingReading:
        """Return the ring in a picture.

        Args:
            picture: (rows, columns, 3) blue, green, red, or (rows, columns) grey, of the camera's size.

        Returns:
            RingReading; falsy with its reason when no ring was found.

        Raises:
            InputError: The picture is not of the camera's size.
        """
        rays = self._rays(picture)
        width = self._width
        if self._colour is None or width is None:
            self._colour, width = self._settle(rays)
        light = _weighed(rays, self._colour)
        response = _response(light, width)
        noise = _noise(response)
        path = brightest_path(_capped(response), float(max(2.0, _JUMP * self.reach)))
        every = np.arange(self.bearings)
        contrast = response[every, path] / noise
        seen = contrast >= _LEAST_CONTRAST
        if seen.sum() < _LEAST_ARC:
            return self._nothing(contrast, "no ring stands out of the picture")
        self._width = width
        seen &= self._on_picture[every, path]
        place = np.where(seen, centre_of_light(light, path.astype(float), width), np.nan)
        strength = response[every, path]
        kept = _kept(place, strength)
        if kept.sum() < _LEAST_ARC:
            return self._nothing(contrast, "what stands out of the picture is no ring")
        return RingReading(radius_on_plane(self.camera, np.where(kept, place, np.nan)), contrast)

    def _nothing(self, contrast: NDArray[np.float64], reason: str) -> RingReading:
        return RingReading(np.full(self.bearings, np.nan), contrast, reason)

    def _rays(self, picture: NDArray[np.uint8]) -> NDArray[np.float32]:
        """Return the picture laid out by bearing and radius: (bearing, radius, 1 or 3)."""
        from springline.imaging.opencv import opencv

        self.camera.check_size(picture)
        cv2 = opencv()
        rays = cv2.remap(picture, self._map, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
        rays = cv2.resize(rays, (rays.shape[1], self.bearings), interpolation=cv2.INTER_AREA)
        return rays.reshape(self.bearings, self.reach, -1).astype(np.float32)

    def _settle(self, rays: NDArray[np.float32]) -> tuple[str, float]:
        """Return the colour and the one-sigma [px] at which the ring stands out most."""
        colours = [self._colour] if self._colour else (["white"] if rays.shape[2] == 1 else list(_WEIGHTS))
        found = []
        for colour in colours:
            light = _weighed(rays, colour)
            for width in _WIDTHS:
                response = _response(light, width)
                top = float(np.median((response / _noise(response)[:, None]).max(axis=1)))
                found.append((float(np.median(response.max(axis=1))) if top >= _LEAST_CONTRAST else 0.0, colour, width))
        _, colour, width = max(found)
        return colour, width

    def _pictured(self) -> NDArray[np.bool_]:
        """Tell (bearing, step) which places lie on the picture."""
        column, row = np.moveaxis(self._map[_OVERSAMPLING // 2 :: _OVERSAMPLING], -1, 0)
        width, height = self.camera.size
        return (column > 1) & (column < width - 2) & (row > 1) & (row < height - 2)


def radius_on_plane(camera: MountedCamera, step: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the radius in the laser plane [m] at `step`, the pixels at which a camera without tilt sees it.

    >>> from springline.geometry.lenses import Lens
    >>> from springline.imaging.lens_table import MountedCamera
    >>> camera = MountedCamera(Lens("perspective", 500.0), (319.5, 239.5), (640, 480), laser_ahead=0.3)
    >>> radius_on_plane(camera, np.array([250.0])).round(6).tolist()
    [0.15]
    """
    return camera.laser_ahead * np.tan(camera.lens.zenith(step))


def plane_pixels(camera: MountedCamera, bearing: NDArray[np.float64], step: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (bearing, step, 2) column and row at which the points of the laser plane are seen; NaN = unseen."""
    radius = radius_on_plane(camera, step)
    up, right = np.sin(bearing)[:, None] * radius, np.cos(bearing)[:, None] * radius
    points = np.stack([np.full_like(up, camera.laser_ahead), up, right], axis=-1)
    return to_pixels(project(camera_at(np.zeros(3), camera.axes), points, camera.lens), camera.centre)


def _reach(camera: MountedCamera) -> int:
    """Return the steps of radius that are laid out: pixels to the picture's farthest side, within the lens's range."""
    width, height = camera.size
    side = max(camera.centre[0], camera.centre[1], width - 1 - camera.centre[0], height - 1 - camera.centre[1])
    return int(min(side, float(camera.lens.radius(min(camera.lens.max_zenith, _STEEPEST)))))


def _weighed(rays: NDArray[np.float32], colour: str) -> NDArray[np.float32]:
    if rays.shape[2] == 1:
        return rays[:, :, 0]
    return rays @ np.array(_WEIGHTS[colour], dtype=np.float32)


def _response(light: NDArray[np.float32], width: float) -> NDArray[np.float32]:
    """Return how much each place looks like the middle of a line of one-sigma `width`: bright, and dark beside."""
    from springline.imaging.opencv import opencv

    half = int(np.ceil(4.0 * width))
    x = np.arange(-half, half + 1) / width
    kernel = (1.0 - x**2) * np.exp(-0.5 * x**2)
    kernel -= kernel.mean()
    kernel /= np.abs(kernel).sum()
    cv2 = opencv()
    return cv2.filter2D(light, -1, kernel[None, :].astype(np.float32), borderType=cv2.BORDER_REPLICATE)


def _noise(response: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the robust one-sigma of each ray's response, never below what eight bits leave."""
    every = response[:, ::3]
    return np.maximum(1.4826 * np.median(np.abs(every), axis=1).astype(np.float64), 0.1)


def _capped(response: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the response between zero and what a typical bearing shows at best, so that a glint is no better."""
    best = response.max(axis=1)
    return np.clip(response, 0.0, float(np.median(best))).astype(np.float64)


def _kept(place: NDArray[np.float64], strength: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Tell which readings are of the ring: on its smooth course, or joined to it and as bright as it is."""
    course = smooth_course(place, strength)
    off = np.abs(place - course) > _OFF_COURSE * course
    kept = np.isfinite(place) & ~off
    if not kept.any():
        return kept
    bright = strength > _DIM * np.median(strength[kept])
    step = np.abs(place - np.roll(place, 1)) < _JUMP * course
    # Twice round, from what is on course outward both ways: joined is what a chain of small steps reaches.
    joined = kept.copy()
    count = len(place)
    for k in range(2 * count):
        i = k % count
        joined[i] |= joined[i - 1] and step[i] and bright[i]
    for k in range(2 * count, 0, -1):
        i = k % count
        joined[i - 1] |= joined[i] and step[i] and bright[i - 1]
    return _without_ends(joined)


def _without_ends(kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return `kept` less the last bearings of every arc, where the line mixes with what hides it."""
    inner = kept.copy()
    for k in range(1, _END + 1):
        inner &= np.roll(kept, k) & np.roll(kept, -k)
    return inner
