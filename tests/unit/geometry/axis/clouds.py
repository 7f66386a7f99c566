"""Clouds of pipes and of other things, made without the code under test."""

import numpy as np


def tube(
    count=60_000,
    length=2.0,
    radius=0.15,
    *,
    oval=0.0,
    noise=0.001,
    arc=(0.0, 2.0 * np.pi),
    forward=(1.0, 0.1, -0.05),
    seed=0,
):
    """Points of a straight pipe whose axis runs through the origin along `forward`."""
    rng = np.random.default_rng(seed)
    along, theta = rng.uniform(0.0, length, count), rng.uniform(*arc, count)
    rho = radius * (1.0 + oval * np.cos(2.0 * theta)) + noise * rng.standard_normal(count)
    x = np.array(forward) / np.linalg.norm(forward)
    z = np.cross(x, [0.0, 1.0, 0.0])
    z /= np.linalg.norm(z)
    y = np.cross(z, x)
    return along[:, None] * x + (rho * np.sin(theta))[:, None] * y + (rho * np.cos(theta))[:, None] * z


def bent_tube(count=150_000, radius=0.2, bend=1.0, noise=0.002, seed=0):
    """Points of 2 m straight, a quarter bend to the right of radius `bend`, and 2 m straight."""
    rng = np.random.default_rng(seed)
    arc = bend * np.pi / 2
    s, theta = rng.uniform(0.0, 4.0 + arc, count), rng.uniform(0.0, 2.0 * np.pi, count)
    turn = np.clip((s - 2.0) / bend, 0.0, np.pi / 2)
    centre = np.column_stack([2.0 + bend * np.sin(turn), np.zeros(count), bend * (1.0 - np.cos(turn))])
    centre[:, 0] += np.minimum(s - 2.0, 0.0)
    centre[:, 2] += np.maximum(s - 2.0 - arc, 0.0)
    right = np.column_stack([-np.sin(turn), np.zeros(count), np.cos(turn)])
    rho = radius + noise * rng.standard_normal(count)
    points = centre + (rho * np.cos(theta))[:, None] * right
    points[:, 1] += rho * np.sin(theta)
    return points


def room(count=40_000, size=(2.0, 1.0, 1.3), seed=1):
    """Points on the six faces of a box."""
    rng = np.random.default_rng(seed)
    points, face = rng.uniform(-1.0, 1.0, (count, 3)), rng.integers(0, 6, count)
    points[np.arange(count), face % 3] = np.where(face < 3, 1.0, -1.0)
    return points * np.array(size)


def duct(count=40_000, length=5.0, side=1.0, seed=2):
    """Points on the four walls of a square duct."""
    rng = np.random.default_rng(seed)
    across = rng.uniform(-0.5, 0.5, (count, 2)) * side
    wall = rng.integers(0, 2, count)
    across[np.arange(count), wall] = np.where(rng.random(count) < 0.5, 0.5, -0.5) * side
    return np.column_stack([rng.uniform(0.0, length, count), across])


def ball(count=40_000, seed=3):
    """Points on a sphere."""
    points = np.random.default_rng(seed).standard_normal((count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def plane(count=40_000, seed=4):
    """Points on a noisy plane."""
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(-1.0, 1.0, (count, 2)), 0.002 * rng.standard_normal(count)])


def haze(count=40_000, seed=5):
    """Points at random in a cube."""
    return np.random.default_rng(seed).uniform(-1.0, 1.0, (count, 3))


NOT_PIPES = {"plane": plane, "room": room, "duct": duct, "ball": ball, "haze": haze}
