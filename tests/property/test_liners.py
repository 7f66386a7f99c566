"""Liners over their whole ranges: polygons, boundary conditions, successors, invariances."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from tests.unit.geometry.sections.polygons import measures, polar_pieces

from springline.geometry.liners import (
    DEEPEST_K,
    LARGEST_D0,
    Lobe,
    SmoothLobe,
    chicurel_arc_ratio,
    chicurel_height,
    chicurel_lobed,
    chicurel_protrusion,
    conformity,
    conserving_smooth_oc,
    host_polar,
    lined,
    lobe_arc,
    lobed,
    quasi_ellipse,
    smooth_lobed,
)

ASPECT = st.floats(0.6, 1.6)
BEARING = st.floats(-np.pi, np.pi)
PHI = st.floats(0.02, np.pi / 2)
LEFT = st.floats(0.3, 1.0)
POWER = st.floats(1.0, 8.0)


@st.composite
def liners(draw):
    """Draw a liner of any kind in a host with r2 = 1."""
    r1, bearing, phi = draw(ASPECT), draw(BEARING), draw(PHI)
    oc = draw(LEFT) * float(host_polar(bearing, r1, 1.0)[0])
    kind = draw(st.sampled_from(["lobe", "smooth", "chicurel", "quasi", "two"]))
    if kind == "lobe":
        return lobed(r1, 1.0, phi, oc, draw(POWER), bearing)
    if kind == "smooth":
        return smooth_lobed(r1, 1.0, phi, oc, 1.0 + draw(POWER), bearing)
    if kind == "chicurel":
        return chicurel_lobed(r1, 1.0, draw(st.floats(0.05, DEEPEST_K - 0.02)), bearing)
    if kind == "quasi":
        return quasi_ellipse(r1, draw(st.floats(0.0, 0.98)) * LARGEST_D0 * r1)
    return lined(r1, 1.0, Lobe(phi, oc, 2.0, bearing), SmoothLobe(phi, oc, 3.0, bearing + np.pi))


@settings(max_examples=40, deadline=None)
@given(liners())
def test_area_and_perimeter_are_those_of_polygons(liner):
    area, length = measures(polar_pieces(liner), levels=10)
    assert liner.area == pytest.approx(area, rel=2e-9)
    assert liner.perimeter == pytest.approx(length, rel=2e-9)


@settings(max_examples=60, deadline=None)
@given(ASPECT, PHI, LEFT, POWER, BEARING)
@example(1.0, np.pi / 2, 1.0, 2.0, 0.0)
def test_the_published_lobe_meets_its_three_conditions(r1, phi, left, p, bearing):
    oc = left * float(host_polar(bearing, r1, 1.0)[0])
    lobe = Lobe(phi, oc, p, bearing)
    for side in (-1.0, 1.0):
        radius, slope, second = lobe.polar(side * phi, r1, 1.0)
        edge, host_slope, _ = host_polar(bearing + side * phi, r1, 1.0)
        assert radius == pytest.approx(edge, rel=1e-12)
        assert slope == pytest.approx(host_slope, rel=1e-9, abs=1e-9 / phi)
        assert second == pytest.approx(lobe.edge_second(r1, 1.0, side=side), rel=1e-9, abs=1e-9 / phi**2)
        assert lobe.polar(0.0, r1, 1.0, side=side)[0] == pytest.approx(oc, rel=1e-12)


@settings(max_examples=40, deadline=None)
@given(ASPECT, PHI, LEFT, POWER)
def test_on_an_axis_the_lobe_is_symmetric(r1, phi, left, p):
    offset = np.linspace(-phi, phi, 20)  # without the centre, where p = 1 has its kink
    for bearing in (np.pi / 2, -np.pi / 2, 0.0, np.pi):
        lobe = Lobe(phi, left * float(host_polar(bearing, r1, 1.0)[0]), p, bearing)
        radius, slope, _ = lobe.polar(offset, r1, 1.0)
        np.testing.assert_allclose(radius, radius[::-1], rtol=1e-12)
        np.testing.assert_allclose(slope, -slope[::-1], rtol=1e-9, atol=1e-9 / phi)


@settings(max_examples=25, deadline=None)
@given(ASPECT, st.floats(0.05, 0.9), st.floats(2.5, 6.0), BEARING)
def test_the_conserving_smooth_lobe_keeps_all_four_promises(r1, phi, n, bearing):
    try:
        oc = conserving_smooth_oc(r1, 1.0, phi, n, bearing)
    except ValueError:
        assume(False)
    found = conformity(smooth_lobed(r1, 1.0, phi, oc, n, bearing), tolerance=1e-7)
    assert found.inside
    assert found.slope_continuous
    assert found.length_conserved
    assert lobe_arc(SmoothLobe(phi, oc, n, bearing), r1, 1.0) > 0
    # a power near 2 falls off so slowly at the edge that its last float still shows
    assert found.curvature_jump < 1e-4 if n < 3 else found.curvature_continuous


@settings(max_examples=40, deadline=None)
@given(st.floats(1e-3, 0.999))
@example(1e-6)
@example(1 - 1e-6)
def test_chicurels_lobe_always_leaves_the_host_and_stretches(k):
    protrusion, where = chicurel_protrusion(k)
    assert protrusion > 0
    assert 0 < where <= 0.5
    assert chicurel_arc_ratio(k) > 1 - 1e-12
    z = np.array([0.0, 0.3, 0.7, 1.0]) * 2 * k
    height = chicurel_height(z, k)
    assert height[0] == pytest.approx(height[-1], abs=1e-9)
    assert height[1] == pytest.approx(height[2], rel=1e-9, abs=1e-15)
