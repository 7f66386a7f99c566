"""Feet of the readings on a circle or an ellipse: exact orthogonal distances and their derivatives."""

from __future__ import annotations

from math import sqrt

from springline.geometry.fitting._jit import vector_kernel


@vector_kernel
def circle_feet(z, y, n, par, distance, jacobian):
    """Write the signed distances (positive outside) to the circle `par` = (z, y, radius), and their derivatives.

    Row k of `jacobian` holds n . dx/dpar_k, the outward motion of the wall at the foot, for each reading.
    """
    cz, cy, radius = par[0], par[1], par[2]
    for i in range(n):
        dz = z[i] - cz
        dy = y[i] - cy
        rho = sqrt(dz * dz + dy * dy) + 1e-300
        distance[i] = rho - radius
        jacobian[0, i] = dz / rho
        jacobian[1, i] = dy / rho
        jacobian[2, i] = 1.0


@vector_kernel
def ellipse_feet(z, y, n, par, distance, jacobian, foot):
    """Write the signed distances to the ellipse `par` = (z, y, m, u, v), positive outside, and their derivatives.

    The ellipse is c + m exp(i psi) + (u + i v) exp(-i psi) in the plane z + i y, which is regular at the circle.
    In its own axes e0 >= e1 the foot of (q0, q1) is (e0^2 q0/(s + D), e1^2 q1/s), D = e0^2 - e1^2, where s > 0 solves
    (e0 q0/(s + D))^2 + (e1 q1/s)^2 = 1. The inverse root of the left side is increasing and concave in s, so Newton's
    step from anywhere lands left of the solution, and from there on the steps are monotone; clamped to the lower
    bound the iteration is safe for every reading, and it is exact after one step on a circle.
    """
    cz, cy, mean, u, v = par[0], par[1], par[2], par[3], par[4]
    half = sqrt(u * u + v * v)
    e0, e1 = mean + half, mean - half
    cos2 = u / half if half > 0.0 else 1.0
    # half angle without a transcendental; the branch keeps the root away from cancellation
    if cos2 > 0.0:
        ca = sqrt(0.5 * (1.0 + cos2))
        sa = 0.5 * (v / half) / ca if half > 0.0 else 0.0
    else:
        sa = sqrt(0.5 * (1.0 - cos2))
        ca = 0.5 * (v / half) / sa
    gap = e0 * e0 - e1 * e1
    tiny = 1e-14 * e1
    for i in range(n):
        dz, dy = z[i] - cz, y[i] - cy
        q0, q1 = ca * dz + sa * dy, ca * dy - sa * dz
        ratio = sqrt((q0 / e0) ** 2 + (q1 / e1) ** 2)
        # along the ray from the centre; exact on a circle
        foot[i] = max(e0 * e1 * (ratio - 1.0) + e1 * e1, tiny * e1)
    for _ in range(60):
        moved = 0.0
        for i in range(n):
            dz, dy = z[i] - cz, y[i] - cy
            q0 = abs(ca * dz + sa * dy) * e0
            q1 = max(abs(ca * dy - sa * dz), tiny) * e1
            low = max(q1, q0 - gap)
            s = max(foot[i], low)
            g0 = q0 / (s + gap)
            g1 = q1 / s
            g0 *= g0
            g1 *= g1
            q = g0 + g1
            after = max(s + q * (sqrt(q) - 1.0) / (g0 / (s + gap) + g1 / s), low)
            step = (after - s) / s
            moved += step * step
            foot[i] = after
        if moved <= 1e-14:
            # convergence is quadratic: a last step of 1e-7 leaves rounding only
            break
    for i in range(n):
        dz, dy = z[i] - cz, y[i] - cy
        q0, q1 = ca * dz + sa * dy, ca * dy - sa * dz
        q1 = q1 if abs(q1) > tiny else tiny
        s = foot[i]
        p0, p1 = q0 / (s + gap), q1 / s
        norm = sqrt(p0 * p0 + p1 * p1)
        distance[i] = (s - e1 * e1) * norm
        n0, n1 = p0 / norm, p1 / norm
        nz, ny = ca * n0 - sa * n1, sa * n0 + ca * n1
        cos, sin = e0 * p0, e1 * p1
        cos_psi, sin_psi = ca * cos - sa * sin, sa * cos + ca * sin
        jacobian[0, i] = nz
        jacobian[1, i] = ny
        jacobian[2, i] = nz * cos_psi + ny * sin_psi
        jacobian[3, i] = nz * cos_psi - ny * sin_psi
        jacobian[4, i] = nz * sin_psi + ny * cos_psi
