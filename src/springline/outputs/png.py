"""Pictures written as PNG (ISO/IEC 15948) with the standard library alone."""

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


def rgb_png(pixels: np.ndarray) -> bytes:
    """Return a PNG of colours in sRGB, rows from the top, (height, width, 3) uint8.

    >>> rgb_png(np.zeros((1, 1, 3), np.uint8))[1:4]
    b'PNG'
    """
    height, width = pixels.shape[:2]
    # Photographs compress best as what changes from the row above: the filter type 2, of the first row too.
    rows = np.empty((height, 3 * width + 1), np.uint8)
    rows[:, 0] = 2
    flat = pixels.reshape(height, -1)
    rows[0, 1:] = flat[0]
    rows[1:, 1:] = flat[1:] - flat[:-1]
    return b"".join(
        (
            b"\x89PNG\r\n\x1a\n",
            _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
            _chunk(b"IDAT", zlib.compress(rows.data, 6)),
            _chunk(b"IEND", b""),
        )
    )


def _chunk(kind: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
