"""Arrays that are put aside and fetched again, in memory or in a temporary file."""

from __future__ import annotations

import tempfile
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from ..errors import OutputError

if TYPE_CHECKING:
    from collections.abc import Hashable
    from types import TracebackType


class Spill:
    """Arrays put aside by key.

    The file has no name that others could meet (on systems that allow it), and is gone when it is closed or the process
    ends, however it ends. A key that is put again takes the place of what it held.

    Args:
        on_disk: Whether arrays go to a file in the folder for temporary files (`TMPDIR`) rather than stay in memory.

    >>> with Spill(on_disk=True) as aside:
    ...     aside.put("pair", np.arange(3.0), np.eye(2))
    ...     [one.shape for one in aside.get("pair")]
    [(3,), (2, 2)]
    """

    def __init__(self, *, on_disk: bool) -> None:
        self._file: BinaryIO | None = tempfile.TemporaryFile(prefix="springline-") if on_disk else None  # noqa: SIM115
        self._kept: dict[Hashable, tuple[np.ndarray, ...]] = {}
        self._places: dict[Hashable, tuple[int, list[tuple[int, ...]]]] = {}
        self._end = 0

    def __enter__(self) -> Spill:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Forget everything."""
        self._kept.clear()
        if self._file is not None:
            self._file.close()

    def put(self, key: Hashable, *arrays: np.ndarray) -> None:
        """Put arrays of floats aside.

        Raises:
            OutputError: There is no room for them.
        """
        if self._file is None:
            self._kept[key] = arrays
            return
        shapes = [one.shape for one in arrays]
        start, before = self._places.get(key, (self._end, None))
        if before is not None and _size(before) < _size(shapes):
            start = self._end
        self._places[key] = (start, shapes)
        self._end = max(self._end, start + _size(shapes))
        try:
            self._file.seek(start)
            for one in arrays:
                self._file.write(np.ascontiguousarray(one, dtype=float).data)
        except OSError as error:
            raise OutputError(
                f"the joint estimate could not put its windows aside: {error}",
                where=tempfile.gettempdir(),
                expected=f"room for {self._end / 1e6:.0f} MB or more",
                mend="free some, or name another folder in TMPDIR",
            ) from error

    def get(self, key: Hashable) -> list[np.ndarray]:
        """Return copies of the arrays of a key."""
        if self._file is None:
            return [one.copy() for one in self._kept[key]]
        start, shapes = self._places[key]
        self._file.seek(start)
        out = [np.empty(shape) for shape in shapes]
        for one in out:
            self._file.readinto(one.data.cast("B") if one.size else bytearray())
        return out


def _size(shapes: list[tuple[int, ...]]) -> int:
    return 8 * sum(int(np.prod(shape)) for shape in shapes)
