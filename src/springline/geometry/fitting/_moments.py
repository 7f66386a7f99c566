"""Moments of the readings up to degree four, and the circles that follow from them alone."""

from __future__ import annotations

from math import sqrt

from springline.geometry.fitting._jit import kernel, vector_kernel
from springline.geometry.fitting.options import CIRCLE_METHODS

# the fifteen sums of w z^i y^j, named by their factors
(N, Z, Y, ZZ, ZY, YY, ZZZ, ZZY, ZYY, YYY, ZZZZ, ZZZY, ZZYY, ZYYY, YYYY) = range(15)

KASA, PRATT, TAUBIN = CIRCLE_METHODS["kasa"], CIRCLE_METHODS["pratt"], CIRCLE_METHODS["taubin"]


@vector_kernel
def add_moments(z, y, w, first, last, out):
    """Write the moments of readings first to last - 1 into `out`."""
    n = mz = my = mzz = mzy = myy = mzzz = mzzy = mzyy = myyy = 0.0
    m40 = m31 = m22 = m13 = m04 = 0.0
    for i in range(first, last):
        a = z[i]
        b = y[i]
        wi = w[i]
        wa = wi * a
        wb = wi * b
        aa = a * a
        ab = a * b
        bb = b * b
        n += wi
        mz += wa
        my += wb
        mzz += wa * a
        mzy += wa * b
        myy += wb * b
        mzzz += wa * aa
        mzzy += wb * aa
        mzyy += wa * bb
        myyy += wb * bb
        m40 += wi * aa * aa
        m31 += wi * aa * ab
        m22 += wi * ab * ab
        m13 += wi * ab * bb
        m04 += wi * bb * bb
    out[N] = n
    out[Z] = mz
    out[Y] = my
    out[ZZ] = mzz
    out[ZY] = mzy
    out[YY] = myy
    out[ZZZ] = mzzz
    out[ZZY] = mzzy
    out[ZYY] = mzyy
    out[YYY] = myyy
    out[ZZZZ] = m40
    out[ZZZY] = m31
    out[ZZYY] = m22
    out[ZYYY] = m13
    out[YYYY] = m04


@kernel
def circle_from_moments(m, method, par):
    """Write the Kasa, Pratt or Taubin circle (z, y, radius) into `par`; return whether there is one.

    With q = z^2 + y^2 about the centroid, all three centres solve (S - x I) c = (mean zq, mean yq)/2, where S is the
    covariance; x = 0 is Kasa, and Pratt's and Taubin's x is the smallest root of a quartic or cubic, found by
    Newton's steps from zero, which are monotone (Chernov 2010, sections 5.5 and 5.8).
    """
    n = m[N]
    cz = m[Z] / n
    cy = m[Y] / n
    c2 = cz * cz + cy * cy
    zz = m[ZZ] / n - cz * cz
    zy = m[ZY] / n - cz * cy
    yy = m[YY] / n - cy * cy
    # raw moments with q, then about the centroid: q' = q - 2 c.p + c^2
    q = (m[ZZ] + m[YY]) / n
    zq = (m[ZZZ] + m[ZYY]) / n
    yq = (m[ZZY] + m[YYY]) / n
    qq = (m[ZZZZ] + 2.0 * m[ZZYY] + m[YYYY]) / n
    spread = zz + yy
    sz = zq - cz * q - 2.0 * (cz * zz + cy * zy)
    sy = yq - cy * q - 2.0 * (cz * zy + cy * yy)
    # E q'^2 = E (q - 2 c.p + c^2)^2
    cp2 = cz * cz * (m[ZZ] / n) + 2.0 * cz * cy * (m[ZY] / n) + cy * cy * (m[YY] / n)
    ss = qq + 4.0 * cp2 + c2 * c2 - 4.0 * (cz * zq + cy * yq) + 2.0 * c2 * q - 4.0 * c2 * c2
    det = zz * yy - zy * zy
    x = 0.0
    if method != KASA:
        variance = ss - spread * spread
        a0 = sz * (sz * yy - sy * zy) + sy * (sy * zz - sz * zy) - variance * det
        a1 = variance * spread + 4.0 * det * spread - sz * sz - sy * sy
        a2 = -3.0 * spread * spread - ss
        a3 = 4.0 * spread
        a4 = 0.0
        if method == PRATT:
            a2 += 4.0 * det
            a3 = 0.0
            a4 = 4.0
        value = a0
        for _ in range(50):
            slope = a1 + x * (2.0 * a2 + x * (3.0 * a3 + 4.0 * x * a4))
            after = x - value / slope
            if not (after >= 0.0 and after != x):
                break
            value_after = a0 + after * (a1 + after * (a2 + after * (a3 + after * a4)))
            if abs(value_after) >= abs(value):
                break
            x = after
            value = value_after
    bottom = det - x * spread + x * x
    if not abs(bottom) > 1e-28:
        return False
    dz = 0.5 * (sz * (yy - x) - sy * zy) / bottom
    dy = 0.5 * (sy * (zz - x) - sz * zy) / bottom
    par[0] = cz + dz
    par[1] = cy + dy
    par[2] = sqrt(dz * dz + dy * dy + spread + (2.0 * x if method == PRATT else 0.0))
    return True


@kernel
def ellipse_of_conic(conic, par):
    """Write (z, y, m, u, v) of the ellipse that `conic` is into `par`; return False when it is none."""
    a, b, c, d, e, f = conic[0], conic[1], conic[2], conic[3], conic[4], conic[5]
    if a + c < 0.0:
        a, b, c, d, e, f = -a, -b, -c, -d, -e, -f
    det = 4.0 * a * c - b * b
    if not det > 1e-14 * (a + c) ** 2:
        return False
    cz = (b * e - 2.0 * c * d) / det
    cy = (b * d - 2.0 * a * e) / det
    level = -(f + 0.5 * (d * cz + e * cy))
    if not level > 0.0:
        return False
    gap = sqrt((a - c) ** 2 + b * b)
    large = 0.5 * (a + c + gap)
    small = 0.25 * det / large
    major = sqrt(level / small)
    minor = sqrt(level / large)
    half = 0.5 * (major - minor)
    par[0] = cz
    par[1] = cy
    par[2] = 0.5 * (major + minor)
    par[3] = -half * (a - c) / gap if gap > 0.0 else 0.0
    par[4] = -half * b / gap if gap > 0.0 else 0.0
    return True
