"""From the readings of a ring to the quadratic form of its misfit in the coefficients of both halves."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from springline.geometry.fitting._linalg import factorise, invert, substitute

LOOSE = 4
"""Nuisances taken out of every ring: shift to the right, shift up, size, small turn."""

_ITERATIONS = 6
_TUKEY = 4.685
_KEPT = 3.5
_RIDGE = 1e-7


@njit(cache=True, nogil=True, error_model="numpy")
def fill_design(z, y, centre_z, centre_y, radius, oval, shapes, design, half, value):
    """Fill one row per reading about a point, in units of a radius; return how many readings there are.

    Args:
        z, y: Readings [m]; NaN = no return.
        centre_z, centre_y, radius: The point and the radius [m].
        oval: Half difference of the semi-axes over the radius, for the effect of a turn.
        shapes: (shape, node) of `HalfTable`.
        design: (reading, shape + LOOSE) output: the shapes at the reading, then the effect of each nuisance.
        half: (reading,) output: first coefficient of the half that the reading lies in.
        value: (reading,) output: radius about the point, less 1.
    """
    kinds, nodes = shapes.shape
    count = 0
    for i in range(z.size):
        dz, dy = z[i] - centre_z, y[i] - centre_y
        distance = math.hypot(dz, dy)
        if not distance > 0.0:
            continue
        place = math.atan2(abs(dy), abs(dz)) * (nodes - 1) / (0.5 * math.pi)
        node = min(int(place), nodes - 2)
        share = place - node
        for k in range(kinds):
            design[count, k] = (1.0 - share) * shapes[k, node] + share * shapes[k, node + 1]
        cos, sin = dz / distance, dy / distance
        design[count, kinds] = cos
        design[count, kinds + 1] = sin
        design[count, kinds + 2] = 1.0
        design[count, kinds + 3] = -4.0 * oval * sin * cos
        half[count] = 0 if dy >= 0.0 else kinds
        value[count] = distance / radius - 1.0
        count += 1
    return count


@njit(cache=True, nogil=True, error_model="numpy")
def normal_equations(design, half, value, weight, loose):
    """Return the weighted normal matrix, right side and square sum of both halves and `loose` nuisances."""
    count, kinds = value.size, design.shape[1] - LOOSE
    both = 2 * kinds
    gram, moment, square = np.zeros((both + loose, both + loose)), np.zeros(both + loose), 0.0
    for i in range(count):
        w = weight[i]
        if w > 0.0:
            square += w * value[i] * value[i]
            first = half[i]
            for p in range(kinds + loose):
                at = first + p if p < kinds else kinds + p
                wp = w * design[i, p]
                moment[at] += wp * value[i]
                for q in range(p + 1):
                    gram[at, first + q if q < kinds else kinds + q] += wp * design[i, q]
    for p in range(both + loose):
        for q in range(p):
            gram[q, p] = gram[p, q]
    return gram, moment, square


@njit(cache=True, nogil=True, error_model="numpy")
def reject_outliers(design, half, value, weight):
    """Set the weight of outliers about a free shape to 0, of others to 1; return the readings' noise and the misfit.

    The free shape has every coefficient of both halves and a shift to the right: whatever mode a ring shows, its
    readings scatter about this shape by their noise alone.

    Args:
        design, half, value: As `fill_design` makes them.
        weight: (reading,) in: where to start from; out: 0 or 1.

    Returns:
        One-sigma of a reading over the radius, readings used, sum of squared residuals of the used ones.
    """
    count, kinds = value.size, design.shape[1] - LOOSE
    width = 2 * kinds + 1
    residual = np.empty(count)
    low, free = np.empty((width, width)), np.empty(width)
    scale = 0.0
    for _ in range(_ITERATIONS):
        gram, moment, _square = normal_equations(design, half, value, weight, 1)
        total = weight.sum()
        for p in range(width):
            gram[p, p] += _RIDGE * total
        factorise(gram, width, low)
        substitute(low, width, moment, free)
        for i in range(count):
            residual[i] = value[i] - design[i, kinds] * free[2 * kinds]
            for p in range(kinds):
                residual[i] -= design[i, p] * free[half[i] + p]
        scale = 1.4826 * np.median(np.abs(residual)) + 1e-12
        for i in range(count):
            u = residual[i] / (_TUKEY * scale)
            weight[i] = (1.0 - u * u) ** 2 if abs(u) < 1.0 else 0.0
    used, square = 0, 0.0
    for i in range(count):
        if abs(residual[i]) < _KEPT * scale:
            weight[i] = 1.0
            used += 1
            square += residual[i] ** 2
        else:
            weight[i] = 0.0
    return math.sqrt(square / max(used - width, 1)), used, square


@njit(cache=True, nogil=True, error_model="numpy")
def neighbour_noise(value):
    """Return the one-sigma of a reading from second differences of neighbours, whatever smooth shape they lie on."""
    if value.size < 8:
        return np.nan
    bend = np.abs(value[:-2] - 2.0 * value[1:-1] + value[2:])
    return np.median(bend) / (0.6744897501960817 * math.sqrt(6.0))


@njit(cache=True, nogil=True, error_model="numpy")
def quadratic_form(design, half, value, weight, noise, turn_sigma):
    """Return form, line and constant of the misfit c.form.c - 2 line.c + constant, nuisances taken out.

    Args:
        design, half, value, weight: As above.
        noise: One-sigma of a reading over the radius.
        turn_sigma: One-sigma of the turn about the pipe's axis [rad]; shifts and size are free.
    """
    gram, moment, square = normal_equations(design, half, value, weight, LOOSE)
    both = gram.shape[0] - LOOSE
    gram[both + 3, both + 3] += (noise / turn_sigma) ** 2
    for k in range(LOOSE):
        gram[both + k, both + k] += 1e-12 * weight.sum()
    low, inverse = np.empty((LOOSE, LOOSE)), np.empty((LOOSE, LOOSE))
    factorise(gram[both:, both:], LOOSE, low)
    invert(low, LOOSE, inverse)
    scale = 1.0 / (noise * noise)
    form, line = np.empty((both, both)), np.empty(both)
    taken = np.empty(LOOSE)
    for p in range(both + 1):
        for k in range(LOOSE):
            taken[k] = 0.0
            for m in range(LOOSE):
                taken[k] += inverse[k, m] * (gram[p, both + m] if p < both else moment[both + m])
        if p < both:
            line[p] = moment[p]
            for k in range(LOOSE):
                line[p] -= taken[k] * moment[both + k]
            line[p] *= scale
            for q in range(both):
                form[p, q] = gram[p, q]
                for k in range(LOOSE):
                    form[p, q] -= taken[k] * gram[q, both + k]
                form[p, q] *= scale
        else:
            for k in range(LOOSE):
                square -= taken[k] * moment[both + k]
    return form, line, square * scale


@njit(cache=True, nogil=True, error_model="numpy")
def shift_and_size(design, half, value, weight, coefficients):
    """Return the shift (z, y) and the relative size that bring a section with these coefficients to the readings."""
    kinds = design.shape[1] - LOOSE
    normal, right, row, low = np.zeros((3, 3)), np.zeros(3), np.empty(3), np.empty((3, 3))
    for i in range(value.size):
        if weight[i] > 0.0:
            model = 1.0
            for k in range(kinds):
                model += coefficients[half[i] + k] * design[i, k]
            row[0], row[1], row[2] = design[i, kinds], design[i, kinds + 1], model
            for p in range(3):
                right[p] += row[p] * (1.0 + value[i] - model)
                for q in range(3):
                    normal[p, q] += row[p] * row[q]
    factorise(normal, 3, low)
    substitute(low, 3, right, row)
    return row
