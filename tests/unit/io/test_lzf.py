from __future__ import annotations

import numpy as np
import pytest

from springline.io.lzf import decompress


@pytest.mark.parametrize(
    ("packed", "expected"),
    [
        (b"\x02abc", b"abc"),
        (b"\x02abc\x20\x02", b"abcabc"),  # 3 bytes from 3 back
        (b"\x00a\xe0\x05\x00", b"a" * 15),  # a long run that overlaps itself: 7 + 5 + 2 bytes from 1 back
        (b"\x1f" + bytes(range(32)), bytes(range(32))),
    ],
)
def test_by_hand(packed, expected):
    out, filled = decompress(np.frombuffer(packed, np.uint8), len(expected))
    assert (bytes(out), filled) == (expected, len(expected))


@pytest.mark.parametrize(
    ("packed", "size"),
    [(b"\x05ab", 6), (b"\x02abc\x20\x09", 6), (b"\x02abc\x20", 6), (b"\x02abc\xe0", 9), (b"\x02abc\x20\x02", 4)],
)
def test_damage_is_never_filled_to_the_end(packed, size):
    assert decompress(np.frombuffer(packed, np.uint8), size)[1] < size
