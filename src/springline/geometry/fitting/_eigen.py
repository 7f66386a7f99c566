"""Algebraic fits with a constraint on their coefficients: small eigenproblems of the moments."""

from __future__ import annotations

from math import sqrt

from springline.geometry.fitting._jit import kernel
from springline.geometry.fitting._linalg import factorise, substitute
from springline.geometry.fitting._moments import YY, YYY, YYYY, ZY, ZYY, ZYYY, ZZ, ZZY, ZZYY, ZZZ, ZZZY, ZZZZ, N, Y, Z
from springline.geometry.fitting.options import CIRCLE_METHODS, ELLIPSE_METHODS

UNIT_NORM = CIRCLE_METHODS["svd"]
BOOKSTEIN, GANDER = ELLIPSE_METHODS["bookstein"], ELLIPSE_METHODS["gander"]


@kernel
def _reduce(m, top, cross, low, linear):
    """Reduce the conic's scatter to its quadratic part in `top`; return False when the linear part is singular.

    In the basis (z^2 + y^2)/2, (z^2 - y^2)/2, z y the quadratic coefficients are p = a + c, q = a - c and b. `linear`
    (3, 3) takes them to -(d, e, f), column by column.
    """
    top[0, 0] = 0.25 * (m[ZZZZ] + 2.0 * m[ZZYY] + m[YYYY])
    top[0, 1] = 0.25 * (m[ZZZZ] - m[YYYY])
    top[0, 2] = 0.5 * (m[ZZZY] + m[ZYYY])
    top[1, 1] = 0.25 * (m[ZZZZ] - 2.0 * m[ZZYY] + m[YYYY])
    top[1, 2] = 0.5 * (m[ZZZY] - m[ZYYY])
    top[2, 2] = m[ZZYY]
    cross[0, 0] = 0.5 * (m[ZZZ] + m[ZYY])
    cross[0, 1] = 0.5 * (m[ZZY] + m[YYY])
    cross[0, 2] = 0.5 * (m[ZZ] + m[YY])
    cross[1, 0] = 0.5 * (m[ZZZ] - m[ZYY])
    cross[1, 1] = 0.5 * (m[ZZY] - m[YYY])
    cross[1, 2] = 0.5 * (m[ZZ] - m[YY])
    cross[2, 0] = m[ZZY]
    cross[2, 1] = m[ZYY]
    cross[2, 2] = m[ZY]
    low[0, 0] = m[ZZ]
    low[1, 0] = m[ZY]
    low[1, 1] = m[YY]
    low[2, 0] = m[Z]
    low[2, 1] = m[Y]
    low[2, 2] = m[N]
    if not factorise(low, 3, low):
        return False
    for i in range(3):
        substitute(low, 3, cross[i], linear[i])
    for i in range(3):
        for j in range(i, 3):
            total = top[i, j]
            for k in range(3):
                total -= cross[i, k] * linear[j, k]
            top[i, j] = total
            top[j, i] = total
    return True


@kernel
def _root(s, sign):
    """Return the least root x >= 0 of det(S - x diag(1, sign, sign)) for a positive definite S.

    With sign 1 it is the smallest eigenvalue: Newton from zero climbs to it. With sign -1 it is the only positive root,
    at most S_00: Newton from there descends to it. Both are monotone, because the other roots lie beyond.
    """
    m0 = s[1, 1] * s[2, 2] - s[1, 2] * s[1, 2]
    m1 = s[0, 0] * s[2, 2] - s[0, 2] * s[0, 2]
    m2 = s[0, 0] * s[1, 1] - s[0, 1] * s[0, 1]
    det = (
        s[0, 0] * m0
        - s[0, 1] * (s[0, 1] * s[2, 2] - s[1, 2] * s[0, 2])
        + s[0, 2] * (s[0, 1] * s[1, 2] - s[1, 1] * s[0, 2])
    )
    # det(S - x C) with C = diag(1, sign, sign), C^2 = I
    k1 = -(m0 + sign * (m1 + m2))
    k2 = s[0, 0] + sign * (s[1, 1] + s[2, 2])
    x = 0.0 if sign > 0.0 else s[0, 0]
    for _ in range(60):
        value = det + x * (k1 + x * (k2 - x))
        slope = k1 + x * (2.0 * k2 - 3.0 * x)
        after = x - value / slope
        after = max(after, x) if sign > 0.0 else max(min(after, x), 0.0)
        if not abs(after - x) > 1e-16 * s[0, 0]:
            break
        x = after
    return x


@kernel
def _null_vector(s, shift, sign, x):
    """Write the vector that S - shift diag(1, sign, sign) takes to zero: the longest cross product of its rows."""
    longest = 0.0
    for i in range(3):
        j = (i + 1) % 3
        a0, a1, a2 = s[i, 0], s[i, 1], s[i, 2]
        b0, b1, b2 = s[j, 0], s[j, 1], s[j, 2]
        if i == 0:
            a0 -= shift
            b1 -= sign * shift
        elif i == 1:
            a1 -= sign * shift
            b2 -= sign * shift
        else:
            a2 -= sign * shift
            b0 -= shift
        c0 = a1 * b2 - a2 * b1
        c1 = a2 * b0 - a0 * b2
        c2 = a0 * b1 - a1 * b0
        length = c0 * c0 + c1 * c1 + c2 * c2
        if length > longest:
            longest = length
            x[0], x[1], x[2] = c0, c1, c2
    return longest > 0.0


@kernel
def conic_from_moments(m, method, conic, work):
    """Write the conic (a, b, c, d, e, f) of least algebraic distance into `conic`; return whether there is one.

    With p = a + c and q = a - c, Bookstein's constraint is p^2 + q^2 + b^2 = 2, Fitzgibbon's p^2 - q^2 - b^2 = 1
    (solved as Halir and Flusser do, without the singular part) and Gander's p = 1. `work` (4, 3, 3) is scratch.
    """
    s, linear, x = work[0], work[3], work[1, 0]
    if not _reduce(m, s, work[1], work[2], linear):
        return False
    if method == GANDER:
        det = s[1, 1] * s[2, 2] - s[1, 2] * s[1, 2]
        if not det > 1e-15 * s[1, 1] * s[2, 2]:
            return False
        x[0] = 1.0
        x[1] = (s[1, 2] * s[0, 2] - s[2, 2] * s[0, 1]) / det
        x[2] = (s[1, 2] * s[0, 1] - s[1, 1] * s[0, 2]) / det
    else:
        sign = 1.0 if method == BOOKSTEIN else -1.0
        if not _null_vector(s, _root(s, sign), sign, x):
            return False
    conic[0] = 0.5 * (x[0] + x[1])
    conic[1] = x[2]
    conic[2] = 0.5 * (x[0] - x[1])
    for k in range(3):
        conic[3 + k] = -(linear[0, k] * x[0] + linear[1, k] * x[1] + linear[2, k] * x[2])
    return True


@kernel
def _raw_norm(shift_z, shift_y, scale, t, metric):
    """Write the metric in which scaled coefficients (a, b, c, d) have the norm of the raw ones; `t` is scratch."""
    # rows of the map from the scaled coefficients to the raw ones
    for i in range(4):
        for j in range(4):
            t[i, j] = 0.0
    t[0, 0] = 1.0 / (scale * scale)
    t[1, 0] = -2.0 * shift_z / (scale * scale)
    t[1, 1] = 1.0 / scale
    t[2, 0] = -2.0 * shift_y / (scale * scale)
    t[2, 2] = 1.0 / scale
    t[3, 0] = (shift_z * shift_z + shift_y * shift_y) / (scale * scale)
    t[3, 1] = -shift_z / scale
    t[3, 2] = -shift_y / scale
    t[3, 3] = 1.0
    for i in range(4):
        for j in range(4):
            total = 0.0
            for k in range(4):
                total += t[k, i] * t[k, j]
            metric[i, j] = total


@kernel
def unit_norm_circle(m, shift_z, shift_y, scale, par, work):
    """Write the circle whose coefficients (a, b, c, d) have unit norm in the readings' own frame and unit.

    `m` are moments of (z - shift_z)/scale, (y - shift_y)/scale, in which frame `par` comes too. Returns 1, 0 when the
    readings are collinear and -1 when the inverse iteration does not settle. `work` (4, 4, 4) is scratch.
    """
    scatter, metric, x, before = work[0], work[1], work[2, 0], work[2, 1]
    scatter[0, 0] = m[ZZZZ] + 2.0 * m[ZZYY] + m[YYYY]
    scatter[1, 0] = m[ZZZ] + m[ZYY]
    scatter[2, 0] = m[ZZY] + m[YYY]
    scatter[3, 0] = m[ZZ] + m[YY]
    scatter[1, 1] = m[ZZ]
    scatter[2, 1] = m[ZY]
    scatter[2, 2] = m[YY]
    scatter[3, 1] = m[Z]
    scatter[3, 2] = m[Y]
    scatter[3, 3] = m[N]
    for k in range(4):
        # exact readings make the scatter singular: rounding's own size makes it solvable again
        scatter[k, k] *= 1.0 + 4e-15
    if not factorise(scatter, 4, scatter):
        return 0
    _raw_norm(shift_z, shift_y, scale, work[3], metric)
    x[0], x[1], x[2], x[3] = 1.0, 0.0, 0.0, -1.0
    for _ in range(1000):
        norm = 0.0
        for i in range(4):
            before[i] = x[i]
        for i in range(4):
            total = 0.0
            for k in range(4):
                total += metric[i, k] * before[k]
            x[i] = total
        substitute(scatter, 4, x, x)
        for i in range(4):
            norm = max(norm, abs(x[i]))
        moved = 0.0
        for i in range(4):
            x[i] /= norm
            moved = max(moved, abs(x[i] - before[i]))
        if moved < 1e-13:
            break
    if not moved < 1e-9:
        return -1
    if not abs(x[0]) > 1e-14:
        return 0
    par[0] = -0.5 * x[1] / x[0]
    par[1] = -0.5 * x[2] / x[0]
    square = par[0] * par[0] + par[1] * par[1] - x[3] / x[0]
    if not square > 0.0:
        return 0
    par[2] = sqrt(square)
    return 1
