"""Four hinges anywhere: rigid bars, the symmetric case against mode 2, the area against errata E."""

import numpy as np
import pytest
from tests.unit.geometry.sections.polygons import measures, polar_pieces

from springline.errors import ParameterError
from springline.geometry.sections import closing_lower, hinged, linkage
from springline.geometry.sections.ellipses import semi_major

QUARTERS = np.arange(4) * np.pi / 2
SKEWED = np.array([0.1, 1.3, 3.0, 4.9])


def test_hinges_at_the_quarters_are_mode_2_and_mode_5():
    theta = np.linspace(0, 2 * np.pi, 181)
    for s in (0.95, 0.8, 0.5):
        np.testing.assert_allclose(
            linkage(QUARTERS, s, r=0.3).polar_radius(theta), hinged(2, s, r=0.3).polar_radius(theta), rtol=1e-12
        )
    oval = linkage(QUARTERS, 0.7 / 0.8, s0=0.8)
    np.testing.assert_allclose(oval.polar_radius(theta), hinged(5, 0.7, 0.8, 0.8).polar_radius(theta), rtol=1e-12)


@pytest.mark.parametrize("s0", [1.0, 0.85])
def test_arcs_stay_rigid_and_the_area_is_segments_plus_quadrilateral(s0):
    section = linkage(SKEWED, 0.85, s0=s0, r=2.0)
    a, b = 2 * semi_major(s0), 2 * s0
    before = a * np.cos(SKEWED) + 1j * b * np.sin(SKEWED)
    after = section.pieces.node
    bars = np.abs(np.roll(before, -1) - before)
    np.testing.assert_allclose(np.abs(np.roll(after, -1) - after), bars, rtol=1e-12)
    assert np.abs(after[3] - after[1]) == pytest.approx(0.85 * np.abs(before[3] - before[1]))
    assert np.angle((after[2] - after[0]) / (before[2] - before[0])) == pytest.approx(0.0, abs=1e-12)

    def shoelace(p):
        return 0.5 * np.sum((np.conj(p) * np.roll(p, -1)).imag)

    segments = np.pi * a * b - shoelace(before)
    assert section.area == pytest.approx(segments + shoelace(after), rel=1e-12)
    assert section.perimeter == pytest.approx(4 * np.pi, rel=1e-12)
    area, length = measures(polar_pieces(section), levels=8)
    assert (section.area, section.perimeter) == pytest.approx((area, length), rel=1e-9)


def test_o_is_the_centroid_and_the_undeformed_pipe_is_the_circle():
    section = linkage(SKEWED, [1.0, 0.9])
    np.testing.assert_allclose(section[0].polar_radius(np.linspace(0, 6, 50)), 1.0, rtol=1e-12)
    moments = section.moments
    np.testing.assert_allclose([moments.centroid_z, moments.centroid_y], 0.0, atol=1e-12)
    assert section.diameters.ovality("polar")[0] == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(linkage(SKEWED, np.nan).area)


def test_the_skewed_section_leans():
    section = linkage(SKEWED, 0.8)
    assert abs(section.moments.zy) > 1e-3
    assert abs(linkage(QUARTERS, 0.8).moments.zy) < 1e-12
    assert section.largest_chord.bearing != pytest.approx(0.0, abs=0.01)


def test_what_cannot_be_built_is_refused():
    low = closing_lower(SKEWED)
    with pytest.raises(ParameterError, match=f"closing = {low:.10g} is out of range; expected {low:.10g} < closing"):
        linkage(SKEWED, low)
    with pytest.raises(ParameterError, match=r"closing = 1\.01 is out of range"):
        linkage(SKEWED, 1.01)
    with pytest.raises(ParameterError, match="not four in order"):
        linkage([0.0, 2.0, 1.0, 4.0], 0.9)
    with pytest.raises(ParameterError, match="seen whole from O"):
        linkage([0.0, 0.3, 2.0, 4.9], 0.72)
