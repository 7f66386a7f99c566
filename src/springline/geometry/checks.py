"""Refusals that several packages share: the parameter, its value, the range and how to mend it; NaN always passes."""

from __future__ import annotations

import numpy as np

from springline.errors import ParameterError, nearest


def require(valid: np.ndarray, name: str, value: object, expected: str, mend: str) -> None:
    """Raise ParameterError with the first value of `value` that is not `valid`."""
    valid = np.asarray(valid)
    if valid.all():
        return
    wrong = np.broadcast_to(np.asarray(value, float), np.broadcast_shapes(valid.shape, np.shape(value)))
    first = wrong[~np.broadcast_to(valid, wrong.shape)].ravel()[0]
    raise ParameterError(f"{name} = {first:g} is out of range", expected=expected, mend=mend)


def positive(name: str, value: object, mend: str = "give a length in metres") -> np.ndarray:
    """Return `value` as floats; refuse what is not finite and above zero."""
    array = _floats(name, value)
    require(np.isnan(array) | (np.isfinite(array) & (array > 0)), name, array, f"{name} > 0", mend)
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


def choice(name: str, value: str, known: tuple[str, ...]) -> str:
    """Return `value`; refuse what is not one of `known`."""
    if value not in known:
        raise ParameterError(
            f"{name} = {value!r} is not known{nearest(str(value), known)}", expected="one of " + ", ".join(known)
        )
    return value


def _floats(name: str, value: object) -> np.ndarray:
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError) as wrong:
        raise ParameterError(
            f"{name} = {value!r} is not a number", expected="a number or an array of numbers"
        ) from wrong
