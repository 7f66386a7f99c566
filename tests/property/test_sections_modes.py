"""Modes 1 to 5 over the whole valid range, the limits included, against rigidly moved arcs and their polygons."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from tests.unit.geometry.sections.polygons import measures, swung_quarters

from springline.geometry.sections import Section, chord, hinged, s1_limits

FRACTION = st.floats(0.0, 1.0)
RULE = st.sampled_from(["exact", "ramanujan"])


@st.composite
def severities(draw):
    """Draw (mode, s1, s02, s01, rule) from the whole valid range; both limits of each have weight."""
    rule, mode = draw(RULE), draw(st.sampled_from([1, 2, 3, 4, 5]))
    s02 = draw(st.floats(0.1, 1.0))
    s01 = 1.0
    if mode == 5:
        low = float(s1_limits(4, s02, rule=rule)[0])
        s01 = min(low + draw(FRACTION) * (s02 - low), s02)
    low, high = (float(x) for x in s1_limits(mode, s02, s01, rule=rule))
    low = max(low, 0.05)
    assume(low <= high)
    return mode, min(low + draw(FRACTION) * (high - low), high), s02, s01, rule


@settings(max_examples=60, deadline=None)
@given(severities())
@example((1, 1.0, 1.0, 1.0, "exact"))
@example((4, 0.7, 0.7, 1.0, "exact"))
@example((5, 0.6, 0.8, 0.6, "ramanujan"))
@example((3, float(s1_limits(3)[0]), 1.0, 1.0, "exact"))
def test_area_and_perimeter_are_those_of_the_moved_arcs(case):
    *parameters, rule = case
    section = hinged(*parameters, rule=rule)
    top, bottom = section.top, section.bottom
    pieces = swung_quarters((top.a, bottom.a), (section.s02, section.s01), (section.s2, section.s1))
    area, length = measures(pieces, levels=10)
    assert section.area == pytest.approx(area, rel=1e-9, abs=1e-12)
    assert section.perimeter == pytest.approx(length, rel=1e-9)
    if rule == "exact":
        assert section.perimeter == pytest.approx(2 * np.pi, rel=1e-12)


@settings(max_examples=60, deadline=None)
@given(severities(), st.floats(0.01, 100.0))
def test_radius_chords_and_calipers_are_those_of_the_moved_arcs(case, r):
    *parameters, rule = case
    section = hinged(*parameters, r=r, rule=rule)
    top, bottom = section.top, section.bottom
    pieces = swung_quarters((top.a / r, bottom.a / r), (section.s02, section.s01), (section.s2, section.s1))
    u = np.linspace(0.0, 1.0, 801)
    z, y = (r * np.concatenate(axis) for axis in zip(*(piece(u) for piece in pieces), strict=True))
    # on a ray along which the contour leaves O the angle no longer tells the point
    clear = np.hypot(z, y) > 1e-3 * r
    np.testing.assert_allclose(
        section.polar_radius(np.arctan2(y, z))[clear], np.hypot(z, y)[clear], rtol=1e-8, atol=1e-9 * r
    )
    theta = np.linspace(-np.pi / 2, np.pi / 2, 721)
    assert np.all(section.chord(theta) <= section.largest_chord.length * (1 + 1e-12))
    assert np.all(section.chord(theta) >= section.smallest_chord.length * (1 - 1e-9) - 1e-9 * r)
    assert section.width == pytest.approx(np.ptp(z), rel=1e-9)
    assert section.height == pytest.approx(np.ptp(y), rel=1e-5)
    assert section.height >= np.ptp(y) * (1 - 1e-12)
    assert section.height >= section.smallest_chord.length * (1 - 1e-12)


@settings(max_examples=40, deadline=None)
@given(severities())
@example((5, 0.2767796260059612, 0.390625, 0.2767796260059622, "exact"))
@example((4, 0.2767796260059622, 0.390625, 1.0, "exact"))
def test_means_lie_between_the_extremes_and_agree_with_integrals(case):
    *parameters, rule = case
    section = hinged(*parameters, rule=rule)
    found = section.diameters
    assert section.mean_radius == pytest.approx(Section._mean_radius(section), rel=1e-8)
    if section.s2 > 1e-3:  # nearer to O, samples by bearing no longer tell the arcs beside the crown
        assert section.hull_perimeter == pytest.approx(Section._hull_perimeter(section), rel=1e-8)
    for mean in (found.axes, found.polar, found.area, found.caliper):
        assert found.smallest.length * (1 - 1e-12) <= mean <= found.largest.length * (1 + 1e-12)
    assert found.polar <= found.area * (1 + 1e-12) <= found.caliper * (1 + 1e-9)
    assert section.hull_perimeter <= section.perimeter * (1 + 1e-12)


@settings(max_examples=60, deadline=None)
@given(severities())
def test_severities_stay_in_their_order_and_share_the_springline(case):
    *parameters, rule = case
    section = hinged(*parameters, rule=rule)
    assert 0.0 <= section.s2 <= section.s1 * (1 + 1e-9) + 1e-9
    springline = chord(section.s02, rule=rule) ** 2 - section.s2**2
    assert section.springline**2 == pytest.approx(springline, rel=1e-12)
    assert section.area <= np.pi * (1 + 1e-4)
