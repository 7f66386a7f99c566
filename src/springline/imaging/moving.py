"""Frames in order, from picture files and from videos: `ring.mp4#120` is frame 120 of a video, counted from 0."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from springline.errors import InputError, MissingExtraError
from springline.imaging.frames import read_frame

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    import numpy as np
    from numpy.typing import NDArray

VIDEO_SUFFIXES = (".avi", ".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".webm", ".wmv")
"""Endings of files that are taken for videos."""


def each_frame(names: Iterable[str], folder: str | Path = ".") -> Iterator[tuple[int, NDArray[np.uint8] | InputError]]:
    """Yield (index, picture) for every name, in order; the refusal stands in place of a picture that cannot be read.

    Args:
        names: Files relative to `folder`; `VIDEO#N` is frame N of a video, from 0. Frames of one video that follow
            each other in rising order are decoded in one go.
        folder: Where they lie.

    Yields:
        The name's place in `names`, and (row, column, 3) of blue, green and red, or the InputError that says why there
        is none.

    Raises:
        MissingExtraError: OpenCV, or PyAV for a video, is not installed.
    """
    video = _Videos()
    try:
        for index, name in enumerate(names):
            try:
                file, number = _split(name)
                path = Path(folder) / file
                yield index, read_frame(path) if number is None else video.frame(path, number)
            except InputError as refusal:
                yield index, refusal
    finally:
        video.close()


def _split(name: str) -> tuple[str, int | None]:
    file, mark, number = name.rpartition("#")
    if mark and Path(file).suffix.lower() in VIDEO_SUFFIXES:
        if not number.isdigit():
            raise InputError(f"'{number}' is no frame's number", where=name, expected="VIDEO#N, N counted from 0")
        return file, int(number)
    if Path(name).suffix.lower() in VIDEO_SUFFIXES:
        raise InputError("it is a video, not a frame", where=name, expected="VIDEO#N, N counted from 0")
    return name, None


class _Videos:
    """The video that is being decoded, and how far it has come."""

    def __init__(self) -> None:
        self._path: Path | None = None
        self._container = self._stream = None
        self._next = 0

    def frame(self, path: Path, number: int) -> NDArray[np.uint8]:
        if path != self._path or number < self._next:
            self._open(path)
        try:
            for picture in self._stream:
                self._next += 1
                if self._next > number:
                    return picture.to_ndarray(format="bgr24")
        except self._error as error:
            self._path = None
            raise InputError(
                f"the video is damaged at frame {self._next}: {_told(error)}", where=f"{path}#{number}"
            ) from None
        self._path = None
        raise InputError(f"the video has only {self._next} frames", where=f"{path}#{number}")

    def _open(self, path: Path) -> None:
        try:
            import av
        except ImportError:
            raise MissingExtraError.of("video", "reading videos") from None
        self.close()
        self._error = av.error.FFmpegError
        try:
            self._container = av.open(str(path))
            stream = self._container.streams.video[0]
        except (av.error.FFmpegError, IndexError, OSError) as error:
            raise InputError(f"the video cannot be read: {_told(error)}", where=path) from None
        stream.thread_type = "AUTO"
        self._stream, self._path, self._next = self._container.decode(stream), path, 0

    def close(self) -> None:
        if self._container is not None:
            self._container.close()
        self._container = self._stream = self._path = None


def _told(error: Exception) -> str:
    return getattr(error, "strerror", None) or "there is no picture in it"
