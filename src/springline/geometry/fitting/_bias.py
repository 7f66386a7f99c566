"""What noise alone does to a geometric fit, to the second order: the mean of the gradient at the true wall.

A reading that errs by e along a direction with the component g to the wall's normal and t along the wall lies at the
distance e g + e^2 t^2 kappa/2 from it, kappa the wall's curvature, and has its foot e t further on, where the
derivatives J are J + J' e t. The gradient J d thus has the mean sigma^2 (J t^2 kappa/2 + J' t g). Solved like the
gradient itself it is the bias of the parameters, about sigma^2/(2 R) for isotropic noise.
"""

from __future__ import annotations

from math import sqrt

from springline.geometry.fitting._jit import vector_kernel


@vector_kernel
def mean_gradient_isotropic(p, omega, n, par, jacobian, out):
    """Write the mean gradient per variance of a reading in any one direction; there g t is zero on average."""
    mean = par[2]
    u = par[3] if p == 5 else 0.0
    v = par[4] if p == 5 else 0.0
    square = mean * mean + u * u + v * v
    product = mean * mean - u * u - v * v
    for k in range(p):
        total = 0.0
        for i in range(n):
            nz = jacobian[0, i]
            ny = jacobian[1, i]
            # the support function h has h^2 = m^2 + d^2 + 2 m d cos 2(normal - phi), and curvature is h^3/(a b)^2
            support2 = square + 2.0 * mean * (u * (nz * nz - ny * ny) + 2.0 * v * nz * ny)
            total += omega[i] * jacobian[k, i] * support2 * sqrt(support2)
        out[k] = 0.5 * total / (product * product)


@vector_kernel
def mean_gradient_along_rays(p, z, y, omega, n, par, jacobian, origin_z, origin_y, out):
    """Write the mean gradient per variance of the distances, for noise along the rays from the origin."""
    mean = par[2]
    u = par[3] if p == 5 else 0.0
    v = par[4] if p == 5 else 0.0
    square = mean * mean + u * u + v * v
    product = mean * mean - u * u - v * v
    weight = normal_part = 0.0
    b0 = b1 = b2 = b3 = b4 = 0.0
    for i in range(n):
        rz = z[i] - origin_z
        ry = y[i] - origin_y
        length = sqrt(rz * rz + ry * ry) + 1e-300
        nz = jacobian[0, i]
        ny = jacobian[1, i]
        g = (rz * nz + ry * ny) / length
        t = (ry * nz - rz * ny) / length
        support2 = square + 2.0 * mean * (u * (nz * nz - ny * ny) + 2.0 * v * nz * ny)
        support = sqrt(support2)
        curvature = support2 * support / (product * product)
        # the foot from its normal, then exp(i psi) = (m x - w conj x)/(m^2 - d^2)
        x = ((square + 2.0 * mean * u) * nz + 2.0 * mean * v * ny) / support
        h = ((square - 2.0 * mean * u) * ny + 2.0 * mean * v * nz) / support
        c = (mean * x - u * x - v * h) / product
        s = (mean * h - v * x + u * h) / product
        turn = 1.0 / sqrt(square - 2.0 * mean * (u * (c * c - s * s) + 2.0 * v * c * s))
        bent = 0.5 * curvature * t * t
        slide = t * g
        b0 += omega[i] * (nz * bent - curvature * ny * slide)
        b1 += omega[i] * (ny * bent + curvature * nz * slide)
        # derivatives along the wall: n turns by the curvature, exp(i psi) by `turn`
        b2 += omega[i] * ((nz * c + ny * s) * bent + (curvature - turn) * (nz * s - ny * c) * slide)
        b3 += omega[i] * ((nz * c - ny * s) * bent - (curvature + turn) * (nz * s + ny * c) * slide)
        b4 += omega[i] * ((nz * s + ny * c) * bent + (curvature + turn) * (nz * c - ny * s) * slide)
        weight += omega[i]
        normal_part += omega[i] * g * g
    # distances vary by the normal part of the readings' own variance
    ratio = weight / normal_part
    out[0] = b0 * ratio
    out[1] = b1 * ratio
    out[2] = b2 * ratio
    if p == 5:
        out[3] = b3 * ratio
        out[4] = b4 * ratio
