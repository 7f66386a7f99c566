"""Where the pipe leads to in a frame, from how its light falls off around that point."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from springline.imaging.edges import EdgeField

    Array = NDArray[np.float64]

_SMOOTH = 6.0  # px, wide enough to leave the light of the lamp and no texture
_STEP = 4  # px between the places looked at
_SPREAD = 0.2  # sine of the angle at which a slope no longer counts as pointing at the point
_NEAR = 8.0  # px around the point where directions say nothing
_ROUNDS = 12
_STARTS = 12  # places of the coarse search that are settled
_LEAD = 0.06  # of its agreement over that of any other place, above which the point is relied upon
_APART = 60.0  # px between the point and what counts as another place
_BEYOND = 0.3  # doubt of a point outside the frame, relative to how far outside


@dataclass(frozen=True)
class VanishingPoint:
    """The point around which the light of a frame falls off.

    Attributes:
        column, row: In working pixels; it may lie outside the frame.
        agreement: Share of the light's slope that points at it, 0 to 1.
        lead: How much of that it has over any other place.
        doubt: How much more uncertain it is for lying outside the frame [px].
    """

    column: float
    row: float
    agreement: float
    lead: float
    doubt: float

    @property
    def reliable(self) -> bool:
        """Whether it stands out from all other places: false where the camera looks at the wall."""
        return self.lead >= _LEAD


def vanishing_point(field: EdgeField) -> VanishingPoint:
    """Return the point that the slopes of the smoothed light point at.

    The lamp rides with the camera, so along every line from the point the light only falls or only rises; the point
    minimises the angles between slopes and these lines, outliers weighted down.

    Args:
        field: Edge field of a frame; its light is used.

    Returns:
        VanishingPoint; it may lie outside the frame.
    """
    cv2 = opencv()
    smooth = cv2.GaussianBlur(field.light, (0, 0), _SMOOTH)
    across, down = (cv2.Scharr(smooth, cv2.CV_32F, *order) / 32.0 for order in ((1, 0), (0, 1)))
    left, right, top, bottom = field.box.astype(int)
    edge = int(_SMOOTH)
    y, x = np.mgrid[top + edge : bottom - edge : _STEP, left + edge : right - edge : _STEP]
    slope_x, slope_y = across[y, x].ravel().astype(float), down[y, x].ravel().astype(float)
    x, y = x.ravel().astype(float), y.ravel().astype(float)
    slope = np.hypot(slope_x, slope_y)
    telling = (slope > 0.3 * np.median(slope)) & (slope > 0)
    if telling.sum() < 10:
        return VanishingPoint(0.5 * (left + right), 0.5 * (top + bottom), 0.0, 0.0, 0.0)
    x, y, slope = x[telling], y[telling], slope[telling]
    normal = np.stack([-slope_y[telling], slope_x[telling]]) / slope
    weight = np.minimum(slope, np.percentile(slope, 80))
    lines = (x, y, normal, normal[0] * x + normal[1] * y, weight)
    columns = left + (right - left) * np.linspace(-1.0, 2.0, 13)
    rows = top + (bottom - top) * np.linspace(-0.5, 1.5, 9)
    coarse = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    shares = _share(coarse, *lines)
    starts = coarse[np.argsort(-shares)[:_STARTS]]
    centre = np.array([[0.5 * (left + right), 0.5 * (top + bottom)]])
    points = np.concatenate([_settled(np.concatenate([centre, starts]), *lines), coarse])
    shares = np.concatenate([_share(points[: -len(coarse)], *lines), shares])
    best = int(np.argmax(shares))
    column, row = points[best]
    others = np.hypot(*(points - points[best]).T) > _APART
    lead = float(shares[best] - shares[others].max(initial=0.0))
    outside = np.hypot(max(left - column, column - right, 0.0), max(top - row, row - bottom, 0.0))
    return VanishingPoint(float(column), float(row), float(shares[best]), lead, _BEYOND * float(outside))


def _sines(points: Array, x: Array, y: Array, normal: Array, offset: Array) -> tuple[Array, Array]:
    distance = np.hypot(x - points[:, :1], y - points[:, 1:]) + _NEAR
    return (offset - points[:, :1] * normal[0] - points[:, 1:] * normal[1]) / distance, distance


def _settled(points: Array, x: Array, y: Array, normal: Array, offset: Array, weight: Array) -> Array:
    """Weighted least squares from every start at once, angles beyond the spread losing their weight."""
    for _ in range(_ROUNDS):
        sine, distance = _sines(points, x, y, normal, offset)
        pull = weight / (1.0 + (sine / _SPREAD) ** 2) ** 2 / distance**2
        xx, xy, yy = pull @ normal[0] ** 2, pull @ (normal[0] * normal[1]), pull @ normal[1] ** 2
        bx, by = pull @ (offset * normal[0]), pull @ (offset * normal[1])
        determinant = np.maximum(xx * yy - xy * xy, 1e-30)
        points = np.stack([(bx * yy - by * xy) / determinant, (by * xx - bx * xy) / determinant], axis=-1)
    return points


def _share(points: Array, x: Array, y: Array, normal: Array, offset: Array, weight: Array) -> Array:
    sine, _ = _sines(points, x, y, normal, offset)
    return (1.0 / (1.0 + (sine / _SPREAD) ** 2)) @ weight / weight.sum()
