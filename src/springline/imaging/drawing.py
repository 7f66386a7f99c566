"""Pictures of frames with what was found in them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from springline.imaging.frames import checked_frame
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from springline.imaging.detections import Detection

_COLOURS = {"joint": (200, 60, 255), "lateral": (0, 165, 255)}  # blue, green, red
_FARTHEST = 30_000  # px beyond which a curve's points are not drawn


def draw_detections(image: NDArray[np.uint8], found: Iterable[Detection]) -> NDArray[np.uint8]:
    """Return a copy of a frame with every detection as a curve, its kind and its confidence in percent.

    Args:
        image: The frame.
        found: As of `detect_frame`.

    Raises:
        InputError: The image's shape, type or size is out of range.
        MissingExtraError: OpenCV is not installed.
    """
    cv2 = opencv()
    picture = checked_frame(image).copy()
    thick = max(1, round(min(picture.shape[:2]) / 240))
    turn = np.linspace(0.0, 2.0 * np.pi, 721)
    for line, one in enumerate(found):
        colour = _COLOURS[one.kind]
        u, v = one.semi_major * np.cos(turn), one.semi_minor * np.sin(turn)
        cos, sin = math.cos(one.angle), -math.sin(one.angle)
        curve = np.stack([one.column + cos * u - sin * v, one.row + sin * u + cos * v], axis=-1)
        points = np.clip(np.round(curve), -_FARTHEST, _FARTHEST).astype(np.int32)
        cv2.polylines(picture, [points], True, colour, thick, cv2.LINE_AA)
        text = f"{one.kind} {100 * one.confidence:.0f} %"
        place = (4 * thick, 14 * thick * (line + 1))
        cv2.putText(picture, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.4 * thick, colour, thick, cv2.LINE_AA)
    return picture
