"""How every kernel here is compiled: lazily, kept on disk, without the interpreter's lock."""

from __future__ import annotations

from numba import njit

FAST = {"reassoc", "nsz", "arcp", "contract"}
"""Floating-point liberties that let sums over readings use vector registers; NaN and infinity keep their meaning."""

kernel = njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True)
"""Decorator of kernels whose every operation is done as written."""

vector_kernel = njit(cache=True, nogil=True, error_model="numpy", no_cfunc_wrapper=True, fastmath=FAST)
"""Decorator of kernels that are one loop over readings."""
