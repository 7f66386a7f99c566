"""One picture's light: rays through a coarse grid, carried over smooth wall, cast one by one where anything begins."""

from __future__ import annotations

from math import isnan, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit, prange

from ..cast import FACE
from ..kernels import inner
from ..wall import JOINT, NOTHING, WATER, Wall
from .light import light_of, veil
from .surfaces import meet

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


@inner(error_model="numpy")
def _turned(axes, x, y, z):
    """Return a direction in camera axes on Earth."""
    return (
        x * axes[0, 0] + y * axes[1, 0] + z * axes[2, 0],
        x * axes[0, 1] + y * axes[1, 1] + z * axes[2, 1],
        x * axes[0, 2] + y * axes[1, 2] + z * axes[2, 2],
    )


@inner(error_model="numpy")
def _edges(axes, rays, i, j):
    """Return how the direction changes from one column, and from one row, to the next."""
    i2, j2 = (i + 1, i) if i + 1 < rays.shape[0] else (i, i - 1), (j + 1, j) if j + 1 < rays.shape[1] else (j, j - 1)
    a, b = rays[i, j2[0]], rays[i, j2[1]]
    du = _turned(axes, a[0] - b[0], a[1] - b[1], a[2] - b[2])
    a, b = rays[i2[0], j], rays[i2[1], j]
    return du, _turned(axes, a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inner(error_model="numpy")
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
            t, kind, cell, part, normal = meet(wall, start, origin, way, scene.air[0].sight)
            if isnan(t):
                back = veil(scene, scene.air[0].sight)
                r, g, b = r + back, g + back, b + back
                continue
            one = light_of(wall, scene, origin, way, t, kind, cell, part, normal, (du, dv), i, j)
            r, g, b = r + one[0], g + one[1], b + one[2]
    n = 1.0 / (samples * samples)
    return n * r, n * g, n * b


@inner(error_model="numpy")
def _key(kind, cell, part):
    """Return one number for what a ray has met; equal where it is the same smooth piece of wall."""
    return (np.int64(cell) * 4096 + part + 2) * 16 + kind


@inner(error_model="numpy")
def _is_smooth(keys, reach, a, b):
    """Return whether the four nodes around block (a, b) lie on one smooth piece of wall, which then fills it."""
    key = keys[a, b]
    if key & 15 == JOINT and (key >> 4) % 4096 != FACE + 2:
        return False
    for p in range(2):
        for q in range(2):
            if keys[a + p, b + q] != key or isnan(reach[a + p, b + q]):
                return False
    return True


@inner(error_model="numpy")
def _is_edge(keys, i, j):
    """Return whether a pixel's neighbours show something else."""
    key = keys[i, j]
    if (i > 0 and keys[i - 1, j] != key) or (j > 0 and keys[i, j - 1] != key):
        return True
    return (i + 1 < keys.shape[0] and keys[i + 1, j] != key) or (j + 1 < keys.shape[1] and keys[i, j + 1] != key)


@inner(error_model="numpy")
def _between(reach, normals, a, b, u, v):
    """Return range and normal at shares u, v of the way across a smooth block."""
    w00, w01, w10, w11 = (1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v
    # On a plane 1/range is all but straight across the picture, on a pipe's wall nearly so.
    t = 1.0 / (w00 / reach[a, b] + w01 / reach[a, b + 1] + w10 / reach[a + 1, b] + w11 / reach[a + 1, b + 1])
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
    return t, (x / size, y / size, z / size)


@njit(cache=True, parallel=True, error_model="numpy")
def _cast(wall, eye, start, axes, rays, step, sight):
    """Return range, key and normal of what every `step`-th pixel's ray meets, the last row and column included."""
    height, width = rays.shape[0], rays.shape[1]
    rows, columns = (height - 1) // step + 2, (width - 1) // step + 2
    reach, keys = np.full((rows, columns), np.nan), np.full((rows, columns), NOTHING, np.int64)
    normals = np.zeros((rows, columns, 3))
    origin = (eye[0], eye[1], eye[2])
    for a in prange(rows):
        for b in range(columns):
            d = rays[min(a * step, height - 1), min(b * step, width - 1)]
            if isnan(d[0]):
                continue
            way = _turned(axes, d[0], d[1], d[2])
            t, kind, cell, part, n = meet(wall, start, origin, way, sight)
            reach[a, b], keys[a, b] = t, _key(kind, cell, part)
            normals[a, b, 0], normals[a, b, 1], normals[a, b, 2] = n[0], n[1], n[2]
    return reach, keys, normals


@njit(cache=True, parallel=True, error_model="numpy")
def _fill(wall, eye, start, axes, rays, sight, nodes, node_keys):
    """Return the key of what each pixel shows, and range and normal where its block is not smooth."""
    height, width = rays.shape[0], rays.shape[1]
    keys = np.full((height, width), -1, np.int64)
    reach, normals = np.empty((height, width)), np.empty((height, width, 3))
    origin = (eye[0], eye[1], eye[2])
    for a in prange(nodes.shape[0] - 1):
        for b in range(nodes.shape[1] - 1):
            smooth = _is_smooth(node_keys, nodes, a, b)
            for i in range(a * BLOCK, min((a + 1) * BLOCK, height)):
                for j in range(b * BLOCK, min((b + 1) * BLOCK, width)):
                    if smooth:
                        keys[i, j] = node_keys[a, b]
                        continue
                    d = rays[i, j]
                    if isnan(d[0]):
                        continue
                    way = _turned(axes, d[0], d[1], d[2])
                    t, kind, cell, part, n = meet(wall, start, origin, way, sight)
                    reach[i, j], keys[i, j] = t, _key(kind, cell, part)
                    normals[i, j, 0], normals[i, j, 1], normals[i, j, 2] = n[0], n[1], n[2]
    return reach, keys, normals


@inner(error_model="numpy")
def _is_dark(scene, eye, axes, rays, nodes, a, b):
    """Return whether no light falls on smooth block (a, b): the laser's lines pass it by, and there is no other."""
    if scene.laser.shape[0] == 0 or scene.lamps.shape[0] > 0:
        return False
    laser = scene.laser[0]
    low, high = np.inf, -np.inf
    for p in range(2):
        for q in range(2):
            i, j = min((a + p) * BLOCK, rays.shape[0] - 1), min((b + q) * BLOCK, rays.shape[1] - 1)
            way, t = _turned(axes, rays[i, j, 0], rays[i, j, 1], rays[i, j, 2]), nodes[a + p, b + q]
            off = 0.0
            for k in range(3):
                off += laser.normal[k] * (eye[k] + t * way[k] - laser.source[k])
            low, high = min(low, off), max(high, off)
    spare = 20.0 * laser.sigma + 2.0 * (high - low)
    beside = low > spare or high < -spare
    if laser.ghost > 0.0:
        beside &= low - laser.ghost_ahead > spare or high - laser.ghost_ahead < -spare
    return beside


@njit(cache=True, parallel=True, error_model="numpy")
def _shade(wall, scene, eye, start, axes, rays, samples, nodes, node_keys, node_normals, reach, keys, normals):
    """Return the light on each pixel, given what it shows."""
    height, width = rays.shape[0], rays.shape[1]
    origin = (eye[0], eye[1], eye[2])
    out = np.zeros((height, width, 3), np.float32)
    for a in prange(nodes.shape[0] - 1):
        top, low = a * BLOCK, min((a + 1) * BLOCK, height - 1)
        for b in range(nodes.shape[1] - 1):
            left, right = b * BLOCK, min((b + 1) * BLOCK, width - 1)
            smooth = _is_smooth(node_keys, nodes, a, b)
            if smooth and node_keys[a, b] & 15 != WATER and _is_dark(scene, eye, axes, rays, nodes, a, b):
                continue
            for i in range(top, min(top + BLOCK, height)):
                for j in range(left, min(left + BLOCK, width)):
                    key = keys[i, j]
                    if key < 0:
                        continue
                    if not smooth and _is_edge(keys, i, j):
                        r, g, bl = _pixel(wall, scene, origin, start, axes, rays, i, j, samples)
                        out[i, j, 0], out[i, j, 1], out[i, j, 2] = r, g, bl
                        continue
                    if smooth:
                        u, v = (j - left) / max(right - left, 1), (i - top) / max(low - top, 1)
                        t, normal = _between(nodes, node_normals, a, b, u, v)
                    else:
                        t, normal = reach[i, j], (normals[i, j, 0], normals[i, j, 1], normals[i, j, 2])
                        if isnan(t):
                            out[i, j] = veil(scene, scene.air[0].sight)
                            continue
                    d = rays[i, j]
                    way = _turned(axes, d[0], d[1], d[2])
                    edges = _edges(axes, rays, i, j)
                    kind, part, cell = key & 15, (key >> 4) % 4096 - 2, key >> 16
                    r, g, bl = light_of(wall, scene, origin, way, t, kind, cell, part, normal, edges, i, j)
                    out[i, j, 0], out[i, j, 1], out[i, j, 2] = r, g, bl
    return out


def render(
    wall: Wall, scene: Scene, eye: np.ndarray, start: int, axes: np.ndarray, rays: np.ndarray, samples: int
) -> np.ndarray:
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
    sight = float(scene.air["sight"][0])
    nodes = _cast(wall, eye, start, axes, rays, BLOCK, sight)
    filled = _fill(wall, eye, start, axes, rays, sight, *nodes[:2])
    return _shade(wall, scene, eye, start, axes, rays, samples, *nodes, *filled)
