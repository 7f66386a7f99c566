"""Light on what a ray has met: lamps on the camera, the laser's ring, water that mirrors, haze in between."""

from __future__ import annotations

from math import atan2, exp, isnan, pi, sqrt

import numpy as np

from ..cast import SECTION, cast_one, gap_at, locate
from ..kernels import inner
from ..wall import WATER
from .noise import value_noise
from .surfaces import CLOSE, colour_at, meet

LAMP = np.dtype([("place", "f8", 3), ("beam", "f8", 3), ("power", "f8"), ("exponent", "f8")])
"""A lamp on Earth: place, unit beam, share of the light, exponent of the cosine off its beam."""

LASER = np.dtype(
    [("source", "f8", 3), ("normal", "f8", 3), ("colour", "f8", 3), ("cell", "i8")]
    + [(name, "f8") for name in ("sigma", "power", "speckle", "wet", "ghost", "ghost_ahead")]
)
"""A laser plane on Earth: source, unit normal, colour, cell of the source, one-sigma of the line [m], brightness."""

AIR = np.dtype([("haze", "f8"), ("ambient", "f8"), ("sight", "f8"), ("seed", "u8")])
"""Haze [1/m], light from all round, how far one sees [m], seed of the picture's speckle."""


@inner(error_model="numpy")
def _lamps(scene, point, normal, way, gloss, t):
    """Return diffuse and mirrored light at a point, in the lamps' unit."""
    look, air = scene.look[0], scene.air[0]
    unit = 4.0 * look.radius * look.radius
    away = t / (4.0 * look.radius)
    diffuse, mirrored = air.ambient / (1.0 + away * away), 0.0
    for k in range(scene.lamps.shape[0]):
        lamp = scene.lamps[k]
        lx, ly, lz = lamp.place[0] - point[0], lamp.place[1] - point[1], lamp.place[2] - point[2]
        d2 = max(lx * lx + ly * ly + lz * lz, 1e-6)
        d = sqrt(d2)
        lx, ly, lz = lx / d, ly / d, lz / d
        beam = -(lx * lamp.beam[0] + ly * lamp.beam[1] + lz * lamp.beam[2])
        facing = lx * normal[0] + ly * normal[1] + lz * normal[2]
        if beam <= 0.0 or facing <= 0.0:
            continue
        spread = beam if lamp.exponent == 1.0 else beam**lamp.exponent
        strength = lamp.power * unit * spread / d2
        diffuse += strength * facing
        if gloss > 0.0:
            hx, hy, hz = lx - way[0], ly - way[1], lz - way[2]
            h = (hx * normal[0] + hy * normal[1] + hz * normal[2]) / sqrt(hx * hx + hy * hy + hz * hz)
            # Beyond, less than a thousandth of the glint is left.
            if look.shine * (1.0 - h) < 7.0:
                mirrored += gloss * strength * h**look.shine * (look.shine + 8.0) / 25.0
    return diffuse, mirrored


@inner(error_model="numpy")
def _line(wall, laser, point, normal, spans, row, column, seed, s, theta, radius):
    """Return how bright the laser's ring is at a point."""
    dx, dy, dz = point[0] - laser.source[0], point[1] - laser.source[1], point[2] - laser.source[2]
    off = dx * laser.normal[0] + dy * laser.normal[1] + dz * laser.normal[2]
    # Averaged over the pixel: its two edges widen the Gaussian of the line by their own spread.
    wide2 = laser.sigma**2 + spans
    wide, own = sqrt(wide2), laser.sigma
    most = 6.0 * wide + (12.0 * own if laser.wet > 0.0 else 0.0)
    if abs(off) > most and (laser.ghost == 0.0 or abs(off - laser.ghost_ahead) > most):
        return 0.0
    value = own / wide * exp(-0.5 * off * off / wide2)
    ghost = off - laser.ghost_ahead
    value += laser.ghost * own / wide * exp(-0.5 * ghost * ghost / wide2)
    if laser.wet > 0.0:
        film = value_noise(s / (0.5 * radius), theta * radius / (0.3 * radius), 21, np.uint64(77))
        film = min(1.0, max(0.0, film + 2.0 * laser.wet - 1.0))
        glint = value_noise(s / 0.002, theta * radius / 0.002, max(3, int(pi * radius / 0.001)), np.uint64(78))
        broad2 = 25.0 * own * own + spans
        value += film * 0.12 * exp(-0.5 * off * off / broad2) * (1.0 + 3.0 * max(0.0, glint))
    if value < 1e-5:
        return 0.0
    d = sqrt(dx * dx + dy * dy + dz * dz)
    ray = (laser.source[0], laser.source[1], laser.source[2], dx / d, dy / d, dz / d)
    reach, _, _, _, _ = cast_one(wall, laser.cell, ray, d, CLOSE)
    # Nothing at or before the point means that it is the point itself that the plane lights.
    if reach < d - 0.004:
        return 0.0
    facing = max(0.0, -(dx * normal[0] + dy * normal[1] + dz * normal[2]) / d)
    if laser.speckle > 0.0:
        fine = value_noise(row / 1.3, column / 1.3, 1 << 20, seed) + 0.5 * value_noise(
            row / 3.1, column / 3.1, 1 << 20, seed
        )
        value *= max(0.0, 1.0 + laser.speckle * fine / 1.12)
    return laser.power * value * facing * radius / d


@inner(error_model="numpy")
def _solid(wall, scene, point, way, t, kind, cell, part, normal, edges, row, column):
    """Return the light (red, green, blue) that comes back from anything but water."""
    look, air = scene.look[0], scene.air[0]
    s, y, z = locate(wall.cells, cell, point[0], point[1], point[2])
    theta = atan2(y, z)
    theta += 2.0 * pi if theta < 0.0 else 0.0
    du, dv = edges
    pixel = sqrt(sqrt((du[0] ** 2 + du[1] ** 2 + du[2] ** 2) * (dv[0] ** 2 + dv[1] ** 2 + dv[2] ** 2)))
    slant = max(0.03, -(way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]))
    line = np.float64(0.0)
    if scene.laser.shape[0]:
        laser = scene.laser[0]
        n = (laser.normal[0], laser.normal[1], laser.normal[2])
        spans = (_span(n, du, way, normal, t, slant) ** 2 + _span(n, dv, way, normal, t, slant) ** 2) / 12.0
        line = _line(wall, laser, point, normal, spans, row, column, air.seed, s, theta, look.radius)
    if scene.lamps.shape[0] == 0 and air.ambient == 0.0 and line == 0.0:
        return 0.0, 0.0, 0.0
    footprint = t * pixel / sqrt(slant)
    r, g, b, gloss, ahead, aside = colour_at(scene, wall, cell, kind, part, s, theta, point, footprint)
    if ahead != 0.0 or aside != 0.0:
        normal = _tilted(wall.cells[cell].x, normal, ahead, aside)
    diffuse, mirrored = _lamps(scene, point, normal, way, gloss, t)
    r, g, b = r * diffuse + mirrored, g * diffuse + mirrored, b * diffuse + mirrored
    if line > 0.0:
        laser = scene.laser[0]
        line *= 0.6 if kind != WATER else 0.1
        r, g, b = r + line * laser.colour[0], g + line * laser.colour[1], b + line * laser.colour[2]
    return r, g, b


@inner(error_model="numpy")
def _span(n, edge, way, normal, t, slant):
    """Return how far the laser plane's coordinate runs across a pixel's edge, on the plane that touches the wall."""
    across = (edge[0] * normal[0] + edge[1] * normal[1] + edge[2] * normal[2]) / slant
    x, y, z = edge[0] + across * way[0], edge[1] + across * way[1], edge[2] + across * way[2]
    return t * (x * n[0] + y * n[1] + z * n[2])


@inner(error_model="numpy")
def _tilted(x, normal, ahead, aside):
    """Return the normal tilted by slopes along the pipe and around it."""
    along = x[0] * normal[0] + x[1] * normal[1] + x[2] * normal[2]
    ux, uy, uz = x[0] - along * normal[0], x[1] - along * normal[1], x[2] - along * normal[2]
    size = max(sqrt(ux * ux + uy * uy + uz * uz), 1e-9)
    ux, uy, uz = ux / size, uy / size, uz / size
    vx, vy, vz = normal[1] * uz - normal[2] * uy, normal[2] * ux - normal[0] * uz, normal[0] * uy - normal[1] * ux
    nx, ny, nz = (
        normal[0] - ahead * ux - aside * vx,
        normal[1] - ahead * uy - aside * vy,
        normal[2] - ahead * uz - aside * vz,
    )
    size = sqrt(nx * nx + ny * ny + nz * nz)
    return nx / size, ny / size, nz / size


@inner(error_model="numpy")
def _shows_line(wall, scene, cell, start, way):
    """Return whether a ray ends near one of the laser's lines, which show in water wherever one looks at it."""
    if scene.laser.shape[0] == 0:
        return False
    laser = scene.laser[0]
    n, source = laser.normal, laser.source
    speed = n[0] * way[0] + n[1] * way[1] + n[2] * way[2]
    off = n[0] * (source[0] - start[0]) + n[1] * (source[1] - start[1]) + n[2] * (source[2] - start[2])
    for plane in range(2):
        if plane == 1 and laser.ghost == 0.0:
            break
        t = (off + plane * laser.ghost_ahead) / speed if speed != 0.0 else -1.0
        if t > 0.0:
            gap, _, _ = gap_at(wall, cell, start[0], start[1], start[2], way[0], way[1], way[2], t)
            if abs(gap) < 30.0 * laser.sigma:
                return True
    return False


@inner(error_model="numpy")
def light_of(wall, scene, origin, way, t, kind, cell, part, normal, edges, row, column):
    """Return the light (red, green, blue) that reaches a pixel along a ray that has met something at range t."""
    air = scene.air[0]
    point = (origin[0] + t * way[0], origin[1] + t * way[1], origin[2] + t * way[2])
    r, g, b = _solid(wall, scene, point, way, t, kind, cell, part, normal, edges, row, column)
    if kind == WATER and part == SECTION:
        ripple = 0.02
        tick = np.uint64(3)
        a = ripple * value_noise(40.0 * point[0] + 7.0, 40.0 * point[1], 1 << 20, tick)
        c = ripple * value_noise(40.0 * point[0], 40.0 * point[1] + 7.0, 1 << 20, tick + np.uint64(1))
        normal = _tilted(wall.cells[cell].x, normal, a, c)
        dip = way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2]
        back = (way[0] - 2.0 * dip * normal[0], way[1] - 2.0 * dip * normal[1], way[2] - 2.0 * dip * normal[2])
        start = (point[0] + 1e-5 * normal[0], point[1] + 1e-5 * normal[1], point[2] + 1e-5 * normal[2])
        share = 0.03 + 0.97 * max(0.0, 1.0 + dip) ** 5
        r, g, b = 0.35 * (1.0 - share) * r, 0.35 * (1.0 - share) * g, 0.35 * (1.0 - share) * b
        if (share > 0.06 and scene.lamps.shape[0] > 0) or _shows_line(wall, scene, cell, start, back):
            far, kind2, cell2, part2, normal2 = meet(wall, cell, start, back, 12.0 * scene.look[0].radius)
            if isnan(far) or kind2 == WATER:
                share = 0.0
        else:
            share = 0.0
        if share > 0.0:
            there = (start[0] + far * back[0], start[1] + far * back[1], start[2] + far * back[2])
            mr, mg, mb = _solid(wall, scene, there, back, t + far, kind2, cell2, part2, normal2, edges, row, column)
            r, g, b = r + share * mr, g + share * mg, b + share * mb
    if air.haze > 0.0:
        left = exp(-2.0 * air.haze * t)
        back = veil(scene, t)
        r, g, b = left * r + back, left * g + back, left * b + back
    return r, g, b


@inner(error_model="numpy")
def veil(scene, t):
    """Return the light that haze throws back over a way t [m]: most of it from near by, where the lamps are."""
    radius = scene.look[0].radius
    if scene.lamps.shape[0] == 0:
        return 0.0
    return scene.air[0].haze * radius * radius * (2.0 / radius - 1.0 / max(t, 0.5 * radius))
