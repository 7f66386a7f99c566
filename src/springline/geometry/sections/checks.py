"""Refusing parameters that are out of range, with the parameter, its value and the valid range in the message.

NaN stands for unknown: it passes every check and comes out as NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

TOLERANCE = 1e-12
"""Relative room at a limit that is itself computed, so that a limit handed back is never refused."""


def between(
    name: str,
    value: ArrayLike,
    low: ArrayLike,
    high: ArrayLike,
    *,
    bounds: str = "[]",
    given: Mapping[str, ArrayLike] | None = None,
) -> Array:
    """Return `value` as an array, or refuse it.

    Args:
        name: The parameter's name, for the message.
        value: The parameter; NaN passes.
        low, high: Its limits; they broadcast with it.
        bounds: "[]" both limits belong to the range, "(]", "[)" or "()" otherwise.
        given: The other parameters on which the limits depend, for the message.

    Raises:
        ParameterError: Names the first offending value, the range and the given parameters.

    >>> between("s1", 0.3, 0.46, 1.0, given={"mode": 3})
    Traceback (most recent call last):
    springline.errors.ParameterError: s1 = 0.3 is out of range; expected 0.46 <= s1 <= 1 with mode = 3
    """
    value = np.asarray(value, float)
    above = np.less(low, value) if bounds[0] == "(" else np.less_equal(low, value)
    below = np.less(value, high) if bounds[1] == ")" else np.less_equal(value, high)
    bad = ~(above & below) & ~np.isnan(value)
    if bad.any():
        raise _refusal(name, value, low, high, bounds, given or {}, bad)
    return value


def positive(name: str, value: ArrayLike) -> Array:
    """Return `value` as an array, or refuse it unless it is above zero and finite.

    >>> positive("r", -1.0)
    Traceback (most recent call last):
    springline.errors.ParameterError: r = -1 is out of range; expected 0 < r < inf
    """
    return between(name, value, 0.0, np.inf, bounds="()")


def one_of(name: str, value: object, known: tuple) -> None:
    """Refuse a keyword that is not among the known ones.

    >>> one_of("rule", "exakt", ("exact", "ramanujan"))
    Traceback (most recent call last):
    springline.errors.ParameterError: rule = 'exakt' is unknown; expected one of 'exact', 'ramanujan'
    """
    if value not in known:
        raise ParameterError(f"{name} = {value!r} is unknown", expected=f"one of {', '.join(map(repr, known))}")


def _refusal(
    name: str,
    value: Array,
    low: ArrayLike,
    high: ArrayLike,
    bounds: str,
    given: Mapping[str, ArrayLike],
    bad: NDArray[np.bool_],
) -> ParameterError:
    first = tuple(int(i) for i in np.argwhere(bad)[0])

    def there(quantity: ArrayLike) -> str:
        return f"{np.broadcast_to(quantity, bad.shape)[first]:.10g}"

    signs = ["<" if bounds[0] == "(" else "<=", "<" if bounds[1] == ")" else "<="]
    expected = f"{there(low)} {signs[0]} {name} {signs[1]} {there(high)}"
    if given:
        expected += " with " + ", ".join(f"{key} = {there(number)}" for key, number in given.items())
    where = f"element {first if len(first) > 1 else first[0]}" if first else None
    return ParameterError(f"{name} = {there(value)} is out of range", where=where, expected=expected)
