"""True diameters, ovalities and areas of sections given by many polar radii."""

from __future__ import annotations

from math import cos, hypot, pi, sin

import numpy as np
from numba import njit


def measure(radius: np.ndarray) -> dict[str, np.ndarray]:
    """Return diameters [m], ovalities and area of sections (k, n) given as radii about O at n equal bearings from +z.

    Chords through O, as `/metrics` defines them; the caliper diameter is the perimeter of the convex hull over pi.
    n must be a multiple of 8.

    >>> {name: float(v[0].round(9)) for name, v in measure(np.full((1, 1440), 0.15)).items() if "diameter_c" in name}
    {'diameter_caliper': 0.3}
    """
    n = radius.shape[1]
    chord = radius[:, : n // 2] + radius[:, n // 2 :]
    largest, smallest = _peak(chord), -_peak(-chord)
    area = np.pi * np.square(radius).mean(axis=1)
    # Inscribed polygons fall short by the square of their step: two of them give the curve.
    around = (4.0 * hull_perimeter(radius) - hull_perimeter(radius[:, ::2])) / 3.0
    out = {
        "diameter_max": largest,
        "diameter_min": smallest,
        "diameter_x": chord[:, 0],
        "diameter_y": chord[:, n // 4],
        "diameter_axes": 0.5 * (largest + smallest),
        "diameter_polar": 2.0 * radius.mean(axis=1),
        "diameter_area": 2.0 * np.sqrt(area / np.pi),
        "diameter_caliper": around / np.pi,
        "area": area,
    }
    for name in ("axes", "polar", "area", "caliper"):
        mean = out[f"diameter_{name}"]
        out[f"ovality_{name}"] = (largest - mean) / mean
    return out


def _peak(chord: np.ndarray) -> np.ndarray:
    """Return the largest chord: the top of the parabola through the largest one and its two neighbours."""
    rows = np.arange(len(chord))
    k = np.argmax(chord, axis=1)
    left, top, right = (chord[rows, (k + step) % chord.shape[1]] for step in (-1, 0, 1))
    bend = left - 2.0 * top + right
    rise = (left - right) ** 2 / np.where(bend < 0.0, -8.0 * bend, np.inf)
    # Where a hinge makes a corner of the chords it is no parabola's top, and a sample stands on the hinge itself.
    corner = np.abs(left - right) < 1e-9 * top
    return top + np.where(corner, 0.0, rise)


@njit(cache=True)
def hull_perimeter(radius):
    """Return the perimeter [m] (k,) of the convex hull of sections (k, n) given at n equal bearings from +z."""
    count, n = radius.shape
    out = np.zeros(count)
    z, y = np.empty(n), np.empty(n)
    kept = np.empty(n + 1, np.int64)
    for i in range(count):
        far = 0
        for j in range(n):
            z[j] = radius[i, j] * cos(2.0 * pi * j / n)
            y[j] = radius[i, j] * sin(2.0 * pi * j / n)
            if z[j] > z[far]:
                far = j
        # From a point of the hull, once round in order of bearing, dropping whatever lies inside.
        size = 0
        for step in range(n + 1):
            j = (far + step) % n
            while size >= 2:
                a, b = kept[size - 2], kept[size - 1]
                if (z[b] - z[a]) * (y[j] - y[a]) > (y[b] - y[a]) * (z[j] - z[a]):
                    break
                size -= 1
            kept[size] = j
            size += 1
        for m in range(size - 1):
            out[i] += hypot(z[kept[m + 1]] - z[kept[m]], y[kept[m + 1]] - y[kept[m]])
    return out
