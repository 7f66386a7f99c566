"""A CAD mesh of a pipe loop that others made: its axis goes on, turns left, goes on, turns left; rays cast on it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

MESH = Path(__file__).parents[1] / ".." / "shared" / "data" / "pipe-loop-cad-mesh-with-bends" / "pipes22.obj"
PRESENT = pytest.mark.skipif(not MESH.exists(), reason="the reference folder ../shared is absent")
NEEDED = [pytest.mark.shared, PRESENT]
"""Marks of tests that need it."""

WALL, SIDES, STEPS = 0.2, 34, 16
"""Radius of the inner wall [m], its flat facets around, and along each bend."""
FACET = WALL * (1 - np.cos(np.pi / SIDES))
"""Depth of one of the facets around the wall [m]."""


def read() -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n, 3) in rings of `SIDES`, axes turned to east, north, up; and their quads (m, 4)."""
    lines = [line.split() for line in MESH.read_text().splitlines()]
    vertices = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)[:, [0, 2, 1]]
    return vertices, np.array([[int(v.split("/")[0]) - 1 for v in line[1:]] for line in lines if line[:1] == ["f"]])


def triangles(vertices: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Return the quads as triangles (k, 3, 3)."""
    return vertices[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]


def inner_rings(vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the centres (ring, 3) of all rings of vertices, and which of them are the inner wall's."""
    rings = vertices.reshape(-1, SIDES, 3)
    centres = rings.mean(axis=1)
    return centres, np.abs(np.linalg.norm(rings - centres[:, None], axis=-1) - WALL).max(axis=1) < 1e-3


def first_bend(centres: np.ndarray) -> tuple[np.ndarray, float]:
    """Return centre (2,) and radius [m] of the first bend, from the centres of the inner wall's rings."""
    on = centres[(centres[:, 0] > 4.05) & (centres[:, 1] < 0.9), :2]
    solved = np.linalg.lstsq(np.c_[2 * on, np.ones(len(on))], (on**2).sum(axis=1), rcond=None)[0]
    return solved[:2], float(np.sqrt(solved[2] + solved[:2] @ solved[:2]))


def cast(near: np.ndarray, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Return the distance to the first of the triangles `near` along each ray (Moller and Trumbore); inf = none."""
    edge1, edge2 = near[:, 1] - near[:, 0], near[:, 2] - near[:, 0]
    normal, away = np.cross(rays[:, None], edge2), origin - near[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / np.sum(edge1 * normal, axis=-1)
        turned = np.cross(away, edge1)
        u, v = np.sum(away * normal, axis=-1) * scale, rays @ turned.T * scale
        distance = np.sum(edge2 * turned, axis=-1) * scale
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (distance > 1e-9)
    return np.where(hit, distance, np.inf).min(axis=1)


def within(mesh: np.ndarray, origin: np.ndarray, reach: float) -> np.ndarray:
    """Return the triangles that come within `reach` [m] of a place along every axis."""
    low, high = mesh.min(axis=1), mesh.max(axis=1)
    return mesh[((low < origin + reach) & (high > origin - reach)).all(axis=1)]
