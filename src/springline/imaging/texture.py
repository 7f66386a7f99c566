"""The wall as its frames show it: every frame projected onto the surveyed surface, blended with its neighbours.

Pipe frame of `springline.conventions`; lengths in metres, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError
from springline.geometry.camera import camera_eye, project, to_pixels
from springline.geometry.checks import require
from springline.geometry.measures import polar_radius
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from numpy.typing import NDArray

    from springline.imaging.lens_table import MountedCamera

    Array = NDArray[np.float64]
    Frames = Callable[[NDArray[np.int64]], Iterator[tuple[int, NDArray[np.uint8] | InputError]]]

_WINDOW = 1024  # rows that are blended at a time, so that memory does not grow with the pipe
_SAMPLE = 24  # pairs of frames from which the lamp's fall of light is learned
_FEWEST_ROWS, _FEWEST_SEEN = 20, 0.2  # rows that a pair shows in common, and the share of each that both see
_DARKEST, _BRIGHTEST = 4.0, 250.0  # greys beyond which a ratio says nothing
_FACING = 0.08  # cosine below which a wall is seen too flat to show anything
_EDGE = 0.06  # share of the picture's shorter side over which a frame fades out at its rim
_GAIN = (0.4, 4.0)


@dataclass(frozen=True)
class Surface:
    """The surveyed wall: a section at every row, along an axis that may bend.

    Attributes:
        x: (rows) chainage, rising [m].
        parameters: (rows, 3) mean_radius, oval_cos and oval_sin of the section [m]; NaN where there is none.
        heading: (rows) of the axis, clockwise from above [rad]; only its changes count.
        climb: (rows) of the axis, up [rad]; only its changes count.
        bearing: (columns) from +z counter-clockwise [rad], equal steps round the whole wall.
    """

    x: Array
    parameters: Array
    heading: Array
    climb: Array
    bearing: Array

    def seen_from(self, at: float, rows: slice) -> tuple[Array, Array]:
        """Return places on the wall and the unit normals there, inward, (rows, columns, 3), about the axis at `at`.

        The axes are those of the pipe where the chainage is `at` [m], the origin is the axis there.
        """
        x = self.x[rows]
        turn = self.heading[rows] - np.interp(at, self.x, self.heading)
        rise = self.climb[rows] - np.interp(at, self.x, self.climb)
        forward = np.stack([np.cos(rise) * np.cos(turn), np.sin(rise), np.cos(rise) * np.sin(turn)], axis=-1)
        right = np.stack([-np.sin(turn), np.zeros_like(turn), np.cos(turn)], axis=-1)
        up = np.cross(right, forward)
        # the way from the camera to the first row, then from row to row, each along the mean of its ends
        ahead = np.concatenate([[[1.0, 0.0, 0.0]], forward])
        way = np.diff(x, prepend=at)[:, None] * 0.5 * (ahead[1:] + ahead[:-1])
        axis = np.cumsum(way, axis=0)
        radius = polar_radius(self.parameters[rows, None], self.bearing)
        out = np.sin(self.bearing)[:, None] * up[:, None] + np.cos(self.bearing)[:, None] * right[:, None]
        return axis[:, None] + radius[..., None] * out, -out


@dataclass(frozen=True)
class View:
    """From where a frame was taken.

    Attributes:
        at: Chainage in whose axes the pose stands [m].
        matrix: (4, 4) pose as of `geometry.camera`, in the pipe's axes at `at`, with the origin on the axis there.
        camera: The camera.
    """

    at: float
    matrix: Array
    camera: MountedCamera

    @property
    def foot(self) -> float:
        """Chainage abreast of the camera itself [m]."""
        return self.at + float(camera_eye(self.matrix)[0])


@dataclass(frozen=True)
class Texture:
    """What frames show of the wall.

    Attributes:
        colour: (rows, columns, 3) red, green and blue in sRGB, uint8; 0 where nothing was seen.
        seen: (rows, columns) whether a frame shows it.
        used: Numbers of the views whose frames were laid on.
        refused: Number of a view and why its frame could not be used.
    """

    colour: NDArray[np.uint8]
    seen: NDArray[np.bool_]
    used: NDArray[np.int64]
    refused: tuple[tuple[int, str], ...]


def lay_frames(surface: Surface, views: Sequence[View], frames: Frames, near: float, far: float) -> Texture:
    """Return the wall's colours from frames, the lamp's fall of light taken away.

    A place takes its colour from every frame that sees it between `near` and `far` ahead; each counts by the square of
    the picture's area that the place takes up, so that the sharpest view prevails, and fades out at its rim. How light
    falls off ahead is the same for all frames of a drive and is learned from where they overlap; wall that is dark by
    itself stays so. Wall that turns away from the camera is not seen. Nothing is laid where there is no section.

    Args:
        surface: The wall.
        views: From where the frames were taken, in any order.
        frames: Given numbers of views, yields the place in that list and the picture (row, column, 3) blue, green and
            red, or the error that says why there is none.
        near, far: Which wall ahead of the camera is taken [m], 0 <= near < far.

    Returns:
        Texture.

    Raises:
        ParameterError: near or far is out of range.
        MissingExtraError: OpenCV is not installed.

    Source: 6.4 turned round, on the surface that was measured.
    """
    require(0.0 <= near < far, "near", near, f"0 <= near < far = {far} m", "give both in metres")
    shape = (len(surface.x), len(surface.bearing))
    colour, seen = np.zeros((*shape, 3), np.uint8), np.zeros(shape, bool)
    foot = np.array([view.foot for view in views], float)
    reaches = (foot + far >= np.min(surface.x, initial=np.inf)) & (foot + near <= np.max(surface.x, initial=-np.inf))
    chosen = _spread(np.where(reaches, foot, np.nan), 0.5 * (far - near))
    refused: dict[int, str] = {}
    laid = _Laid(surface, views, frames, near, far, refused)
    light = laid.light(chosen)
    for first in range(0, shape[0] if len(chosen) else 0, _WINDOW):
        rows = slice(first, min(first + _WINDOW, shape[0]))
        reached = chosen[(foot[chosen] + far >= surface.x[rows][0]) & (foot[chosen] + near <= surface.x[rows][-1])]
        colour[rows], seen[rows] = laid.blend(reached, rows, light)
    return Texture(colour, seen, np.setdiff1d(chosen, list(refused)), tuple(sorted(refused.items())))


def _spread(foot: Array, step: float) -> NDArray[np.int64]:
    """Views about `step` apart, in order; unknown places left out."""
    order = np.argsort(foot, kind="stable")
    order = order[np.isfinite(foot[order])]
    if not len(order):
        return order
    # of the views in each step the first, so that none of them is further from the next than a step and a frame
    cell = np.floor((foot[order] - foot[order[0]]) / step)
    return order[np.flatnonzero(np.diff(cell, prepend=-1.0))]


@dataclass
class _Laid:
    """Frames laid on one surface."""

    surface: Surface
    views: Sequence[View]
    frames: Frames
    near: float
    far: float
    refused: dict[int, str]

    def light(self, chosen: NDArray[np.int64]) -> tuple[float, float]:
        """Return slope and bend of the logarithm of the light over the way ahead, as share of near to far.

        Neighbouring frames show the same wall at different ways ahead, so that what the wall is like falls out.
        """
        rows, ratios = [], []
        starts = np.unique(np.linspace(0, len(chosen) - 2, _SAMPLE).astype(int)) if len(chosen) > 1 else []
        for start in starts:
            seen = [self._greys(view, picture) for view, picture in self._pictures(chosen[start : start + 2])]
            if len(seen) < 2:
                continue
            (first, share, grey), (second, other_share, other_grey) = seen
            _, here, there = np.intersect1d(first, second, assume_unique=True, return_indices=True)
            ratio = np.log(grey[here] / other_grey[there])
            known = np.isfinite(ratio).mean(axis=1) > _FEWEST_SEEN
            ratios.append(np.nanmedian(ratio[known], axis=1))
            near, far = share[here][known], other_share[there][known]
            rows.append(np.stack([near - far, near**2 - far**2], axis=-1))
        if sum(map(len, ratios)) < _FEWEST_ROWS:
            return 0.0, 0.0
        slope, bend = np.linalg.lstsq(np.concatenate(rows), np.concatenate(ratios), rcond=None)[0]
        return float(slope), float(bend)

    def _greys(self, view: View, picture: NDArray[np.uint8]) -> tuple[NDArray[np.int64], Array, Array]:
        """Rows that a frame shows, their share of the way from near to far, and their greys; NaN where unseen."""
        rows = self._rows(view, slice(0, len(self.surface.x)))
        values, weight = self._project(view, picture, rows)
        grey = values.mean(axis=-1).astype(float)
        grey[(weight == 0) | (grey < _DARKEST) | (grey > _BRIGHTEST)] = np.nan
        return np.arange(rows.start, rows.stop), self._share(view, rows), grey

    def _share(self, view: View, rows: slice) -> Array:
        return (self.surface.x[rows] - view.foot - self.near) / (self.far - self.near)

    def blend(
        self, numbers: NDArray[np.int64], rows: slice, light: tuple[float, float]
    ) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
        """Return colours and what is seen of a window of rows."""
        shape = (rows.stop - rows.start, len(self.surface.bearing))
        total, weights = np.zeros((*shape, 3), np.float32), np.zeros(shape, np.float32)
        for view, picture in self._pictures(numbers):
            mine = self._rows(view, rows)
            values, weight = self._project(view, picture, mine)
            share = self._share(view, mine)
            gain = np.exp(-(light[0] * share + light[1] * share**2)).clip(*_GAIN).astype(np.float32)
            here = slice(mine.start - rows.start, mine.stop - rows.start)
            total[here] += (weight * gain[:, None])[..., None] * values
            weights[here] += weight
        seen = weights > 0
        mean = total / np.where(seen, weights, 1.0)[..., None]
        # pictures are blue, green, red
        return np.rint(np.minimum(mean[..., ::-1], 255.0)).astype(np.uint8), seen

    def _pictures(self, numbers: NDArray[np.int64]) -> Iterator[tuple[View, NDArray[np.uint8]]]:
        usable = np.array([k for k in numbers if int(k) not in self.refused], np.int64)
        for place, picture in self.frames(usable):
            number = int(usable[place])
            try:
                if isinstance(picture, InputError):
                    raise picture
                self.views[number].camera.check_size(picture)
            except InputError as refusal:
                self.refused[number] = refusal.what
            else:
                yield self.views[number], picture

    def _rows(self, view: View, window: slice) -> slice:
        x = self.surface.x[window]
        low, high = np.searchsorted(x, [view.foot + self.near, view.foot + self.far])
        return slice(window.start + int(low), window.start + int(high))

    def _project(
        self, view: View, picture: NDArray[np.uint8], rows: slice
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return what a frame shows at each place, blue, green and red, and how much it counts; 0 where unseen."""
        cv2 = opencv()
        if rows.stop == rows.start:
            return np.zeros((0, len(self.surface.bearing), 3), np.float32), np.zeros((0, len(self.surface.bearing)))
        places, inward = self.surface.seen_from(view.at, rows)
        pixels = to_pixels(project(view.matrix, places.reshape(-1, 3), view.camera.lens), view.camera.centre)
        column, row = np.moveaxis(pixels.reshape(*places.shape[:2], 2), -1, 0)
        towards = camera_eye(view.matrix) - places
        distance = np.linalg.norm(towards, axis=-1)
        facing = np.einsum("...i,...i", inward, towards) / distance
        height, width = picture.shape[:2]
        rim = np.minimum(np.minimum(column, width - 1 - column), np.minimum(row, height - 1 - row))
        fade = np.clip(rim / (_EDGE * min(width, height)), 0.0, 1.0)
        ahead = self._share(view, rows)
        fade *= np.clip(np.minimum(ahead, 1.0 - ahead) / _EDGE, 0.02, 1.0)[:, None]
        weight = np.where((rim >= 0) & (facing > _FACING), fade * (facing / distance**2) ** 2, 0.0)
        weight = np.nan_to_num(weight).astype(np.float32)
        column, row = (np.nan_to_num(pixel, nan=-1.0).astype(np.float32) for pixel in (column, row))
        values = cv2.remap(picture, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        return values.astype(np.float32), weight
