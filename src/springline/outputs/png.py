"""Pictures with a palette, written as PNG (ISO/IEC 15948) with the standard library alone."""

from __future__ import annotations

import struct
import zlib

import numpy as np


def palette_png(indices: np.ndarray, palette: np.ndarray) -> bytes:
    """Return a PNG whose pixels are indices into a palette.

    Args:
        indices: Rows from the top, (height, width) uint8.
        palette: Colours in sRGB, (up to 256, 3) uint8.

    >>> palette_png(np.zeros((1, 1), np.uint8), np.zeros((1, 3), np.uint8))[1:4]
    b'PNG'
    """
    height, width = indices.shape
    # Each row is led by its filter type; palette pictures compress best with none.
    rows = np.zeros((height, width + 1), np.uint8)
    rows[:, 1:] = indices
    return b"".join(
        (
            b"\x89PNG\r\n\x1a\n",
            _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0)),
            _chunk(b"PLTE", palette.astype(np.uint8).tobytes()),
            _chunk(b"IDAT", zlib.compress(rows.tobytes(), 9)),
            _chunk(b"IEND", b""),
        )
    )


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
