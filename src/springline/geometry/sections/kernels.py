"""Compiled kernels of the hinged sections: constant-perimeter axes, the ray to a swung quarter arc, its derivatives.

A quarter arc is a quarter of the ellipse with semi-axes a >= b, swung by alpha so that its springline end stays on the
z axis and its crown end B on the y axis at height s. In the arc's own frame (the top-left one, turned back by alpha)
B is (0, b) and O is (s sin alpha, b - s cos alpha), so the ray from O at the folded bearing psi meets the arc where

    A t^2 + 2 B t + C = 0,   C = s [s (sin^2 alpha / a^2 + cos^2 alpha / b^2) - 2 cos alpha / b] <= 0,

with C free of cancellation even where the crown nearly touches O. All lengths here are in units of the pipe's r.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

TWO_PI = 2.0 * math.pi


@njit(cache=True, error_model="numpy")
def ellipse_integrals(q):
    """Return E(m) and D(m) = (K - E)/m for m = 1 - q^2, 0 < q <= 1, by the arithmetic-geometric mean."""
    mean, other = 1.0, q
    gap2 = 0.25 * (1.0 - q) ** 2
    ratio = 0.25 * (1.0 - q) / (1.0 + q)  # gap^2 / m, which stays defined at the circle
    total, power = 0.0, 1.0
    for _ in range(60):
        mean, other = 0.5 * (mean + other), math.sqrt(mean * other)
        total += power * ratio
        if gap2 <= 1e-17 * mean * mean:
            break
        shrink = gap2 / (2.0 * (mean + other)) ** 2
        gap2, ratio, power = gap2 * shrink, ratio * shrink, 2.0 * power
    complete = 0.5 * math.pi / mean
    d = complete * (0.5 + total)
    return complete - (1.0 - q * q) * d, d


@njit(cache=True, error_model="numpy")
def perimeter_slopes(x, y):
    """Return the perimeter of the ellipse with semi-axes x, y and its derivatives by x and by y."""
    large, small = max(x, y), min(x, y)
    q = small / large
    e, d = ellipse_integrals(q)
    by_large, by_small = 4.0 * (e - q * q * d), 4.0 * q * d
    if x >= y:
        return 4.0 * large * e, by_large, by_small
    return 4.0 * large * e, by_small, by_large


@njit(cache=True, error_model="numpy")
def other_axis(x, exact):
    """Return the semi-axis that belongs to the semi-axis x at perimeter 2 pi, and its derivative by x.

    Ramanujan's first approximation gives the closed form of (3.2); the exact rule starts from it, corrects it by the
    second approximation and finishes with Newton's method on the exact perimeter.
    """
    root2 = 3.0 + 6.0 * x - 5.0 * x * x
    if root2 < 0.0:
        return np.nan, np.nan
    root = math.sqrt(root2)
    y = (3.0 - 2.0 * x + root) / 3.0
    if not exact:
        return y, (-2.0 + (3.0 - 5.0 * x) / root) / 3.0
    if x > 0.5 * math.pi:
        return np.nan, np.nan
    if x == 0.5 * math.pi:
        return 0.0, -np.inf
    y = _second_approximation(x, max(y, 1e-3))
    for _ in range(80):
        p, by_x, by_y = perimeter_slopes(x, y)
        step = (TWO_PI - p) / by_y
        y += step
        if y <= 0.0:
            y = 0.5 * (y - step)
        elif abs(step) <= 1e-8 * y:
            break
    return y, -by_x / by_y


@njit(cache=True, error_model="numpy")
def _second_approximation(x, y):
    total = x + y
    h = ((x - y) / total) ** 2
    p = math.pi * total * (1.0 + 3.0 * h / (10.0 + math.sqrt(4.0 - 3.0 * h)))
    slope = math.pi * (3.0 - (3.0 * y + 5.0 * x) / math.sqrt((3.0 * x + y) * (x + 3.0 * y)))
    better = y + (TWO_PI - p) / slope
    return better if better > 0.0 else y


@njit(cache=True, error_model="numpy")
def other_axes(x, exact):
    """Return `other_axis` for every element of a flat array."""
    out = np.empty_like(x)
    for i in range(x.size):
        out[i] = other_axis(x[i], exact)[0]
    return out


@njit(cache=True, error_model="numpy")
def _ray(c, v, a, b, s, sin_a, cos_a):
    """Return the length of the ray with folded direction (-c, v), and where it ends in the arc's frame."""
    ux, uy = -cos_a * c - sin_a * v, cos_a * v - sin_a * c
    px, py = s * sin_a, b - s * cos_a
    ex, ey = ux / a, uy / b
    square = ex * ex + ey * ey
    half = (px / a) * ex + (py / b) * ey
    constant = s * (s * ((sin_a / a) ** 2 + (cos_a / b) ** 2) - 2.0 * cos_a / b)
    root = math.sqrt(max(half * half - square * constant, 0.0))
    if half < 0.0:
        t = (root - half) / square
    elif root + half == 0.0:
        t = 0.0
    else:
        t = -constant / (root + half)
    return t, px + t * ux, py + t * uy, ux, uy


@njit(cache=True, error_model="numpy")
def polar(bearing, hinges, radius, slope, curvature):
    """Fill radius, slope dr/dtheta and curvature of hinged sections of unit r.

    Args:
        bearing: (N or 1, M) [rad].
        hinges: (N, 10): a, b, s, sin alpha, cos alpha of the top, then of the bottom quarter arcs.
        radius, slope, curvature: (N, M) outputs; the last two are left alone when they have no columns.
    """
    sections, bearings = radius.shape
    shared = bearing.shape[0] == 1
    wanted = slope.shape[1] > 0
    for i in range(sections):
        row = 0 if shared else i
        for j in range(bearings):
            cos, sin = math.cos(bearing[row, j]), math.sin(bearing[row, j])
            k = 0 if sin >= 0.0 else 5
            a, b = hinges[i, k], hinges[i, k + 1]
            s, sin_a, cos_a = hinges[i, k + 2], hinges[i, k + 3], hinges[i, k + 4]
            c, v = abs(cos), abs(sin)
            t, x, y, ux, uy = _ray(c, v, a, b, s, sin_a, cos_a)
            radius[i, j] = t
            if wanted:
                nx, ny = x / (a * a), y / (b * b)
                turned_x, turned_y = cos_a * v - sin_a * c, sin_a * v + cos_a * c
                # where the crown lies on O the radius is zero on all bearings up to the knee
                folded = 0.0 if t == 0.0 else -t * (nx * turned_x + ny * turned_y) / (nx * ux + ny * uy)
                slope[i, j] = folded if (cos >= 0.0) == (sin >= 0.0) else -folded
                curvature[i, j] = 1.0 / (a * a * b * b * (nx * nx + ny * ny) ** 1.5)


@njit(cache=True, error_model="numpy")
def _knee(a, b, s, sin_a, cos_a):
    """Return the folded bearing at which the ray leaves the dip beside the crown: where B = 0.

    On one side of it the ray ends soon, on the other far away; as s falls to 0 the radius gets a kink there.
    """
    px, py = s * sin_a / (a * a), (b - s * cos_a) / (b * b)
    knee = math.atan2(cos_a * px + sin_a * py, cos_a * py - sin_a * px)
    return min(max(knee, 0.0), 0.5 * math.pi)


@njit(cache=True, error_model="numpy")
def knees(hinges, out):
    """Fill (N, 2): the folded bearing of the knee of the top and of the bottom quarter arcs."""
    for i in range(out.shape[0]):
        for half in range(2):
            k = 5 * half
            out[i, half] = _knee(hinges[i, k], hinges[i, k + 1], hinges[i, k + 2], hinges[i, k + 3], hinges[i, k + 4])


@njit(cache=True, error_model="numpy")
def mean_radius(hinges, node, weight, out):
    """Fill the mean over bearing of the polar radius; node and weight are a rule on [0, 1]."""
    for i in range(out.size):
        total = 0.0
        for k in (0, 5):
            a, b, s = hinges[i, k], hinges[i, k + 1], hinges[i, k + 2]
            sin_a, cos_a = hinges[i, k + 3], hinges[i, k + 4]
            knee = _knee(a, b, s, sin_a, cos_a)
            for low, high in ((0.0, knee), (knee, 0.5 * math.pi)):
                part = 0.0
                for j in range(node.size):
                    psi = low + (high - low) * node[j]
                    part += weight[j] * _ray(math.cos(psi), math.sin(psi), a, b, s, sin_a, cos_a)[0]
                total += (high - low) * part
        out[i] = total / math.pi


@njit(cache=True, error_model="numpy")
def _half(s0, s, exact):
    """Return a, b, s, sin alpha, cos alpha, OA and da/ds0 of the quarter arc of severity s0 swung to s."""
    a, by_s0 = other_axis(s0, exact)
    square = a * a + s0 * s0
    axis = math.sqrt(square - s * s)
    return a, s0, s, (s0 * axis - a * s) / square, (a * axis + s0 * s) / square, axis, by_s0


@njit(cache=True, error_model="numpy")
def _top(low, s1, s02, s01, exact):
    """Return a, b, s, sin alpha, cos alpha and da/ds0 of the top arc that shares the springline of the bottom `low`."""
    a, by_s02 = other_axis(s02, exact) if s02 != s01 else (low[0], low[6])
    square = a * a + s02 * s02
    s2 = math.sqrt(square - low[0] ** 2 - s01 * s01 + s1 * s1)
    return a, s02, s2, (s02 * low[5] - a * s2) / square, (a * low[5] + s02 * s2) / square, by_s02


@njit(cache=True, error_model="numpy")
def hinge_table(s1, s02, s01, exact, out):
    """Fill (N, 12): the ten columns of `polar`, then OA and s2 = the top's s, from flat arrays of severities.

    The severities are valid; where rounding makes s2 leave [0, s02] it is brought back.
    """
    for i in range(s1.size):
        low = _half(s01[i], s1[i], exact)
        a = other_axis(s02[i], exact)[0] if s02[i] != s01[i] else low[0]
        square = a * a + s02[i] ** 2
        s2 = min(math.sqrt(max(square - low[0] ** 2 - s01[i] ** 2 + s1[i] ** 2, 0.0)), s02[i])
        out[i, 0], out[i, 1], out[i, 2] = a, s02[i], s2
        out[i, 3] = (s02[i] * low[5] - a * s2) / square
        out[i, 4] = (a * low[5] + s02[i] * s2) / square
        for k in range(5):
            out[i, 5 + k] = low[k]
        out[i, 10], out[i, 11] = low[5], s2


@njit(cache=True, error_model="numpy")
def radius_of(bearing, parameters, exact, radius):
    """Fill radius (N, M) from bearings (N or 1, M) and parameters (N, 4): r, s1, s02, s01; NaN where there is none."""
    sections, bearings = radius.shape
    shared = bearing.shape[0] == 1
    for i in range(sections):
        row = 0 if shared else i
        r, s1, s02, s01 = parameters[i, 0], parameters[i, 1], parameters[i, 2], parameters[i, 3]
        low = _half(s01, s1, exact)
        top = _top(low, s1, s02, s01, exact)
        for j in range(bearings):
            cos, sin = math.cos(bearing[row, j]), math.sin(bearing[row, j])
            c, v = abs(cos), abs(sin)
            if sin >= 0.0:
                radius[i, j] = r * _ray(c, v, top[0], top[1], top[2], top[3], top[4])[0]
            else:
                radius[i, j] = r * _ray(c, v, low[0], low[1], low[2], low[3], low[4])[0]


@njit(cache=True, error_model="numpy")
def _ray_slopes(c, v, a, b, s, sin_a, cos_a, axis, by_s0):
    """Return the ray's length and its derivatives by s0 and by s of its half, both with the other one held."""
    t, x, y, ux, uy = _ray(c, v, a, b, s, sin_a, cos_a)
    nx, ny = x / (a * a), y / (b * b)
    down = -1.0 / (nx * ux + ny * uy)
    by_alpha = down * (nx * (s * cos_a - t * uy) + ny * (s * sin_a + t * ux))
    by_a = down * (-nx * x / a) + by_alpha * (s * a / axis - b) / (a * a + b * b)
    by_b = down * (-ny * y / b + ny) + by_alpha * (a + s * b / axis) / (a * a + b * b)
    by_s = down * (nx * sin_a - ny * cos_a) - by_alpha / axis
    return t, by_a * by_s0 + by_b, by_s


@njit(cache=True, error_model="numpy")
def radius_and_jacobian(bearing, parameters, exact, radius, jacobian):
    """Fill radius (N, M) and its derivatives (N, M, 4) by r, s1, s02, s01; nothing is clamped, invalid gives NaN.

    Args:
        bearing: (N or 1, M) [rad].
        parameters: (N, 4): r, s1, s02, s01.
    """
    sections, bearings = radius.shape
    shared = bearing.shape[0] == 1
    for i in range(sections):
        row = 0 if shared else i
        r, s1, s02, s01 = parameters[i, 0], parameters[i, 1], parameters[i, 2], parameters[i, 3]
        a, b, s, sin_a, cos_a, axis, by_s01 = _half(s01, s1, exact)
        a2, _, s2, sin_2, cos_2, by_s02 = _top((a, b, s, sin_a, cos_a, axis, by_s01), s1, s02, s01, exact)
        s2_by_s1 = s1 / s2
        s2_by_s02 = (a2 * by_s02 + s02) / s2
        s2_by_s01 = -(a * by_s01 + b) / s2
        for j in range(bearings):
            cos, sin = math.cos(bearing[row, j]), math.sin(bearing[row, j])
            c, v = abs(cos), abs(sin)
            if sin >= 0.0:
                t, by_s0, by_s = _ray_slopes(c, v, a2, s02, s2, sin_2, cos_2, axis, by_s02)
                jacobian[i, j, 1] = r * by_s * s2_by_s1
                jacobian[i, j, 2] = r * (by_s0 + by_s * s2_by_s02)
                jacobian[i, j, 3] = r * by_s * s2_by_s01
            else:
                t, by_s0, by_s = _ray_slopes(c, v, a, b, s, sin_a, cos_a, axis, by_s01)
                jacobian[i, j, 1] = r * by_s
                jacobian[i, j, 2] = 0.0
                jacobian[i, j, 3] = r * by_s0
            radius[i, j] = r * t
            jacobian[i, j, 0] = t


@njit(cache=True, error_model="numpy")
def hull_length(z, y, length, out):
    """Fill the convex hull's perimeter of star-shaped curves given by samples, by Graham's scan from the farthest one.

    Args:
        z, y: (N, M): samples in order of bearing.
        length: (N, M): the curve's length from each sample to the next.
    """
    sections, every = z.shape
    solid, kept = np.empty(every, np.int64), np.empty(every + 1, np.int64)
    for i in range(sections):
        samples, first, farthest = 0, 0, -1.0
        for j in range(every):
            if length[i, j] > 0.0:  # a sample on top of the next one says nothing
                reach = z[i, j] ** 2 + y[i, j] ** 2
                if reach > farthest:
                    first, farthest = samples, reach
                solid[samples] = j
                samples += 1
        if samples == 0:
            out[i] = np.nan
            continue
        top = 0
        for step in range(samples + 1):
            place = (first + step) % samples
            j = solid[place]
            while top > 1:
                k, m = solid[kept[top - 1]], solid[kept[top - 2]]
                turn = (z[i, k] - z[i, m]) * (y[i, j] - y[i, k]) - (y[i, k] - y[i, m]) * (z[i, j] - z[i, k])
                if turn > 0.0:
                    break
                top -= 1
            kept[top] = place
            top += 1
        total = 0.0
        for n in range(top - 1):
            j, k = solid[kept[n]], solid[kept[n + 1]]
            if (kept[n + 1] - kept[n]) % samples == 1:
                total += length[i, j]
            else:
                total += math.hypot(z[i, k] - z[i, j], y[i, k] - y[i, j])
        out[i] = total
