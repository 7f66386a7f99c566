"""Simple views along a pipe, drawn by distance alone: light that falls off, and lit or dark rings."""

import numpy as np


def view(rings, *, size=(240, 320), centre=(165.0, 118.0), noise=2.0, seed=0, reach=90.0):
    """A frame (row, column, 3); rings are (column, row, radius, width, grey levels added)."""
    rows, columns = np.mgrid[: size[0], : size[1]].astype(float)
    away = np.hypot(columns - centre[0], rows - centre[1])
    light = 20.0 + 160.0 * (1.0 - np.exp(-((away / reach) ** 2)))
    for column, row, radius, width, height in rings:
        off = np.hypot(columns - column, rows - row) - radius
        light = light + height * np.exp(-0.5 * (off / width) ** 2)
    light = light + np.random.default_rng(seed).normal(0.0, noise, light.shape)
    return np.repeat(np.clip(light, 0, 255).astype(np.uint8)[..., None], 3, axis=2)
