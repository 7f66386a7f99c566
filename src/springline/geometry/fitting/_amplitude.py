"""The kernel of `boundary.amplitude_interval`: both ends of the interval, station by station."""

from __future__ import annotations

from math import sqrt

import numpy as np

from springline.geometry.fitting._feet import ellipse_feet
from springline.geometry.fitting._jit import kernel


@kernel
def _excess(amplitude, point, sigmas, table, step, work):
    """Return the distance, in sigmas, from the estimate to the circle of that amplitude, less its critical value."""
    # in units of the sigmas along the principal axes, the circle is an ellipse
    wide, narrow = amplitude / sigmas[1], amplitude / sigmas[0]
    work[0, 2] = 0.5 * (wide + narrow)
    work[0, 3] = 0.5 * (wide - narrow)
    ellipse_feet(point[0:1], point[1:2], 1, work[0], work[1], work[3:8], work[2])
    place = amplitude / sigmas[2] / step
    k = min(int(place), table.size - 2)
    part = min(place - k, 1.0)
    return abs(work[1, 0]) - (table[k] * (1.0 - part) + table[k + 1] * part)


@kernel
def _crossing(inside, outside, point, sigmas, table, step, work):
    """Return the amplitude at which the excess turns positive between one inside the interval and one outside."""
    at_inside = _excess(inside, point, sigmas, table, step, work)
    at_outside = _excess(outside, point, sigmas, table, step, work)
    side = 0
    for _ in range(60):
        if abs(outside - inside) <= 1e-9 * sigmas[0]:
            break
        # regula falsi, with the Illinois halving of the end that stays
        middle = (inside * at_outside - outside * at_inside) / (at_outside - at_inside)
        value = _excess(middle, point, sigmas, table, step, work)
        if value <= 0.0:
            inside, at_inside = middle, value
            if side == 1:
                at_outside *= 0.5
            side = 1
        else:
            outside, at_outside = middle, value
            if side == 2:
                at_inside *= 0.5
            side = 2
        if abs(value) < 1e-8:
            return middle
    return inside


@kernel
def amplitude_ends(vector, covariance, table, step, ends):
    """Write the lower and upper end of each amplitude's interval; `table` holds critical distances every `step`."""
    work = np.zeros((8, 5))
    point = np.empty(2)
    sigmas = np.empty(3)
    for i in range(len(vector)):
        u, v = vector[i, 0], vector[i, 1]
        uu, vv, uv = covariance[i, 0, 0], covariance[i, 1, 1], 0.5 * (covariance[i, 0, 1] + covariance[i, 1, 0])
        half_gap = sqrt(0.25 * (uu - vv) ** 2 + uv * uv)
        large = 0.5 * (uu + vv) + half_gap
        small = (uu * vv - uv * uv) / large
        if not (small > 0.0 and u * u + v * v >= 0.0):
            ends[i] = np.nan
            continue
        # double angle of the wide principal axis
        cos2 = 0.5 * (uu - vv) / half_gap if half_gap > 0.0 else 1.0
        cos = sqrt(max(0.5 * (1.0 + cos2), 0.0))
        sin = sqrt(max(0.5 * (1.0 - cos2), 0.0))
        sin = -sin if uv < 0.0 else sin
        sigmas[0], sigmas[1] = sqrt(large), sqrt(small)
        # first axis of the whitened plane is the narrow one, along which the circle is the longer
        point[0] = (cos * v - sin * u) / sigmas[1]
        point[1] = (cos * u + sin * v) / sigmas[0]
        length = sqrt(u * u + v * v)
        distance = sqrt(point[0] ** 2 + point[1] ** 2)
        # the sigma at which the distance falls as the circle opens: with it the lower end leaves zero smoothly
        slope = sqrt((point[0] / sigmas[1]) ** 2 + (point[1] / sigmas[0]) ** 2)
        sigmas[2] = distance / slope if slope > 0.0 else sigmas[0]
        beyond = length + (table[0] + 0.01) * sigmas[0]
        least = 1e-9 * sigmas[1]
        ends[i, 0] = 0.0
        if distance > table[0]:
            ends[i, 0] = _crossing(length, least, point, sigmas, table, step, work)
        ends[i, 1] = _crossing(max(length, least), beyond, point, sigmas, table, step, work)
