"""One builder for shapes of arcs and lines that are symmetric about the y axis: a walk from the crown to the invert.

A new shape is a short table: the steps of the walk down its left side, and the crown's height above O.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...errors import ParameterError
from .arcs import ArcSection, Pieces

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]


class Arc(NamedTuple):
    """A circular arc that bulges outward: its radius, and the angle through which it turns the wall [rad]."""

    radius: ArrayLike
    turn: ArrayLike


class Line(NamedTuple):
    """A straight stretch of wall: its length."""

    length: ArrayLike


class Corner(NamedTuple):
    """A corner: the angle through which it turns the wall [rad], positive where the corner sticks out."""

    turn: ArrayLike


def symmetric(walk: Sequence[Arc | Line | Corner], crown: ArrayLike) -> ArcSection:
    """Return the section whose left side is walked from the crown, heading left, down to the invert.

    Args:
        walk: Arcs, lines and corners in order; their numbers broadcast to a batch.
        crown: Height of the crown above O.

    Raises:
        ParameterError: The walk does not come back to the axis, or O does not see the whole shape.

    >>> pill = symmetric([Arc(1.0, np.pi / 2), Line(2.0), Arc(1.0, np.pi / 2)], crown=2.0)
    >>> round(float(pill.area - np.pi), 12)
    4.0
    """
    crown = np.asarray(crown, float)
    shape = np.broadcast_shapes(crown.shape, *(np.shape(number) for step in walk for number in step))
    position = np.broadcast_to(1j * crown, shape)
    heading = np.full(shape, np.pi)
    left: list[tuple[bool, NDArray, NDArray, Array, Array, Array]] = []
    for step in walk:
        start, before = position, heading
        centre, radius = start, np.zeros(shape)
        if isinstance(step, Line):
            position = start + np.broadcast_to(step.length, shape) * np.exp(1j * before)
        else:
            heading = before + np.broadcast_to(step.turn, shape)
        if isinstance(step, Arc):
            radius = np.broadcast_to(np.asarray(step.radius, float), shape)
            centre = start + 1j * radius * np.exp(1j * before)
            position = centre - 1j * radius * np.exp(1j * heading)
        if not isinstance(step, Corner):
            left.append((isinstance(step, Line), start, centre, radius, before - np.pi / 2, heading - np.pi / 2))
    if np.any(np.abs(position.real) > 1e-9 * np.maximum(np.abs(crown), np.abs(position.imag))):
        off = float(np.max(np.abs(position.real)))
        raise ParameterError(f"the walk ends {off:g} beside the axis", expected="an end at the invert, on the axis")
    return ArcSection(_closed(left, position))


def _closed(left: list[tuple], invert: NDArray) -> Pieces:
    """Return the left side followed by its mirror image, from the invert back to the crown."""
    straight, node, centre, radius, t0, t1 = zip(*left, strict=True)
    ends = (*node[1:], 1j * invert.imag)

    def both(down: Sequence[NDArray], up: Sequence[NDArray]) -> NDArray:
        return np.stack([*down, *up[::-1]], axis=-1)

    axes = both(radius, radius)
    return Pieces(
        straight=np.array([*straight, *straight[::-1]]),
        node=both(node, [-np.conj(p) for p in ends]),
        centre=both(centre, [-np.conj(p) for p in centre]),
        a=axes,
        b=axes,
        tilt=np.zeros(axes.shape),
        t0=both(t0, [np.pi - t for t in t1]),
        t1=both(t1, [np.pi - t for t in t0]),
    )
