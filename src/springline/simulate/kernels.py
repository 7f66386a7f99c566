"""How the simulator's innermost functions are compiled."""

from __future__ import annotations

from functools import partial

from numba import njit

# They read arrays and make none: without counting references to every array of a wall, at each call, they run in a
# third of the time.
inner = partial(njit, cache=True, _nrt=False)
"""Decorator of a function that makes no array; takes the options of `numba.njit`."""
