"""Refusals that several packages share: the parameter, its value, the range and how to mend it.

NaN stands for unknown: it passes every check and comes out as NaN.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

import numpy as np

from springline.errors import ParameterError, nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

Choice = TypeVar("Choice")

TOLERANCE = 1e-12
"""Relative room at a limit that is itself computed, so that a limit handed back is never refused."""


def require(valid: np.ndarray, name: str, value: object, expected: str, mend: str) -> None:
    """Raise ParameterError with the first value of `value` that is not `valid`."""
    valid = np.asarray(valid)
    if valid.all():
        return
    bad = ~np.broadcast_to(valid, np.broadcast_shapes(valid.shape, np.shape(value)))
    raise _at_first(name, np.asarray(value, float), bad, expected, mend)


def between(
    name: str,
    value: ArrayLike,
    low: ArrayLike,
    high: ArrayLike,
    *,
    bounds: str = "[]",
    given: Mapping[str, ArrayLike] | None = None,
) -> np.ndarray:
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
    value = _floats(name, value)
    above = np.less(low, value) if bounds[0] == "(" else np.less_equal(low, value)
    below = np.less(value, high) if bounds[1] == ")" else np.less_equal(value, high)
    bad = ~(above & below) & ~np.isnan(value)
    if bad.any():
        raise _refusal(name, value, low, high, bounds, given or {}, bad)
    return value


def positive(name: str, value: object, mend: str = "give a length in metres") -> np.ndarray:
    """Return `value` as floats; refuse what is not finite and above zero.

    >>> positive("r", -1.0)
    Traceback (most recent call last):
    springline.errors.ParameterError: r = -1 is out of range; expected r > 0. Give a length in metres
    """
    array = _floats(name, value)
    bad = ~((array > 0) & np.isfinite(array)) & ~np.isnan(array)
    if bad.any():
        raise _at_first(name, array, bad, f"{name} > 0", mend)
    return array


def finite(name: str, value: object, mend: str = "give a finite number, or NaN where unknown") -> np.ndarray:
    """Return `value` as floats; refuse infinities."""
    array = _floats(name, value)
    require(~np.isinf(array), name, array, "a finite number", mend)
    return array


def acute(name: str, value: object) -> np.ndarray:
    """Return the angle `value` [rad] as floats; refuse what does not lie inside +-pi/2."""
    array = _floats(name, value)
    require(
        ~(np.abs(array) >= np.pi / 2),
        name,
        array,
        f"-pi/2 < {name} < pi/2 rad",
        "a robot that faces across the pipe makes no ring; angles here are in radians",
    )
    return array


def choice(name: str, value: Choice, known: tuple) -> Choice:
    """Return `value`; refuse what is not one of `known`."""
    if value not in known:
        names = tuple(str(one) for one in known)
        raise ParameterError(
            f"{name} = {value!r} is not known{nearest(str(value), names)}", expected="one of " + ", ".join(names)
        )
    return value


def _floats(name: str, value: object) -> np.ndarray:
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError) as wrong:
        raise ParameterError(
            f"{name} = {value!r} is not a number", expected="a number or an array of numbers"
        ) from wrong


def _refusal(
    name: str,
    value: np.ndarray,
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
    return _at_first(name, value, bad, expected)


def _at_first(
    name: str, value: np.ndarray, bad: NDArray[np.bool_], expected: str, mend: str | None = None
) -> ParameterError:
    """Return the refusal that names the first bad element and its place."""
    first = tuple(int(i) for i in np.argwhere(bad)[0])
    where = f"element {first if len(first) > 1 else first[0]}" if first else None
    wrong = np.broadcast_to(value, bad.shape)[first]
    return ParameterError(f"{name} = {wrong:.10g} is out of range", where=where, expected=expected, mend=mend)
