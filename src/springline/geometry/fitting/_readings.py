"""The readings of one ring inside the kernels: gathered, centred and scaled, put in order round the wall."""

from __future__ import annotations

from math import isfinite, sqrt

from springline.geometry.fitting._jit import kernel, vector_kernel

ANGLE_BINS = 128
"""Bins of angle by which readings are put in order."""


@vector_kernel
def _copy_complete(z, y, out_z, out_y, out_w, index):
    """Copy all readings with weight one; return whether they are all finite, and the copy thus the answer."""
    total = 0.0
    for i in range(z.size):
        # zero times a number is zero, and NaN times infinity or NaN
        total += 0.0 * z[i] + 0.0 * y[i]
        out_z[i] = z[i]
        out_y[i] = y[i]
        out_w[i] = 1.0
        index[i] = i
    return total == 0.0


@kernel
def gather(z, y, weight, weighted, out_z, out_y, out_w, index):
    """Copy the readings that can be used (finite, positive weight), with their index; return how many there are.

    Weights are brought to mean one, so that the noise stays that of an average reading.
    """
    if not weighted and _copy_complete(z, y, out_z, out_y, out_w, index):
        return z.size
    n = 0
    total = 0.0
    for i in range(z.size):
        w = weight[i] if weighted else 1.0
        if isfinite(z[i] + y[i]) and w > 0.0 and isfinite(w):
            out_z[n] = z[i]
            out_y[n] = y[i]
            out_w[n] = w
            index[n] = i
            total += w
            n += 1
    if weighted and n > 0:
        scale = n / total
        for i in range(n):
            out_w[i] *= scale
    return n


@vector_kernel
def normalise(z, y, n):
    """Shift the readings to their centroid and scale them to unit rms radius, in place.

    Returns the centroid (z, y), the scale, and the ratio of the standard deviations across and along the direction
    in which the readings spread most: zero when they are collinear.
    """
    mean_z = 0.0
    mean_y = 0.0
    for i in range(n):
        mean_z += z[i]
        mean_y += y[i]
    mean_z /= n
    mean_y /= n
    zz = 0.0
    zy = 0.0
    yy = 0.0
    for i in range(n):
        z[i] -= mean_z
        y[i] -= mean_y
        zz += z[i] * z[i]
        zy += z[i] * y[i]
        yy += y[i] * y[i]
    scale = sqrt((zz + yy) / n)
    if not scale > 0.0:
        return mean_z, mean_y, 0.0, 0.0
    inverse = 1.0 / scale
    for i in range(n):
        z[i] *= inverse
        y[i] *= inverse
    half_gap = 0.5 * sqrt((zz - yy) ** 2 + 4.0 * zy * zy)
    large = 0.5 * (zz + yy) + half_gap
    # determinant over the large eigenvalue keeps the small one accurate
    small = max((zz * yy - zy * zy) / large, 0.0)
    return mean_z, mean_y, scale, sqrt(small / large)


@kernel
def order_by_angle(z, y, w, index, n, key, counts, other):
    """Put the readings in order of the angle about the origin, to a bin.

    `key`, `counts` (integer) and `other` (4, n) are scratch. The angle is the diamond angle, which needs no
    transcendental function and orders as the bearing does.
    """
    bins = counts.size - 1
    for k in range(bins + 1):
        counts[k] = 0
    for i in range(n):
        span = abs(z[i]) + abs(y[i])
        turn = y[i] / span if span > 0.0 else 0.0
        if z[i] < 0.0:
            turn = 2.0 - turn
        elif turn < 0.0:
            turn += 4.0
        k = min(int(turn * (0.25 * bins)), bins - 1)
        key[i] = k
        counts[k + 1] += 1
    for k in range(bins):
        counts[k + 1] += counts[k]
    for i in range(n):
        k = counts[key[i]]
        counts[key[i]] += 1
        other[0, k] = z[i]
        other[1, k] = y[i]
        other[2, k] = w[i]
        other[3, k] = index[i]
    for i in range(n):
        z[i] = other[0, i]
        y[i] = other[1, i]
        w[i] = other[2, i]
        index[i] = int(other[3, i])


@vector_kernel
def quantile(squares, n, k):
    """Return, to 1 %, the k-th smallest (from 1) of the squares: bisection on counts, which do not branch.

    Squares below 1e-26 count as that; they are in units of the squared rms radius.
    """
    low = 1e-26
    high = 1e12
    for _ in range(14):
        middle = sqrt(low * high)
        count = 0
        for i in range(n):
            count += 1 if squares[i] <= middle else 0
        if count >= k:
            high = middle
        else:
            low = middle
    return high
