"""Rings cast on a CAD mesh of a pipe loop, made by others, against the closed forms; skipped where it is absent."""

from __future__ import annotations

import numpy as np
import pytest
from tests import cad_mesh
from tests.cad_mesh import FACET, STEPS, WALL

from springline.geometry.bends import fit_bend, ring_bend
from springline.geometry.robot import frame, ring_cylinder

BEND_FACET = FACET + (1.0 + WALL) * (1 - np.cos(np.radians(90 / STEPS / 2)))
"""Depth of a facet around the wall and of one along the outer wall of a bend [m]."""

pytestmark = cad_mesh.NEEDED


@pytest.fixture(scope="module")
def mesh():
    """Vertices (n, 3) turned to x forward, y up (the first bend turns up), z right; and triangles (m, 3, 3)."""
    vertices, quads = cad_mesh.read()
    vertices *= [1, 1, -1]
    return vertices, cad_mesh.triangles(vertices, quads)


@pytest.fixture(scope="module")
def bend(mesh):
    """Centre and radius of the first bend."""
    centres, inner = cad_mesh.inner_rings(mesh[0])
    return cad_mesh.first_bend(centres[inner])


def ring_points(triangles, origin, axes, phi):
    directions = np.cos(phi)[:, None] * axes[2] + np.sin(phi)[:, None] * axes[1]
    radius = cad_mesh.cast(cad_mesh.within(triangles, origin, 1.0), origin, directions)
    return radius, origin + radius[:, None] * directions


PHI = np.linspace(0, 2 * np.pi, 72, endpoint=False)


@pytest.mark.parametrize("pose", [(0, 0, 0), (10, -5, 20), (-20, 15, 0)])
def test_rings_in_the_straight_agree_to_the_facets(mesh, pose):
    offset = np.array([0.03, -0.02])
    origin = np.array([2.0, *offset])
    radius, _ = ring_points(mesh[1], origin, frame(*np.radians(pose)), PHI)
    closed = ring_cylinder(PHI, WALL, WALL, *np.radians(pose), offset=offset)
    # The mesh lies inside the circle by up to a facet, seen under the ring's tilt and from beside the axis.
    assert np.abs(radius - closed).max() < 1.3 * FACET
    assert np.mean(closed - radius) > 0


@pytest.mark.parametrize("turn", [30.0, 45.0, 60.0])
@pytest.mark.parametrize("pose", [(0, 0, 0), (10, -5, 20), (-15, 15, 0)])
def test_rings_in_the_bend_agree_to_the_facets(mesh, bend, turn, pose):
    centre, bend_radius = bend
    assert bend_radius == pytest.approx(1.0, abs=0.01)
    turn = np.radians(turn)
    forward, inward = np.array([np.cos(turn), np.sin(turn), 0]), np.array([-np.sin(turn), np.cos(turn), 0])
    pipe = np.stack([forward, inward, [0, 0, 1.0]])
    offset = np.array([0.03, -0.02])
    origin = np.array([*centre, 0]) - bend_radius * inward + offset[0] * inward + [0, 0, offset[1]]
    radius, _ = ring_points(mesh[1], origin, frame(*np.radians(pose)) @ pipe, PHI)
    closed = ring_bend(PHI, bend_radius, WALL, WALL, *np.radians(pose), offset=offset)
    assert np.abs(radius - closed).max() < 1.5 * BEND_FACET


def test_a_bend_fitted_to_mesh_rings_is_the_meshs_bend(mesh, bend):
    rng = np.random.default_rng(1)
    centre, bend_radius = bend
    chainage = np.linspace(-0.8, 0.5 * np.pi * bend_radius + 0.7, 30)
    turn = np.clip(chainage / bend_radius, 0, np.pi / 2)
    rest = chainage - bend_radius * turn
    rings = []
    for angle, straight in zip(turn, rest, strict=True):
        forward, inward = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
        axes = frame(*np.radians(rng.uniform(-8, 8, size=3))) @ np.stack([forward, inward, [0, 0, 1.0]])
        origin = np.array([*centre, 0]) - bend_radius * inward + straight * forward + rng.uniform(-0.03, 0.03, 3)
        rings.append(ring_points(mesh[1], origin, axes, PHI)[1])
    found = fit_bend(np.array(rings))
    assert found
    assert found.bend_radius == pytest.approx(bend_radius, rel=0.01)
    assert np.degrees(found.angle) == pytest.approx(90, abs=0.5)
    assert found.r1 == pytest.approx(WALL, abs=FACET)
    assert np.degrees(found.bearing()) == pytest.approx(90, abs=0.5)
    assert found.rms < FACET
    np.testing.assert_allclose(found.centre, [*centre, 0], atol=0.01)
