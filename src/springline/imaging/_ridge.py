"""Kernels that follow a bright line once round through a picture laid out by bearing and radius."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def brightest_path(light, reach):
    """Return the (bearing,) radius index of the closed path along which `light` is greatest.

    Args:
        light: (bearing, radius) brightness, none below zero.
        reach: Steps between neighbouring bearings farther than this [px] are not taken; shorter ones cost with their
            square, up to the typical brightness of a line.

    The path is found over two turns and its middle turn given, so that its ends meet.
    """
    count, size = light.shape
    most = light.max()
    widest = int(np.ceil(reach))
    price = np.empty(widest + 1)
    for step in range(widest + 1):
        price[step] = most * (step / reach) ** 2
    turns = 2 * count
    before = np.empty((turns, size), dtype=np.int16)
    score, other = light[0].copy(), np.empty(size)
    for k in range(1, turns):
        row = light[k % count]
        for i in range(size):
            best, source = score[i], i
            for step in range(1, widest + 1):
                if i >= step and score[i - step] - price[step] > best:
                    best, source = score[i - step] - price[step], i - step
                if i + step < size and score[i + step] - price[step] > best:
                    best, source = score[i + step] - price[step], i + step
            other[i] = best + row[i]
            before[k, i] = source
        score, other = other, score
    path = np.empty(count, dtype=np.int64)
    at = int(np.argmax(score))
    for k in range(turns - 1, 0, -1):
        if count // 2 <= k < count + count // 2:
            path[k % count] = at
        at = before[k, at]
    return path


@njit(cache=True, nogil=True, error_model="numpy")
def centre_of_light(light, path, window):
    """Return the (bearing,) centre of light of the line near `path` [px], under a window that follows it.

    Args:
        light: (bearing, radius) brightness.
        path: (bearing,) where the line is about [px].
        window: One-sigma of the Gaussian window [px].

    The window is centred on what it finds, so that it does not draw the centre to where it was first put. The
    brightness beside the line, at its window's ends, is taken off along a straight line.
    """
    count, size = light.shape
    found = np.empty(count)
    half = int(np.ceil(2.5 * window))
    for k in range(count):
        at = path[k]
        for _ in range(6):
            first, last = int(np.round(at)) - half, int(np.round(at)) + half
            if first < 0 or last >= size:
                at = np.nan
                break
            low, high = light[k, first], light[k, last]
            if first >= 1 and last + 1 < size:
                low, high = min(low, light[k, first - 1]), min(high, light[k, last + 1])
            total, moment = 0.0, 0.0
            for i in range(first, last + 1):
                ground = low + (high - low) * (i - first) / (last - first)
                value = max(light[k, i] - ground, 0.0) * np.exp(-0.5 * ((i - at) / window) ** 2)
                total += value
                moment += value * (i - at)
            if total <= 0.0:
                at = np.nan
                break
            # Under a window 1.4 times as wide as the line two thirds of the way are seen; the step makes up for it.
            move = 1.5 * moment / total
            at += min(max(move, -window), window)
            if abs(move) < 1e-3:
                break
        found[k] = at
    return found


def smooth_course(place: np.ndarray, strength: np.ndarray, order: int = 4) -> np.ndarray:
    """Return the smooth closed course (bearing,) [px] through most of what is bright.

    Args:
        place: (bearing,) radius of the line [px]; NaN = none.
        strength: (bearing,) its brightness.
        order: Highest harmonic; fewer where little is seen.

    Reweighted least squares with Tukey weights, from the median; harmonics are held down where nothing was seen.
    """
    count = len(place)
    theta = np.arange(count) * 2.0 * np.pi / count
    columns = [np.ones(count)]
    for k in range(1, order + 1):
        columns += [np.cos(k * theta), np.sin(k * theta)]
    design = np.stack(columns, axis=1)
    seen = np.isfinite(place)
    value = np.where(seen, place, 0.0)
    middle = float(np.median(place[seen]))
    weight = np.where(seen, np.minimum(strength / np.median(strength[seen]), 1.0), 0.0)
    hold = np.array([0.0] + [k**2 / (0.2 * middle) ** 2 for k in range(1, order + 1) for _ in range(2)])
    course = np.full(count, middle)
    scale = 0.2 * middle
    for _ in range(15):
        tukey = np.clip(1.0 - ((value - course) / scale) ** 2, 0.0, None) ** 2 * weight
        if tukey.sum() < 4:
            return course
        normal = design.T @ (design * tukey[:, None]) + np.diag(hold)
        course = design @ np.linalg.solve(normal, design.T @ (tukey * value))
        rest = np.abs(value - course)[tukey > 0]
        scale = max(4.685 * 1.4826 * float(np.median(rest)), 0.01 * middle)
    return course
