"""The simulator's bends against a CAD mesh of a pipe loop that others made; skipped where it is absent."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from springline.simulate.building import build_pipe
from springline.simulate.cast import cast_rays
from springline.simulate.reading import parse
from springline.simulate.wall import build

MESH = Path(__file__).parents[2] / ".." / "shared" / "data" / "pipe-loop-cad-mesh-with-bends" / "pipes22.obj"

pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not MESH.exists(), reason="the reference folder ../shared is absent"),
]

# The mesh's wall has 34 flat facets around and 16 along each bend; its axis goes on, turns left, goes on, turns left.
WALL, SIDES, STEPS, BEND = 0.2, 34, 16, 1.0
SCENARIO = """
name = "loop"
[pipe]
diameter = 0.4
heading_deg = 90.0
run = [
    {{kind = "straight", length = {first}}},
    {{kind = "bend", radius = {radius}, angle_deg = 90.0, towards = "left"}},
    {{kind = "straight", length = {second}}},
    {{kind = "bend", radius = {radius}, angle_deg = 90.0, towards = "left"}},
    {{kind = "straight", length = {third}}},
]
[rings]
"""


@pytest.fixture(scope="module")
def mesh():
    """Rings of the inner wall (n, 34, 3) and triangles (m, 3, 3), axes turned to east, north, up."""
    lines = [line.split() for line in MESH.read_text().splitlines()]
    vertices = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)[:, [0, 2, 1]]
    quads = np.array([[int(v.split("/")[0]) - 1 for v in line[1:]] for line in lines if line[:1] == ["f"]])
    rings = vertices.reshape(-1, SIDES, 3)
    centres = rings.mean(axis=1)
    inner = np.abs(np.linalg.norm(rings - centres[:, None], axis=-1) - WALL).max(axis=1) < 1e-3
    return centres[inner], vertices[np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])]


@pytest.fixture(scope="module")
def loop(mesh):
    """The simulated pipe with the loop's own lengths and bend radius, read off the mesh's rings."""
    centres, _ = mesh
    turning = (centres[:, 0] > 4.05) & (centres[:, 1] < 0.9)
    solved = np.linalg.lstsq(
        np.c_[2 * centres[turning, :2], np.ones(turning.sum())], (centres[turning, :2] ** 2).sum(axis=1), rcond=None
    )[0]
    radius = float(np.sqrt(solved[2] + solved[:2] @ solved[:2]))
    first = float(solved[0])
    between = float(centres[:, 1].max()) - 2.0 * radius
    text = SCENARIO.format(first=first, radius=radius, second=between, third=3.0)
    return build_pipe(parse(text).pipe), radius, first, between


def cast_on_mesh(triangles: np.ndarray, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Return the distance to the first triangle along each ray (Moller and Trumbore)."""
    near = triangles[np.linalg.norm(triangles[:, 0] - origin, axis=-1) < 2.0]
    edge1, edge2 = near[:, 1] - near[:, 0], near[:, 2] - near[:, 0]
    normal = np.cross(rays[:, None], edge2)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / np.sum(edge1 * normal, axis=-1)
        away = origin - near[:, 0]
        u = np.sum(away * normal, axis=-1) * scale
        turned = np.cross(away, edge1)
        v = rays @ turned.T * scale
        distance = np.sum(edge2 * turned, axis=-1) * scale
        hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (distance > 1e-9)
    return np.where(hit, distance, np.inf).min(axis=1)


def test_the_mesh_has_the_bends_it_says(loop):
    _, radius, first, between = loop
    assert radius == pytest.approx(BEND, abs=0.01)
    assert (first, between) == pytest.approx((4.0, 2.0), abs=0.02)


@pytest.mark.parametrize("pose", [(0.0, 0.0, 0.0), (0.25, -0.2, 0.5), (-0.15, 0.35, 1.0)])
def test_rings_through_both_bends_agree_to_the_facets(mesh, loop, pose):
    from springline.simulate.attitude import in_pipe

    _, triangles = mesh
    pipe, radius, first, between = loop
    arc = 0.5 * np.pi * radius
    straight, turning = np.linspace(1.0, first - 0.5, 4), np.linspace(0.1, 0.9, 5) * arc
    chainage = np.concatenate([straight, first + turning, first + arc + between + turning])
    point, frame = pipe.centreline.at(chainage)
    origin = point + 0.03 * frame[:, 1] - 0.04 * frame[:, 2]
    axes = in_pipe(*pose) @ frame
    bearing = np.arange(48) * (2.0 * np.pi / 48)
    rays = np.cos(bearing)[:, None] * axes[:, None, 2] + np.sin(bearing)[:, None] * axes[:, None, 1]
    ours, _, _ = cast_rays(build(pipe), origin, pipe.centreline.find(origin, chainage), rays, 5.0)
    theirs = np.stack([cast_on_mesh(triangles, o, r) for o, r in zip(origin, rays, strict=True)])
    # A chord lies inside its arc by r (1 - cos(half the step)): around the wall, and along the bend's outer wall.
    facet = WALL * (1.0 - np.cos(np.pi / SIDES))
    along = (radius + WALL) * (1.0 - np.cos(np.radians(90.0 / STEPS / 2)))
    slant = 1.0 / np.cos(np.max(np.abs(pose[:2])) + 0.25)
    assert np.abs(ours - theirs)[:4].max() < 1.5 * facet * slant
    assert np.abs(ours - theirs).max() < 1.5 * (facet + along) * slant
    # Where the pipe is straight the mesh lies inside the round wall.
    assert np.mean((ours - theirs)[:4]) > 0.0
