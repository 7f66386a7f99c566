"""Frames as files: JPEG or PNG, by Pillow (extra `depth`)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import InputError

if TYPE_CHECKING:
    from .footage import Footage


def write_frames(footage: Footage, folder: Path, *, progress: Callable[[float], None] | None = None) -> None:
    """Render every frame and write it into `folder`, which is made; memory holds one frame at a time.

    Args:
        footage: The frames.
        folder: Where to write; it must not exist.
        progress: Called after each frame with the share that is done, 0 to 1.

    Raises:
        InputError: Pillow is not installed.
        OSError: The disk refuses.
    """
    try:
        from PIL import Image
    except ImportError:
        raise InputError(
            "frames are written with Pillow, which is not installed", mend='pip install "springline[depth]"'
        ) from None
    folder.mkdir(parents=True)
    options = {"quality": footage.camera.quality} if footage.camera.format == "jpg" else {"compress_level": 1}
    for k in range(len(footage)):
        Image.fromarray(footage.image(k)).save(folder / footage.file(k), **options)
        if progress is not None:
            progress((k + 1) / len(footage))
