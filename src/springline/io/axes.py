"""Axes of files: which of a file's axes make x forward, y up, z to the right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import ParameterError

if TYPE_CHECKING:
    import numpy as np

CAMERA = "-z,y,x"
"""The file's y is up, its x to the right, and the camera looks along -z (OpenGL): the habit of depth cameras."""
SURVEY = "x,z,-y"
"""The file's z is up and x forward: the habit of terrestrial scanners."""


def parse_axes(text: str) -> tuple[tuple[int, int], ...]:
    """Return (file axis, sign) for springline x, y and z from text such as '-z,y,x'.

    Args:
        text: Three of x, y, z, each once, with an optional sign; the n-th is the file axis that becomes the n-th of
            x forward, y up, z right.

    Raises:
        ParameterError: Not three axes, one of them twice, or a mirrored frame: clocks would run backwards.

    >>> parse_axes("-z,y,x")
    ((2, -1), (1, 1), (0, 1))
    >>> parse_axes("x,y,-z")
    Traceback (most recent call last):
    springline.errors.ParameterError: axes: 'x,y,-z' mirrors the pipe; expected a right-handed frame, such as x,y,z
    """
    pairs = []
    for part in text.replace(" ", "").lower().split(","):
        sign, letter = (-1, part[1:]) if part.startswith("-") else (1, part.removeprefix("+"))
        if letter not in ("x", "y", "z"):
            raise ParameterError(f"'{text}' holds '{part}'", where="axes", expected="three of x, y, z such as -z,y,x")
        pairs.append(("xyz".index(letter), sign))
    order = tuple(axis for axis, _ in pairs)
    if sorted(order) != [0, 1, 2]:
        raise ParameterError(f"'{text}' is no frame", where="axes", expected="x, y and z, each once, such as -z,y,x")
    parity = 1 if order in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) else -1
    if parity * pairs[0][1] * pairs[1][1] * pairs[2][1] < 0:
        flipped = ",".join(f"{'-' if s < 0 else ''}{'xyz'[a]}" for a, s in (*pairs[:2], (pairs[2][0], -pairs[2][1])))
        raise ParameterError(
            f"'{text}' mirrors the pipe", where="axes", expected=f"a right-handed frame, such as {flipped}"
        )
    return tuple(pairs)


def to_contract(xyz: np.ndarray, axes: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x forward, y up, z right from file coordinates (point, 3)."""
    x, y, z = (sign * xyz[:, axis] for axis, sign in parse_axes(axes))
    return x, y, z


def from_contract(x: np.ndarray, y: np.ndarray, z: np.ndarray, axes: str) -> np.ndarray:
    """Return file coordinates (point, 3); the inverse of `to_contract`."""
    import numpy as np

    xyz = np.empty((len(x), 3))
    for values, (axis, sign) in zip((x, y, z), parse_axes(axes), strict=True):
        xyz[:, axis] = sign * values
    return xyz


def describe(axes: str) -> str:
    """Return the mapping as words for people.

    >>> describe("-z,y,x")
    'x forward = file -z, y up = file y, z right = file x'
    """
    x, y, z = axes.replace(" ", "").split(",")
    return f"x forward = file {x}, y up = file {y}, z right = file {z}"
