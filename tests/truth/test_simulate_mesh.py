"""The simulator's bends against a CAD mesh of a pipe loop that others made; skipped where it is absent."""

from __future__ import annotations

import numpy as np
import pytest
from tests import cad_mesh
from tests.cad_mesh import FACET, STEPS, WALL

from springline.simulate.building import build_pipe
from springline.simulate.cast import cast_rays
from springline.simulate.reading import parse
from springline.simulate.wall import build

pytestmark = cad_mesh.NEEDED

BEND = 1.0
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
    """Centres of the inner wall's rings (n, 3) and triangles (m, 3, 3), axes turned to east, north, up."""
    vertices, quads = cad_mesh.read()
    centres, inner = cad_mesh.inner_rings(vertices)
    return centres[inner], cad_mesh.triangles(vertices, quads)


@pytest.fixture(scope="module")
def loop(mesh):
    """The simulated pipe with the loop's own lengths and bend radius, read off the mesh's rings."""
    centres, _ = mesh
    middle, radius = cad_mesh.first_bend(centres)
    first = float(middle[0])
    between = float(centres[:, 1].max()) - 2.0 * radius
    text = SCENARIO.format(first=first, radius=radius, second=between, third=3.0)
    return build_pipe(parse(text).pipe), radius, first, between


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
    theirs = np.stack(
        [cad_mesh.cast(cad_mesh.within(triangles, o, 1.0), o, r) for o, r in zip(origin, rays, strict=True)]
    )
    # A chord lies inside its arc by r (1 - cos(half the step)): around the wall, and along the bend's outer wall.
    along = (radius + WALL) * (1.0 - np.cos(np.radians(90.0 / STEPS / 2)))
    slant = 1.0 / np.cos(np.max(np.abs(pose[:2])) + 0.25)
    assert np.abs(ours - theirs)[:4].max() < 1.5 * FACET * slant
    assert np.abs(ours - theirs).max() < 1.5 * (FACET + along) * slant
    # Where the pipe is straight the mesh lies inside the round wall.
    assert np.mean((ours - theirs)[:4]) > 0.0
