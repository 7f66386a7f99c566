"""Shapes of arcs and lines against polygons, and against the numbers of the errata."""

from itertools import pairwise

import numpy as np
import pytest
from tests.unit.geometry.sections.polygons import measures, polar_pieces

from springline.errors import ParameterError
from springline.geometry.sections import (
    SHAPES,
    Arc,
    Corner,
    Line,
    Section,
    arch,
    box,
    circle,
    egg,
    egg_side_radius,
    ellipse,
    horseshoe,
    inverted_horseshoe,
    loaf,
    symmetric,
)

listed = pytest.mark.parametrize("name", SHAPES)


def build(name):
    return SHAPES[name].build(*SHAPES[name].example)


@listed
def test_area_and_perimeter_are_those_of_polygons(name):
    section = build(name)
    area, length = measures(polar_pieces(section), levels=8)
    assert section.area == pytest.approx(area, rel=1e-9)
    assert section.perimeter == pytest.approx(length, rel=1e-9)
    assert Section._area(section) == pytest.approx(area, rel=1e-9)
    assert Section._perimeter(section) == pytest.approx(length, rel=1e-9)


@listed
def test_slope_and_curvature_follow_from_the_radius(name):
    section = build(name)
    edges = np.append(section.breaks, section.breaks[0] + 2 * np.pi)
    theta = np.concatenate([np.linspace(a, b, 9)[1:-1] for a, b in pairwise(edges) if b - a > 1e-3])
    step = 1e-4 * np.min(np.diff(edges)[np.diff(edges) > 1e-3])
    r = section.polar_radius(theta + step * np.arange(-2, 3)[:, None])
    slope = (r[0] - 8 * r[1] + 8 * r[3] - r[4]) / (12 * step)
    np.testing.assert_allclose(section.polar_slope(theta), slope, rtol=1e-6, atol=1e-6)
    around = section.polar_slope(theta + step * np.array([[-1.0], [1.0]]))
    second = (around[1] - around[0]) / (2 * step)
    radius = section.polar_radius(theta)
    bend = (radius**2 + 2 * slope**2 - radius * second) / (radius**2 + slope**2) ** 1.5
    np.testing.assert_allclose(section.curvature(theta), bend, rtol=1e-4, atol=1e-4)


@listed
def test_calipers_and_extremes_agree_with_the_contour(name):
    section = build(name)
    z, y = section.contour(np.concatenate([np.linspace(0, 2 * np.pi, 20001), section.breaks]))
    direction = np.linspace(-np.pi, np.pi, 25)
    reach = np.max(z * np.cos(direction[:, None]) + y * np.sin(direction[:, None]), axis=-1)
    np.testing.assert_allclose(section.support(direction), reach, rtol=1e-6)
    np.testing.assert_allclose(section.support(direction), Section._support(section, direction), rtol=1e-9)
    assert section.hull_perimeter == pytest.approx(Section._hull_perimeter(section), rel=1e-8)
    chords = section.chord(np.concatenate([np.linspace(-np.pi / 2, np.pi / 2, 40001), section.breaks]))
    assert section.largest_chord.length == pytest.approx(chords.max(), rel=1e-7)
    assert section.smallest_chord.length == pytest.approx(chords.min(), rel=1e-7)
    for one in (section.largest_chord, section.smallest_chord):
        assert section.chord(one.bearing) == pytest.approx(one.length, rel=1e-12)
        assert -np.pi / 2 < one.bearing <= np.pi / 2


def test_constants_of_the_errata():
    assert egg_side_radius(2.0, 3.0, 0.25) == pytest.approx(8 / 3)
    for rho, area, length in ((0.5, 4.5941, 7.9299), (0.25, 4.4602, 7.8409)):
        sewer = egg(2.0, 3.0, rho)
        assert sewer.area == pytest.approx(area, abs=5e-5)
        assert sewer.perimeter == pytest.approx(length, abs=5e-5)
    sewer = horseshoe(1.0)
    corner = (np.sqrt(7) - 1) / 4
    at = np.arctan2(-corner, corner)
    assert (sewer.area, sewer.perimeter) == pytest.approx((0.82932, 3.26692), abs=5e-6)
    assert sewer.polar_radius(at) == pytest.approx(corner * np.sqrt(2))
    assert np.min(np.abs(sewer.breaks - (at + 2 * np.pi))) < 1e-12


def test_moments_of_shapes_with_known_ones():
    b, h = 1.5, 1.0
    m = box(b, h).moments
    assert (m.zz, m.yy, m.zy) == pytest.approx((h * b**3 / 12, b * h**3 / 12, 0.0), rel=1e-12, abs=1e-15)
    m = ellipse(0.6, 0.5, 0.3).moments
    major, minor = np.pi / 4 * 0.6**3 * 0.5, np.pi / 4 * 0.6 * 0.5**3
    assert m.zz == pytest.approx(major * np.cos(0.3) ** 2 + minor * np.sin(0.3) ** 2, rel=1e-12)
    assert m.zy == pytest.approx((major - minor) * np.sin(0.3) * np.cos(0.3), rel=1e-12)
    # a semicircle over a rectangle: O at the springline
    m = arch(2.0, 1.0, 1.0).moments
    centroid = (2 / 3 + np.pi / 2 * 0 - 2 * 0.5) / (np.pi / 2 + 2)
    assert m.centroid_y == pytest.approx(centroid, rel=1e-12)


def test_a_shape_turns_and_turns_over():
    sewer = egg([0.6, 0.8], [0.9, 1.2], [0.15, 0.1])
    theta = np.linspace(0, 2 * np.pi, 41)
    np.testing.assert_allclose(sewer.turned(0.7).polar_radius(theta), sewer.polar_radius(theta - 0.7), rtol=1e-12)
    np.testing.assert_allclose(sewer.flipped().polar_radius(theta), sewer.polar_radius(-theta), rtol=1e-12)
    np.testing.assert_allclose(sewer.flipped().area, sewer.area, rtol=1e-14)
    own = np.stack([theta, theta + 0.1])
    np.testing.assert_array_equal(sewer.polar_radius(own)[1], sewer[1].polar_radius(own[1]))
    np.testing.assert_allclose(sewer[1].area, egg(0.8, 1.2, 0.1).area)
    assert inverted_horseshoe(1.0).crown_dip == 0.0


def test_limits_of_the_shapes_meet_one_another():
    theta = np.linspace(0, 2 * np.pi, 100)
    round_egg = egg(1.0, 1.0, 0.2)
    np.testing.assert_allclose(round_egg.polar_radius(theta), 0.5, rtol=1e-12)
    assert loaf(1.0, 0.0, 0.5).area == pytest.approx(circle(0.5).area)
    assert loaf(1.0, 0.3, 0.0).area == pytest.approx(np.pi / 8 + 0.3)
    assert box(1.0, 1.0, 0.5).perimeter == pytest.approx(np.pi)
    assert box(1.0, 2.0).largest_chord.length == pytest.approx(np.sqrt(5.0))
    shallow = arch(2.0, 0.01, 0.5)
    assert shallow.area == pytest.approx(1.0 + 2 / 3 * 2 * 0.01, rel=1e-4)


def test_a_new_shape_is_a_short_table():
    gothic = symmetric([Corner(np.pi / 6), Arc(2.0, np.pi / 3), Corner(np.pi / 2), Line(1.0)], crown=np.sqrt(3) / 2)
    assert gothic.area == pytest.approx(2 * (np.pi / 6 * 4 - np.sqrt(3) / 2))
    assert gothic.width == pytest.approx(2.0)
    with pytest.raises(ParameterError, match=r"ends 0\.5 beside the axis"):
        symmetric([Line(1.0), Corner(np.pi / 2), Line(1.0), Corner(np.pi / 2), Line(0.5)], crown=0.5)
    with pytest.raises(ParameterError, match="O lies outside"):
        symmetric([Line(1.0), Corner(np.pi / 2), Line(1.0), Corner(np.pi / 2), Line(1.0)], crown=2.5)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: egg(2.0, 1.9, 0.5), "height = 1.9 is out of range; expected 2 <= height < inf with width = 2"),
        (lambda: egg(2.0, 3.0, 1.0), "invert_radius = 1 is out of range; expected 0 < invert_radius < 1"),
        (lambda: loaf(2.0, 1.0, 1.1), "fillet = 1.1 is out of range; expected 0 <= fillet <= 1 with width = 2"),
        (lambda: loaf(2.0, -0.1, 0.5), "wall = -0.1 is out of range"),
        (lambda: arch(2.0, 1.2, 1.0), "rise = 1.2 is out of range; expected 0 < rise <= 1 with width = 2"),
        (lambda: box(1.0, 2.0, 0.6), "fillet = 0.6 is out of range; expected 0 <= fillet <= 0.5"),
        (lambda: horseshoe([1.0, 0.0]), "element 1: diameter = 0 is out of range"),
    ],
)
def test_out_of_range_is_refused(call, message):
    with pytest.raises(ParameterError) as refused:
        call()
    assert message in str(refused.value)
