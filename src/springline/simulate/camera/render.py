"""One picture's light: rays through a coarse grid, carried over smooth wall, cast one by one where anything begins."""

from __future__ import annotations

from math import isnan, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit, prange

from ..cast import FACE, SECTION, cast_one, gap_at
from ..wall import JOINT, NOTHING, WATER
from .light import CLOSE, light_of
from .surfaces import normal_at

BLOCK = 4
"""Pixels between nodes of the coarse grid."""


class Scene(NamedTuple):
    """What lights a picture and what the wall looks like: records of `looks` and `light`, and the number of each
    cell's pipe."""

    look: np.ndarray
    decals: np.ndarray
    pieces: np.ndarray
    lamps: np.ndarray
    laser: np.ndarray
    air: np.ndarray


@njit(cache=True, error_model="numpy")
def _turned(axes, x, y, z):
    """Return a direction in camera axes on Earth."""
    return (
        x * axes[0, 0] + y * axes[1, 0] + z * axes[2, 0],
        x * axes[0, 1] + y * axes[1, 1] + z * axes[2, 1],
        x * axes[0, 2] + y * axes[1, 2] + z * axes[2, 2],
    )


@njit(cache=True, error_model="numpy")
def _edges(axes, rays, i, j):
    """Return how the direction changes from one column, and from one row, to the next."""
    i2, j2 = (i + 1, i) if i + 1 < rays.shape[0] else (i, i - 1), (j + 1, j) if j + 1 < rays.shape[1] else (j, j - 1)
    a, b = rays[i, j2[0]], rays[i, j2[1]]
    du = _turned(axes, a[0] - b[0], a[1] - b[1], a[2] - b[2])
    a, b = rays[i2[0], j], rays[i2[1], j]
    return du, _turned(axes, a[0] - b[0], a[1] - b[1], a[2] - b[2])


@njit(cache=True, error_model="numpy")
def _meet(wall, start, origin, way, sight):
    """Return range, kind, cell, part and normal of the first thing that a ray meets."""
    ray = (origin[0], origin[1], origin[2], way[0], way[1], way[2])
    t, kind, _, cell, part = cast_one(wall, start, ray, sight, CLOSE)
    if isnan(t):
        return t, NOTHING, cell, part, (0.0, 0.0, 0.0)
    point = (origin[0] + t * way[0], origin[1] + t * way[1], origin[2] + t * way[2])
    if part == FACE:
        _, there, _ = gap_at(wall, cell, point[0], point[1], point[2], 0.0, 0.0, 0.0, 0.0)
        if there == WATER:
            # Where pipes stand apart the water's level is drawn with a step, which is water too.
            y = wall.cells[cell].y
            return t, WATER, cell, SECTION, (y[0], y[1], y[2])
    return t, kind, cell, part, normal_at(wall, cell, part, point, way)


@njit(cache=True, error_model="numpy")
def _pixel(wall, scene, origin, start, axes, rays, i, j, samples):
    """Return the light of one pixel, its rays cast one by one."""
    d = rays[i, j]
    if isnan(d[0]):
        return 0.0, 0.0, 0.0
    du, dv = _edges(axes, rays, i, j)
    if isnan(du[0]) or isnan(dv[0]):
        samples, du, dv = 1, (1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0)
    base = _turned(axes, d[0], d[1], d[2])
    r = g = b = 0.0
    for k in range(samples):
        for m in range(samples):
            p, q = (k + 0.5) / samples - 0.5, (m + 0.5) / samples - 0.5
            x, y, z = base[0] + p * du[0] + q * dv[0], base[1] + p * du[1] + q * dv[1], base[2] + p * du[2] + q * dv[2]
            size = sqrt(x * x + y * y + z * z)
            way = (x / size, y / size, z / size)
            t, kind, cell, part, normal = _meet(wall, start, origin, way, scene.air[0].sight)
            if isnan(t):
                continue
            one = light_of(wall, scene, origin, way, t, kind, cell, part, normal, (du, dv), i, j)
            r, g, b = r + one[0], g + one[1], b + one[2]
    n = 1.0 / (samples * samples)
    return n * r, n * g, n * b


@njit(cache=True, parallel=True, error_model="numpy")
def render(wall, scene, eye, start, axes, rays, samples):
    """Return the light (rows, columns, 3) that reaches each pixel; 1 is full scale at unit exposure.

    Args:
        wall: Arrays of `wall.build`.
        scene: What lights it.
        eye: The camera (3,), east, north, up [m].
        start: Cell in which it lies.
        axes: Camera axes ahead, up, right as rows (3, 3), on Earth.
        rays: Unit direction of each pixel in camera axes (rows, columns, 3); NaN where the lens shows nothing.
        samples: Rays along each side of a pixel in which something begins or ends.
    """
    height, width = rays.shape[0], rays.shape[1]
    rows, columns = (height - 1) // BLOCK + 2, (width - 1) // BLOCK + 2
    reach = np.full((rows, columns), np.nan)
    kinds = np.full((rows, columns), NOTHING, np.uint8)
    cells, parts = np.zeros((rows, columns), np.int64), np.zeros((rows, columns), np.int64)
    normals = np.zeros((rows, columns, 3))
    origin = (eye[0], eye[1], eye[2])
    for a in prange(rows):
        for b in range(columns):
            d = rays[min(a * BLOCK, height - 1), min(b * BLOCK, width - 1)]
            if isnan(d[0]):
                continue
            way = _turned(axes, d[0], d[1], d[2])
            t, kind, cell, part, n = _meet(wall, start, origin, way, scene.air[0].sight)
            reach[a, b], kinds[a, b], cells[a, b], parts[a, b] = t, kind, cell, part
            normals[a, b, 0], normals[a, b, 1], normals[a, b, 2] = n[0], n[1], n[2]
    out = np.zeros((height, width, 3), np.float32)
    for a in prange(rows - 1):
        top, low = a * BLOCK, min((a + 1) * BLOCK, height - 1)
        for b in range(columns - 1):
            left, right = b * BLOCK, min((b + 1) * BLOCK, width - 1)
            kind, cell, part = kinds[a, b], cells[a, b], parts[a, b]
            same, nothing = True, True
            for p in range(2):
                for q in range(2):
                    same &= kinds[a + p, b + q] == kind and cells[a + p, b + q] == cell and parts[a + p, b + q] == part
                    same &= not isnan(reach[a + p, b + q])
                    nothing &= isnan(reach[a + p, b + q])
            same &= kind != JOINT or part == FACE
            if nothing and kind == NOTHING and top > 0 and left > 0 and isnan(rays[top, left, 0]):
                continue
            for i in range(top, min(top + BLOCK, height)):
                v = (i - top) / max(low - top, 1)
                for j in range(left, min(left + BLOCK, width)):
                    if not same:
                        r, g, bl = _pixel(wall, scene, origin, start, axes, rays, i, j, samples)
                        out[i, j, 0], out[i, j, 1], out[i, j, 2] = r, g, bl
                        continue
                    u = (j - left) / max(right - left, 1)
                    w00, w01, w10, w11 = (1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v
                    # On a plane 1/range is all but straight across the picture, on a pipe's wall nearly so.
                    t = 1.0 / (
                        w00 / reach[a, b] + w01 / reach[a, b + 1] + w10 / reach[a + 1, b] + w11 / reach[a + 1, b + 1]
                    )
                    x = (
                        w00 * normals[a, b, 0]
                        + w01 * normals[a, b + 1, 0]
                        + w10 * normals[a + 1, b, 0]
                        + w11 * normals[a + 1, b + 1, 0]
                    )
                    y = (
                        w00 * normals[a, b, 1]
                        + w01 * normals[a, b + 1, 1]
                        + w10 * normals[a + 1, b, 1]
                        + w11 * normals[a + 1, b + 1, 1]
                    )
                    z = (
                        w00 * normals[a, b, 2]
                        + w01 * normals[a, b + 1, 2]
                        + w10 * normals[a + 1, b, 2]
                        + w11 * normals[a + 1, b + 1, 2]
                    )
                    size = max(sqrt(x * x + y * y + z * z), 1e-12)
                    d = rays[i, j]
                    way = _turned(axes, d[0], d[1], d[2])
                    edges = _edges(axes, rays, i, j)
                    r, g, bl = light_of(
                        wall, scene, origin, way, t, kind, cell, part, (x / size, y / size, z / size), edges, i, j
                    )
                    out[i, j, 0], out[i, j, 1], out[i, j, 2] = r, g, bl
    return out
