"""Small dense symmetric systems inside the kernels: a few unknowns, no allocation."""

from __future__ import annotations

from math import sqrt

from springline.geometry.fitting._jit import kernel


@kernel
def factorise(a, p, low):
    """Write the lower Cholesky factor of the leading p x p block of `a` into `low`; return whether it exists."""
    for j in range(p):
        for i in range(j, p):
            total = a[i, j]
            for k in range(j):
                total -= low[i, k] * low[j, k]
            if i == j:
                # a pivot lost to rounding means that the readings do not determine this unknown
                if not total > 1e-15 * a[j, j]:
                    return False
                low[j, j] = sqrt(total)
            else:
                low[i, j] = total / low[j, j]
    return True


@kernel
def substitute(low, p, b, x):
    """Solve (low low^T) x = b for a lower factor; x may be b."""
    for i in range(p):
        total = b[i]
        for k in range(i):
            total -= low[i, k] * x[k]
        x[i] = total / low[i, i]
    for i in range(p - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, p):
            total -= low[k, i] * x[k]
        x[i] = total / low[i, i]


@kernel
def invert(low, p, inverse):
    """Write the inverse of low low^T into the leading p x p block of `inverse`."""
    for j in range(p):
        for i in range(p):
            inverse[j, i] = 0.0
        inverse[j, j] = 1.0
        substitute(low, p, inverse[j], inverse[j])
