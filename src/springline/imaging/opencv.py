"""OpenCV, imported where it is used and named when it is missing."""

from __future__ import annotations

from types import ModuleType

from springline.errors import MissingExtraError


def opencv() -> ModuleType:
    """Return the module `cv2`.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        import cv2
    except ImportError as error:
        raise MissingExtraError.of("vision", "working on images") from error
    return cv2
