"""16-bit depth images with pinhole intrinsics."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import FormatError, InputError, MissingExtraError
from .axes import CAMERA
from .clouds import RawCloud, cloud_survey
from .units import METRES

if TYPE_CHECKING:
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions


def read_depth(path: Path, options: ReadOptions) -> Survey:
    """Read a 16-bit depth image into `/points`, row by row; 0 = no return.

    A pixel (u, v) of depth d along the optical axis becomes x = d forward, y = -(v - cy) d / fy up and
    z = (u - cx) d / fx to the right, about the camera's optical centre.

    Raises:
        InputError: The intrinsics are not given or lie outside the image, or no pixel has a return.
        FormatError: Not an image, cut short, or not of 16 bits.
        MissingExtraError: The extra `depth` is not installed.
    """
    if options.intrinsics is None:
        raise InputError(
            "a depth image needs the camera's intrinsics",
            where=path,
            mend="state them with --intrinsics fx,fy,cx,cy (pixels)",
        )
    counts = _counts(path)
    fx, fy, cx, cy = options.intrinsics
    height, width = counts.shape
    if not (0 <= cx < width and 0 <= cy < height):
        raise InputError(
            f"the principal point ({cx:g}, {cy:g}) lies outside the image of {width} x {height} pixels",
            where=path,
            mend="the intrinsics belong to another resolution; state those of this one",
        )
    unit = options.depth_unit or "mm"
    notes = (
        [] if options.depth_unit else [f"{path.name}: depth counts are taken as millimetres (--depth-unit overrules)."]
    )
    v, u = np.nonzero(counts)
    # In file coordinates of a camera that looks along -z, so that a cloud saved from the image reads the same.
    depth = counts[v, u] * METRES[unit]
    xyz = np.column_stack([(u - cx) * depth / fx, -(v - cy) * depth / fy, -depth])
    raw = RawCloud(
        xyz,
        axes=CAMERA,
        axes_stated=True,
        unit="m",
        sensor_kind="depth-camera",
        origin_is_sensor=True,
        notes=tuple(notes),
    )
    return cloud_survey(raw, path, options)


def _counts(path: Path) -> np.ndarray:
    try:
        from PIL import Image, UnidentifiedImageError
    except ImportError:
        raise MissingExtraError.of("depth", "reading depth images") from None
    try:
        with Image.open(path) as image:
            if not image.mode.startswith("I"):
                raise FormatError(
                    f"the image has the mode {image.mode}, not 16 bits of depth",
                    where=path,
                    expected="a single channel of 16 bits",
                    mend="export the raw depth, not the coloured picture of it",
                )
            return np.asarray(image).astype(np.float64)
    except UnidentifiedImageError:
        raise FormatError("it is not an image", where=path, expected="a 16-bit PNG or TIFF") from None
    except (OSError, SyntaxError, ValueError) as error:
        if isinstance(error, FormatError):
            raise
        raise FormatError(f"the image is cut short or damaged: {error}", where=path) from None
