"""Modes 1 to 5 against a rigid motion of the parent arcs, and against the errata's numbers."""

import numpy as np
import pytest
from tests.unit.geometry.sections.polygons import swung_quarters

from springline.errors import ParameterError
from springline.geometry.sections import Section, hinge, hinged, s1_limits

CASES = [
    (1, 0.8, 1, 1),
    (2, 0.9, 1, 1),
    (2, 0.05, 1, 1),
    (3, 0.9, 1, 1),
    (3, 0.4635, 1, 1),
    (4, 0.7, 0.8, 1),
    (4, 0.16, 0.2, 1),
    (5, 0.5, 0.8, 0.6),
    (5, 0.5, 0.7, 0.7),
]


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("rule", ["exact", "ramanujan"])
def test_contour_is_the_parent_arcs_moved_rigidly(case, rule):
    section = hinged(*case, r=2.0, rule=rule)
    top, bottom = section.top, section.bottom
    pieces = swung_quarters((top.a / 2, bottom.a / 2), (section.s02, section.s01), (section.s2, section.s1))
    u = np.linspace(0.02, 0.98, 49)
    for quadrant, piece in enumerate(pieces):
        z, y = piece(u)
        theta = np.arctan2(y, z)
        np.testing.assert_allclose(section.polar_radius(theta), 2 * np.hypot(z, y), rtol=1e-11, atol=1e-12)
        zt, yt = section.contour_point((quadrant + u) * np.pi / 2)
        np.testing.assert_allclose((zt, yt), (2 * z, 2 * y), atol=1e-12)


@pytest.mark.parametrize("case", CASES)
def test_slope_and_curvature_follow_from_the_radius(case):
    section = hinged(*case, r=0.5, inverted=True)
    theta = np.concatenate([q * np.pi / 2 + np.linspace(0.1, np.pi / 2 - 0.1, 9) for q in range(4)])
    step = 1e-5
    r = section.polar_radius(theta + step * np.arange(-2, 3)[:, None])
    first = (r[0] - 8 * r[1] + 8 * r[3] - r[4]) / (12 * step)
    np.testing.assert_allclose(section.polar_slope(theta), first, atol=2e-9)
    slope = section.polar_slope(theta + step * np.array([[-1.0], [1.0]]))
    second = (slope[1] - slope[0]) / (2 * step)
    radius = section.polar_radius(theta)
    bend = (radius**2 + 2 * first**2 - radius * second) / (radius**2 + first**2) ** 1.5
    np.testing.assert_allclose(section.curvature(theta), bend, rtol=1e-4, atol=1e-4)


@pytest.mark.parametrize("case", CASES)
def test_closed_forms_agree_with_what_the_interface_integrates_and_searches(case):
    section = hinged(*case)
    for name in ("area", "perimeter", "mean_radius"):
        assert getattr(section, name) == pytest.approx(getattr(Section, f"_{name}")(section), rel=1e-9)
    assert section.hull_perimeter == pytest.approx(Section._hull_perimeter(section), rel=2e-9)
    for name in ("largest_chord", "smallest_chord"):
        closed, searched = getattr(section, name), getattr(Section, f"_{name}")(section)
        assert closed.length == pytest.approx(searched.length, rel=1e-12, abs=1e-12)
    direction = np.linspace(-3, 3, 31)
    np.testing.assert_allclose(section.support(direction), Section._support(section, direction), rtol=1e-9)


def test_equal_modes_are_one_construction():
    theta = np.linspace(0, 2 * np.pi, 73)
    for one, other in [
        ((1, 0.8), (5, 0.8, 0.8, 0.8)),
        ((2, 0.8), (5, 0.8, 1.0, 1.0)),
        ((3, 0.8), (4, 0.8, 1.0)),
        ((4, 0.8, 0.9), (5, 0.8, 0.9, 0.8)),
    ]:
        np.testing.assert_allclose(hinged(*one).polar_radius(theta), hinged(*other).polar_radius(theta), rtol=1e-14)


def test_a_batch_of_mixed_modes_equals_its_members():
    modes = np.array([1, 2, 3, 4, 5])
    s1, s02, s01 = np.array([0.9, 0.8, 0.7, 0.85, 0.5]), np.array([1, 1, 1, 0.9, 0.8]), np.array([1, 1, 1, 1, 0.6])
    batch = hinged(modes, s1, s02, s01, r=np.arange(1.0, 6.0))
    theta = np.linspace(0, 6, 13)
    own = np.tile(theta, (5, 1)) + np.arange(5)[:, None]
    for i in range(5):
        alone = hinged(modes[i], s1[i], s02[i], s01[i], r=i + 1.0)
        np.testing.assert_array_equal(batch.polar_radius(theta)[i], alone.polar_radius(theta))
        np.testing.assert_array_equal(batch.polar_radius(own)[i], alone.polar_radius(own[i]))
        np.testing.assert_array_equal(batch[i].polar_radius(theta), alone.polar_radius(theta))
        for name in ("axes", "polar", "area", "caliper"):
            assert getattr(batch.diameters, name)[i] == pytest.approx(getattr(alone.diameters, name), rel=1e-14)
    assert batch[1:3].area.shape == (2,)


def test_upside_down_exchanges_top_and_bottom():
    section = hinged(4, 0.7, 0.8)
    turned = section.flipped()
    theta = np.linspace(0, 6, 31)
    np.testing.assert_array_equal(turned.polar_radius(theta), section.polar_radius(-theta))
    assert turned.crown_dip == section.invert_dip
    assert turned.invert_dip == section.crown_dip > 0
    (z, y), (z_upright, y_upright) = turned.contour_point(0.3), section.contour_point(-0.3)
    assert z == pytest.approx(z_upright)
    assert y == pytest.approx(-y_upright)


def test_area_losses_of_the_errata():
    expected = {1: 30.3, 2: 21.6, 3: 36.2, 4: 34.3, 5: 29.2}
    for mode, percent in expected.items():
        assert 100 * hinged(mode, 0.5, 0.8, 0.6).area_loss(1.0) == pytest.approx(percent, abs=0.05)
    for mode, s1 in {1: 0.8536, 2: 0.8346, 3: 0.8506}.items():
        assert 100 * hinged(mode, s1).area_loss(1.0) == pytest.approx(3.0, abs=2e-3)


def test_the_crown_is_a_dip():
    assert hinged(2, 0.9).height == pytest.approx(1.80913, abs=5e-6)
    assert hinged(2, 0.5).height == pytest.approx(1.177, abs=5e-4)
    assert hinged(1, 0.9).crown_dip == pytest.approx(0.0, abs=1e-15)


def test_the_circle_is_the_circle_in_every_mode():
    for mode in range(1, 6):
        circle = hinged(mode, 1.0, r=0.2).diameters
        for value in (circle.largest.length, circle.smallest.length, circle.polar, circle.area, circle.caliper):
            assert value == pytest.approx(0.4, rel=1e-14)
        assert circle.ovality("polar") == pytest.approx(0.0, abs=1e-14)


def test_hinge_opening_upward_is_refused():
    with pytest.raises(ParameterError, match=r"s = 0\.9 is out of range; expected 0 < s <= 0\.8 with s0 = 0\.8"):
        hinge(0.8, 0.9)
    closed = hinge(0.8, 0.8, 3.0)
    assert closed.alpha == pytest.approx(0.0, abs=1e-15)
    assert (closed.centre_z, closed.centre_y) == pytest.approx((0.0, 0.0), abs=1e-15)


def test_stations_without_a_section_stay_unknown():
    batch = hinged(3, [0.9, np.nan])
    assert np.isfinite(batch.area[0])
    assert np.isnan(batch.area[1])
    assert np.isnan(batch.polar_radius([0.0, 1.0])[1]).all()
    assert np.isnan(batch.polar_slope([0.0, 1.0])[1]).all()
    assert np.isnan(batch.diameters.caliper[1])
    low, _ = s1_limits(5, 0.8, [0.6, np.nan])
    assert np.isnan(low[1])
