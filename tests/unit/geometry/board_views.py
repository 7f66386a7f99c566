"""Pictures of a flat board through each lens model, projected here without the code under test."""

import numpy as np

SHAPES = {
    "equidistant": lambda z: z,
    "sine": np.sin,
    "equisolid": lambda z: np.sin(z / 2),
    "perspective": np.tan,
    "stereographic": lambda z: np.tan(z / 2),
}
SIZE = (1280, 960)


def turn(vector):
    """Return the rotation matrix about `vector` by its length [rad], after Rodrigues."""
    angle = float(np.linalg.norm(vector))
    if angle < 1e-12:
        return np.eye(3)
    x, y, z = np.asarray(vector) / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def board_grid(columns=9, rows=6, square=0.03):
    x, y = np.meshgrid(np.arange(columns) - (columns - 1) / 2, np.arange(rows) - (rows - 1) / 2)
    return np.stack([x.ravel(), y.ravel()], axis=1) * square


def random_lens(rng, model):
    """Return k [px] and the principal point of a lens that sees about 55 degrees at the picture's side."""
    k = rng.uniform(0.9, 1.2) * 0.5 * SIZE[0] / SHAPES[model](np.radians(55.0))
    return k, 0.5 * (np.array(SIZE) - 1.0) + rng.normal(0.0, 8.0, 2)


def pictures(rng, model, k, centre, count=20, noise=0.5, tilt=25.0):
    """Return (picture, corner, 2) noisy pixels of boards that stand all over the picture, tilted at random."""
    found = []
    board = np.column_stack([board_grid(), np.zeros(54)])
    while len(found) < count:
        off, around, away = np.radians(rng.uniform(0, 45)), rng.uniform(0, 2 * np.pi), rng.uniform(0.15, 0.4)
        way = np.array([np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)])
        facing = turn(off * np.array([-np.sin(around), np.cos(around), 0.0]))
        points = board @ (facing @ turn(np.radians(rng.normal(0, tilt, 3)))).T + away * way
        across = np.hypot(points[:, 0], points[:, 1])
        zenith = np.arctan2(across, points[:, 2])
        if zenith.max() > np.radians(75.0):
            continue
        pixels = centre + k * SHAPES[model](zenith)[:, None] * points[:, :2] / across[:, None]
        if (pixels < 5).any() or (pixels > np.array(SIZE) - 6).any():
            continue
        found.append(pixels + rng.normal(0.0, noise, pixels.shape))
    return np.array(found)
