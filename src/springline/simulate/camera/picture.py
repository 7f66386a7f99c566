"""From light to the picture that the camera hands over: vignetting, blur, motes, exposure, noise, eight bits."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from .. import optics

_LEVELS = 4096


def develop(light: np.ndarray, camera: optics.Camera, dimming: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Return the picture (rows, columns, 3), red green blue of 8 bits, of light (rows, columns, 3)."""
    light = light * dimming[..., None]
    if camera.dust.specks > 0.0:
        light += _motes(light.shape, rng.poisson(camera.dust.specks), rng)[..., None]
    if camera.blur_px > 0.0:
        for axis in (0, 1):
            light = gaussian_filter1d(light, camera.blur_px, axis=axis, mode="nearest", truncate=3.0)
    light *= np.float32(camera.exposure)
    if camera.noise > 0.0 or camera.shot_noise > 0.0:
        sigma = np.sqrt(np.float32(camera.noise**2) + np.float32(camera.shot_noise**2) * np.clip(light, 0.0, 1.0))
        light += sigma * rng.standard_normal(light.shape, np.float32)
    steps = np.clip(light * np.float32(_LEVELS), 0.0, _LEVELS).astype(np.uint16)
    return _curve(camera.gamma)[steps]


def _curve(gamma: float) -> np.ndarray:
    """Return the 8-bit value of each level of light."""
    return np.round(255.0 * (np.arange(_LEVELS + 1) / _LEVELS) ** (1.0 / gamma)).astype(np.uint8)


def dimming(camera: optics.Camera, centre: tuple[float, float]) -> np.ndarray:
    """Return the share of light (rows, columns) that vignetting leaves, 1 in the middle."""
    column, row = np.meshgrid(np.arange(camera.width) - centre[0], np.arange(camera.height) - centre[1])
    corner2 = max(centre[0], camera.width - 1 - centre[0]) ** 2 + max(centre[1], camera.height - 1 - centre[1]) ** 2
    return (1.0 - camera.vignetting * (column**2 + row**2) / corner2).astype(np.float32)


def _motes(shape: tuple[int, ...], count: int, rng: np.random.Generator) -> np.ndarray:
    """Return the light of `count` motes out of focus."""
    height, width = shape[:2]
    out = np.zeros((height, width), np.float32)
    scale = width / 640.0
    for _ in range(count):
        y, x = rng.uniform(0, height), rng.uniform(0, width)
        radius, light = scale * rng.uniform(1.0, 6.0), 0.5 * rng.random() ** 2
        reach = int(radius) + 2
        rows, columns = (
            slice(max(0, int(y) - reach), int(y) + reach + 1),
            slice(max(0, int(x) - reach), int(x) + reach + 1),
        )
        away = np.hypot(*np.meshgrid(np.arange(width)[columns] - x, np.arange(height)[rows] - y))
        out[rows, columns] += np.float32(light) * np.clip(radius - away + 0.5, 0.0, 1.0).astype(np.float32)
    return out
