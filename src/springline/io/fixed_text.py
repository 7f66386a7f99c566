"""Tables of numbers as fixed-point text, formatted all at once."""

from __future__ import annotations

import numpy as np

_LARGEST = 2**53


def fixed_text(values: np.ndarray, decimals: int) -> bytes:
    """Return rows of comma-separated fixed-point numbers, each row with its line end; NaN becomes an empty cell.

    Args:
        values: (row, column) float64.
        decimals: Digits after the point, at least 1.

    Raises:
        OverflowError: A number has more digits than a double holds.

    >>> fixed_text(np.array([[0.15, np.nan], [-12.3456, 7.0]]), 3)
    b'0.150,\\n-12.346,7.000\\n'
    """
    rows, columns = values.shape
    none = np.isnan(values)
    scaled = np.rint(np.where(none, 0.0, values) * 10.0**decimals)
    if not (np.abs(scaled) < _LARGEST).all():
        raise OverflowError(f"a number is too large for {decimals} decimals")
    whole = scaled.astype(np.int64)
    negative, whole = whole < 0, np.abs(whole)
    digits = max(len(str(int(whole.max(initial=0)))), decimals + 1)
    # One cell is: sign, digits before the point, the point, digits after it, a comma or the line end.
    text = np.empty((rows, columns, digits + 3), np.uint8)
    keep = np.ones(text.shape, bool)
    text[..., 0] = ord("-")
    keep[..., 0] = negative
    before = digits - decimals
    point = 1 + before
    text[..., point] = ord(".")
    for k in range(digits):  # from the last digit to the first
        place = digits - k + (1 if k < decimals else 0)
        if k > decimals:
            keep[..., place] = whole > 0
        whole, digit = np.divmod(whole, 10)
        text[..., place] = digit + ord("0")
    text[..., -1] = ord(",")
    text[:, -1, -1] = ord("\n")
    keep[none] = False
    keep[..., -1] = True
    return text[keep].tobytes()
