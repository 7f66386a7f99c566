"""True sections against facts that need none of the simulator's own formulas."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipe

from springline.errors import ParameterError
from springline.simulate.measures import measure
from springline.simulate.sections import Section, ellipse, ellipse_major, mode
from springline.simulate.shapes import arch, box, egg, horseshoe, loaf, upside_down

THETA = np.linspace(0.0, 2.0 * np.pi, 721)
FINE = (np.arange(400_000) + 0.5) * (2.0 * np.pi / 400_000)


def area(section: Section) -> float:
    return float(np.pi * np.mean(section.radius(FINE) ** 2))


def length(section: Section) -> float:
    theta = FINE - FINE[0]  # so that the hinges are points of the polygon
    r = section.radius(theta)
    z, y = r * np.cos(theta), r * np.sin(theta)
    return float(np.hypot(np.diff(z, append=z[0]), np.diff(y, append=y[0])).sum())


def test_an_ellipse_satisfies_its_equation_at_any_turn():
    turn = 0.4
    r = ellipse(0.2, 0.15, turn).radius(THETA)
    along, across = r * np.cos(THETA - turn), r * np.sin(THETA - turn)
    assert np.allclose((along / 0.2) ** 2 + (across / 0.15) ** 2, 1.0, atol=1e-13)


@pytest.mark.parametrize("s", [1.0, 0.97, 0.8, 0.5, 0.3])
def test_the_ellipse_keeps_the_circles_length(s):
    a = float(ellipse_major(0.3, s))
    b = 0.3 * s
    assert 4.0 * a * ellipe(1.0 - (b / a) ** 2) == pytest.approx(2.0 * np.pi * 0.3, rel=1e-13)


def test_ramanujan_major_axis_is_the_published_closed_form():
    s = np.array([0.99, 0.9, 0.7, 0.5])
    printed = (3.0 - 2.0 * s + np.sqrt(3.0 + 6.0 * s - 5.0 * s**2)) / 3.0
    assert np.allclose(ellipse_major(1.0, s, "ramanujan"), printed, rtol=1e-13)


@pytest.mark.parametrize(
    ("number", "given"),
    [(1, (0.9,)), (2, (0.85,)), (3, (0.9,)), (4, (0.88, 0.96)), (5, (0.84, 0.97, 0.9))],
)
def test_modes_keep_the_pipes_length_close_and_stand_on_their_hinges(number, given):
    section = mode(number, 0.15, *given)
    # Every arc is a rigid piece of a curve as long as the circle.
    assert length(section) == pytest.approx(2.0 * np.pi * 0.15, rel=1e-9)
    edges = np.arange(4) * 0.5 * np.pi
    assert np.allclose(section.radius(edges + 1e-12), section.radius(edges - 1e-12), atol=1e-11)
    assert section.radius(1.5 * np.pi) == pytest.approx(0.15 * given[0], rel=1e-12)


def test_a_hinged_arc_is_the_rigid_copy_of_its_ellipse():
    """Distances between points of the swung arc equal those on the unmoved ellipse."""
    s0, s1 = 0.95, 0.9
    swung, still = mode(4, 1.0, s1, s0), ellipse(float(ellipse_major(1.0, s0)), s0)
    t = np.linspace(0.05, 0.5 * np.pi - 0.05, 9)

    def curve(section, at):
        r = section.radius(at)
        return np.stack([r * np.cos(at), r * np.sin(at)], axis=-1)

    start, crown = curve(swung, 0.0), curve(swung, 0.5 * np.pi - 1e-15)
    a, b = curve(still, 0.0), curve(still, 0.5 * np.pi)
    assert np.linalg.norm(crown - start) == pytest.approx(np.linalg.norm(b - a), rel=1e-12)
    # A point of the still arc is known by its distances to both ends; it must be found on the swung arc.
    dense = curve(swung, np.linspace(1e-9, 0.5 * np.pi - 1e-9, 200_001))
    for point in curve(still, t):
        ends = np.linalg.norm(point - a), np.linalg.norm(point - b)
        misses = np.hypot(
            np.linalg.norm(dense - start, axis=1) - ends[0], np.linalg.norm(dense - crown, axis=1) - ends[1]
        )
        assert misses.min() < 1e-5


@pytest.mark.parametrize(
    ("section", "expected"),
    [
        (egg(2.0, 3.0, 0.5), 4.594130110),
        (egg(2.0, 3.0, 0.25), 4.4602),
        (horseshoe(1.0), 0.82932),
        (upside_down(horseshoe(1.0)), 0.82932),
        (loaf(2.0, 1.0, 0.25), np.pi / 2 + 2.5 - 2 * 0.25**2 * (1 - np.pi / 4)),
        (arch(2.0, 1.0, 0.5), np.pi / 2 + 1.0),
        (box(2.0, 1.0, 0.1), 2.0 - (4.0 - np.pi) * 0.01),
        (box(2.0, 1.0), 2.0),
    ],
)
def test_sewer_shapes_have_their_known_areas(section, expected):
    assert area(section) == pytest.approx(expected, abs=6e-5 if expected in (4.4602, 0.82932) else 1e-8)


@pytest.mark.parametrize("bad", [(1, (1.1,)), (1, (0.0,)), (3, (0.3,)), (4, (0.99, 0.9)), (5, (0.9, 0.9, 0.8))])
def test_impossible_severities_are_refused(bad):
    with pytest.raises(ParameterError, match="mode"):
        mode(bad[0], 0.15, *bad[1])


def test_measures_of_an_ellipse_are_its_own():
    a, b, turn = 0.16, 0.14, 0.3
    bearing = np.arange(1440) * (2.0 * np.pi / 1440)
    found = {name: value[0] for name, value in measure(ellipse(a, b, turn).radius(bearing)[None]).items()}
    assert found["diameter_max"] == pytest.approx(2 * a, rel=1e-10)
    assert found["diameter_min"] == pytest.approx(2 * b, rel=1e-10)
    assert found["area"] == pytest.approx(np.pi * a * b, rel=1e-12)
    assert found["diameter_caliper"] == pytest.approx(4 * a * ellipe(1 - (b / a) ** 2) / np.pi, rel=1e-10)
    across = 2.0 / np.hypot(np.cos(turn) / a, np.sin(turn) / b)
    assert found["diameter_x"] == pytest.approx(across, rel=1e-12)
    assert found["ovality_axes"] == pytest.approx((a - b) / (a + b), rel=1e-9)
