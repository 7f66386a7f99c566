"""Where a robot turned: one run whose counter goes out and comes back."""

from __future__ import annotations

import numpy as np

FEWEST = 10
"""Rings that each of the two ways must have at least."""


def turn_of(distance: np.ndarray) -> int | None:
    """Return the last ring of the way out of a run that goes out and comes back once; None for any other.

    Args:
        distance: Of the rings in the order in which they were taken [m] (n,).

    >>> turn_of(np.concatenate([np.arange(12.0), np.arange(10.5, 0.0, -1.0)]))
    11
    >>> turn_of(np.arange(12.0)) is None
    True
    """
    distance = np.asarray(distance, float)
    if len(distance) < 2 * FEWEST or not np.isfinite(distance).all():
        return None
    last = int(np.argmax(distance))
    steps = np.diff(distance)
    # The two rings beside the turn may stand at one place.
    out, back = steps[:last], steps[last + 1 :]
    enough = last + 1 >= FEWEST and len(distance) - last - 1 >= FEWEST
    return last if enough and (out > 0.0).all() and (back < 0.0).all() else None
