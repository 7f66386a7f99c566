"""LZF decompression, as compressed PCD files need it."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def _unpack(packed: np.ndarray, out: np.ndarray) -> int:
    """Fill `out` from `packed` and return the number of bytes filled; fewer than asked for when damaged."""
    i = o = 0
    while i < packed.size:
        control = np.int64(packed[i])
        i += 1
        if control < 32:  # a run of literals
            run = control + 1
            if i + run > packed.size or o + run > out.size:
                return o
            out[o : o + run] = packed[i : i + run]
            i += run
            o += run
            continue
        run = control >> 5
        if run == 7:
            if i >= packed.size:
                return o
            run += np.int64(packed[i])
            i += 1
        if i >= packed.size:
            return o
        back = o - ((control & 31) << 8) - np.int64(packed[i]) - 1
        i += 1
        run += 2
        if back < 0 or o + run > out.size:
            return o
        for k in range(run):  # the copy may overlap what it writes
            out[o + k] = out[back + k]
        o += run
    return o


def decompress(packed: np.ndarray, size: int) -> tuple[np.ndarray, int]:
    """Return `size` unpacked bytes and how many of them were filled.

    Args:
        packed: Compressed bytes (n,), uint8.
        size: Bytes that the unpacked data have.

    >>> packed = np.array([2, 97, 98, 99, 64, 2], np.uint8)  # literals "abc", then 4 bytes from 3 back
    >>> bytes(decompress(packed, 7)[0])
    b'abcabca'
    """
    out = np.zeros(size, np.uint8)
    return out, int(_unpack(np.ascontiguousarray(packed), out))
