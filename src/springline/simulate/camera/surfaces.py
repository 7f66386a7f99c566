"""Colour, shine and slope of what a ray has met, and the direction in which it faces."""

from __future__ import annotations

from math import cos, exp, floor, isnan, pi, sin, sqrt

import numpy as np

from ..cast import FACE, SECTION, cast_one, gap_at
from ..kernels import inner
from ..surface import lattice
from ..wall import BED, CRACK, DEPOSIT, JOINT, LATERAL, NOTHING, WATER
from .noise import fade, octaves, value_noise

CLOSE = 2e-7
"""How far from the wall a picture's ray may end [m]."""

_STEP = 2e-5


@inner(error_model="numpy")
def normal_at(wall, cell, part, point, way):
    """Return the unit normal of what was met at `point`, on the side from which the ray came along `way`."""
    px, py, pz = point
    if part >= 0:
        row = wall.laterals[part]
        dx, dy, dz = px - row.mouth[0], py - row.mouth[1], pz - row.mouth[2]
        w = dx * row.axis[0] + dy * row.axis[1] + dz * row.axis[2]
        if row.start < 0.0 and abs(w - row.start) < 1e-6:
            nx, ny, nz = row.axis[0], row.axis[1], row.axis[2]
        else:
            nx, ny, nz = dx - w * row.axis[0], dy - w * row.axis[1], dz - w * row.axis[2]
    elif part == FACE:
        nx, ny, nz = wall.cells[cell].x[0], wall.cells[cell].x[1], wall.cells[cell].x[2]
    else:
        here, _, _ = gap_at(wall, cell, px, py, pz, 0.0, 0.0, 0.0, 0.0)
        nx = gap_at(wall, cell, px + _STEP, py, pz, 0.0, 0.0, 0.0, 0.0)[0] - here
        ny = gap_at(wall, cell, px, py + _STEP, pz, 0.0, 0.0, 0.0, 0.0)[0] - here
        nz = gap_at(wall, cell, px, py, pz + _STEP, 0.0, 0.0, 0.0, 0.0)[0] - here
    size = sqrt(nx * nx + ny * ny + nz * nz)
    if size == 0.0:
        return -way[0], -way[1], -way[2]
    if nx * way[0] + ny * way[1] + nz * way[2] > 0.0:
        size = -size
    return nx / size, ny / size, nz / size


@inner(error_model="numpy")
def meet(wall, start, origin, way, sight):
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


@inner(error_model="numpy")
def _decals(decals, s, theta, radius, footprint):
    """Return the share of light that cracks and stains leave at a place."""
    left = 1.0
    for k in range(decals.shape[0]):
        row = decals[k]
        u = s - row.chainage
        reach = 1.3 * row.half_length + row.half_width
        if abs(u) > reach:
            continue
        turn = theta - row.bearing
        turn -= 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)
        v = turn * radius
        if abs(v) > 1.3 * max(row.half_length, row.half_width):
            continue
        if row.form == CRACK:
            c, n = cos(row.turn), sin(row.turn)
            along, across = c * u + n * v, c * v - n * u
            share = abs(along) / row.half_length
            if share > 1.0:
                continue
            wander = value_noise(along / (0.35 * row.half_length), 0.5, 64, row.seed)
            wander = 0.06 * wander + 0.025 * value_noise(
                along / (0.08 * row.half_length), 0.5, 64, row.seed + np.uint64(1)
            )
            away = abs(across - wander * row.half_length)
            half = row.half_width * (1.0 - share * share)
            # A line narrower than a pixel darkens it by its share.
            soft = max(0.5 * footprint, 0.3 * half)
            cover = min(1.0, half / soft) * max(0.0, min(1.0, (half + soft - away) / (2.0 * soft)))
            left *= 1.0 - row.darkness * cover
        else:
            r = sqrt((u / row.half_length) ** 2 + (v / row.half_width) ** 2)
            r += 0.18 * value_noise(s / (0.4 * row.half_length), v / (0.4 * row.half_width), 64, row.seed)
            cover = min(1.0, max(0.0, (1.1 - r) / 0.35))
            left *= 1.0 - row.darkness * cover * cover * (3.0 - 2.0 * cover)
    return left


@inner(error_model="numpy")
def _height(wall, cell, s, theta):
    """Return how high the deposit at a place stands, 1 in its middle, 0 at its edges."""
    for n in range(wall.feature_from[cell], wall.feature_from[cell + 1]):
        row = wall.features[wall.feature_of[n]]
        if row.kind != DEPOSIT or s <= row.first or s >= row.last:
            continue
        turn = theta - row.bearing
        turn -= 2.0 * pi * floor(turn / (2.0 * pi) + 0.5)
        if abs(turn) < row.half:
            along = (s - 0.5 * (row.first + row.last)) / (0.5 * (row.last - row.first))
            return (cos(0.5 * pi * turn / row.half) * cos(0.5 * pi * along)) ** 2
    return 0.0


@inner(error_model="numpy")
def colour_at(scene, wall, cell, kind, part, s, theta, point, footprint):
    """Return red, green, blue share of light thrown back, gloss, and the wall's slope along and around."""
    look = scene.look[0]
    radius, seed = look.radius, look.seed
    girth = 2.0 * pi * radius
    if kind == LATERAL:
        row = wall.laterals[part]
        dx, dy, dz = point[0] - row.mouth[0], point[1] - row.mouth[1], point[2] - row.mouth[2]
        w = dx * row.axis[0] + dy * row.axis[1] + dz * row.axis[2]
        value = octaves(w + 17.0 * part, dx + dy, girth, 0.03, 2, footprint, seed + np.uint64(5))
        value = 1.0 + 0.15 * value
        across2 = dx * dx + dy * dy + dz * dz - w * w
        if 4.0 * across2 < (row.inner + row.outer) ** 2:
            # Inside it grows dark with the way from its opening.
            value *= exp(-max(w - row.start, 0.0) / (1.2 * row.inner))
        return value * look.inner[0], value * look.inner[1], value * look.inner[2], 0.05, 0.0, 0.0
    arc = theta * radius
    piece = scene.pieces[cell]
    # Every pipe has its own grain and tint.
    own = seed + np.uint64(7919 * (piece + 1))
    mottle = octaves(s, arc, girth, look.mottle_size, 3, footprint, own)
    grain = octaves(s, arc, girth, look.grain_size, 2, footprint, own + np.uint64(1))
    streak = fade(0.012, footprint)
    if streak > 0.0:
        streak *= value_noise(s / 1.5, arc / 0.012, max(3, int(girth / 0.012)), own + np.uint64(2))
    tint = look.tint * lattice(piece, 0, seed)
    light = max(0.25, 1.0 + look.mottle * mottle + look.grain * grain + look.streak * streak + tint)
    if look.pores > 0.0:
        hole = octaves(s, arc, girth, 2.5 * look.grain_size, 1, footprint, own + np.uint64(3))
        light *= 1.0 - look.pores * min(1.0, max(0.0, (hole - 1.5) / 0.5))
    share = min(1.0, max(0.0, 0.5 + 0.5 * mottle))
    r = light * (share * look.other[0] + (1.0 - share) * look.colour[0])
    g = light * (share * look.other[1] + (1.0 - share) * look.colour[1])
    b = light * (share * look.other[2] + (1.0 - share) * look.colour[2])
    gloss = look.gloss
    cover = 0.0
    if look.dirt_most > 0.0:
        field = octaves(s, arc, girth, 0.6 * radius, 3, footprint, seed + np.uint64(11)) - 0.55 * sin(theta) - 0.25
        cover = look.dirt_most * min(1.0, max(0.0, (field - look.dirt_from) / 0.5))
    if kind == BED:
        cover = 0.85
    elif kind == DEPOSIT:
        ragged = 0.25 * octaves(s, arc, girth, 0.3 * radius, 3, footprint, seed + np.uint64(17))
        cover = max(cover, 0.85 * min(1.0, max(0.0, (_height(wall, cell, s, theta) + ragged - 0.15) / 0.15)))
    elif kind == JOINT:
        cover = 0.75 if part == SECTION else 0.25
    if cover > 0.0:
        dark = max(0.3, 1.0 + 0.35 * octaves(s, arc, girth, 0.02, 3, footprint, seed + np.uint64(13)))
        r += cover * (dark * look.dirt[0] - r)
        g += cover * (dark * look.dirt[1] - g)
        b += cover * (dark * look.dirt[2] - b)
        gloss *= 1.0 - cover
    left = _decals(scene.decals, s, theta, radius, footprint)
    if kind == JOINT and part == SECTION:
        left *= 0.35
    ahead = aside = 0.0
    seen = fade(look.grain_size, footprint)
    if seen > 0.0 and look.bump > 0.0:
        around = max(3, int(girth / look.grain_size))
        u, v = s / look.grain_size, arc / girth * around
        here = value_noise(u, v, around, own + np.uint64(4))
        ahead = seen * look.bump * (value_noise(u + 0.3, v, around, own + np.uint64(4)) - here)
        aside = seen * look.bump * (value_noise(u, v + 0.3, around, own + np.uint64(4)) - here)
    return left * r, left * g, left * b, gloss * left, ahead, aside
