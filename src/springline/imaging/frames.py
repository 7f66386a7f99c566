"""Frames as files: which ones a command names, and reading one with a clear refusal."""

from __future__ import annotations

import glob
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from springline.errors import InputError, OutputError
from springline.imaging.opencv import opencv

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    Image = NDArray[np.uint8]

SUFFIXES = (".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp")
"""Endings of the files that a folder is searched for."""

SMALLEST_SIDE = 64
"""Shortest side [px] of a frame in which a ring can be told from noise."""

LARGEST = 120_000_000
"""Most pixels of a frame."""


def find_frames(sources: Iterable[str | Path]) -> list[Path]:
    """Return the image files that names, folders and patterns stand for, in order, each once.

    Args:
        sources: Files, folders (their images, not those of their folders), or patterns such as `run1/*.jpg`.

    Returns:
        Paths; a file that is named itself is taken whatever its ending.

    Raises:
        InputError: A source names nothing, or a folder or pattern holds no image.
    """
    found: dict[Path, None] = {}
    for source in sources:
        path = Path(source)
        if path.is_dir():
            inside = sorted(p for p in path.iterdir() if p.suffix.lower() in SUFFIXES)
        elif path.is_file():
            inside = [path]
        else:
            inside = sorted(p for p in map(Path, glob.glob(str(source))) if p.suffix.lower() in SUFFIXES)  # noqa: PTH207
        if not inside:
            raise InputError(
                "no image found",
                where=path,
                expected=f"an image file, a folder or a pattern of files ending in {', '.join(SUFFIXES)}",
                mend="check the name; put patterns in quotes",
            )
        found |= dict.fromkeys(inside)
    return list(found)


def read_frame(path: str | Path) -> Image:
    """Return the picture of a file as stored, without turning it.

    Args:
        path: The file.

    Returns:
        Array (row, column, 3) of blue, green and red, 0 to 255.

    Raises:
        InputError: The file is missing, empty, truncated or no image, or its size is out of range.
        MissingExtraError: OpenCV is not installed.
    """
    cv2 = opencv()
    path = Path(path)
    try:
        content = np.fromfile(path, dtype=np.uint8)
    except OSError as error:
        reason = error.strerror or "unknown reason"
        raise InputError(
            f"the image cannot be read: {reason}", where=path, mend="check the name and the rights"
        ) from None
    if len(content) == 0:
        raise InputError("the image is empty", where=path, mend="copy it again from its source")
    if _cut_short(content):
        raise InputError("the image is cut short", where=path, mend="copy it again from its source")
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        image = cv2.imdecode(content, cv2.IMREAD_COLOR | cv2.IMREAD_IGNORE_ORIENTATION)
    except cv2.error:
        image = None
    finally:
        cv2.utils.logging.setLogLevel(level)
    if image is None:
        raise InputError("it is no image, or a damaged one", where=path, expected=", ".join(SUFFIXES))
    return checked_frame(image, path)


def checked_frame(image: NDArray[np.generic], where: str | Path | None = None) -> Image:
    """Return a picture as (row, column, 3) of 8 bits; grey ones are tripled.

    Raises:
        InputError: It is not of 8 bits with one or three channels, or its size is out of range.
    """
    image = np.asarray(image)
    if image.dtype != np.uint8 or image.ndim not in (2, 3) or (image.ndim == 3 and image.shape[2] not in (1, 3)):
        raise InputError(
            f"the image has shape {image.shape} and type {image.dtype}",
            where=where,
            expected="(row, column) or (row, column, 3) of 8 bits",
        )
    if min(image.shape[:2]) < SMALLEST_SIDE or image.shape[0] * image.shape[1] > LARGEST:
        raise InputError(
            f"the image has {image.shape[1]} by {image.shape[0]} pixels",
            where=where,
            expected=f"sides of at least {SMALLEST_SIDE}, and at most {LARGEST // 10**6} million pixels",
        )
    if image.ndim == 2 or image.shape[2] == 1:
        image = np.repeat(image.reshape(*image.shape[:2], 1), 3, axis=2)
    return np.ascontiguousarray(image)


def _cut_short(content: NDArray[np.uint8]) -> bool:
    """Whether a JPEG or PNG lacks its end; decoders fill what is missing with grey and say nothing."""
    head, tail = content[:8].tobytes(), content[-4096:].tobytes()
    if head.startswith(b"\xff\xd8"):
        return b"\xff\xd9" not in tail
    if head.startswith(b"\x89PNG"):
        return b"IEND" not in tail
    return False


def write_picture(path: Path, image: Image) -> None:
    """Write a picture as PNG.

    Raises:
        OutputError: The disk refuses.
        MissingExtraError: OpenCV is not installed.
    """
    content = opencv().imencode(".png", image, [opencv().IMWRITE_PNG_COMPRESSION, 3])[1]
    try:
        path.write_bytes(content.tobytes())
    except OSError as error:
        raise OutputError(f"cannot be written: {error.strerror or error}", where=path) from error
