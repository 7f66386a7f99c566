"""What chapter 7 claims of its lobes, measured; the successors that keep the claims."""

import numpy as np
import pytest
from scipy.integrate import quad

from springline.errors import ParameterError
from springline.geometry.liners import (
    Lobe,
    SmoothLobe,
    chicurel_lobed,
    confined_oc,
    conformity,
    conserving_oc,
    conserving_smooth_oc,
    host_arc,
    host_polar,
    lobe_arc,
    lobe_protrusion,
    lobed,
    quasi_ellipse,
    smooth_lobed,
)


def radians(*degrees):
    return np.radians(degrees)


def test_stretch_of_the_published_figures():
    for phi, oc, percent in ((15, 8, 23.6), (30, 8, 1.6), (45, 8, -3.2), (30, 7, 8.3), (30, 6, 17.8)):
        lobe = Lobe(np.radians(phi), oc)
        arc = host_arc(np.pi / 2 - lobe.phi, np.pi / 2 + lobe.phi, 12.0, 10.0)
        assert 100 * (lobe_arc(lobe, 12.0, 10.0) / arc - 1) == pytest.approx(percent, abs=0.06)


def needed_depth(r1, degrees, p):
    """Return the percentage of r2 by which lobes must dip to stay inside, from their protrusion alone."""
    phi = np.radians(degrees)
    low, high = np.full(phi.shape, 0.5), np.ones(phi.shape)
    for _ in range(14):
        oc = 0.5 * (low + high)
        inside = lobe_protrusion(Lobe(phi, 10 * oc, p), r1, 10.0) < 1e-10
        low, high = np.where(inside, oc, low), np.where(inside, high, oc)
    return 100 * (1 - low)


def test_needed_depths_of_the_errata():
    degrees = np.array([30, 45, 60, 75, 90])
    depths = needed_depth(12.0, degrees, 2.0)
    assert depths == pytest.approx([0, 0.11, 1.3, 3.1, 2.0], abs=0.06)
    assert needed_depth(15.0, np.array([75, 90]), 2.0) == pytest.approx([20, 25], abs=0.6)
    assert needed_depth(np.array([12.0, 15.0]), np.array([30, 30]), 8.0) == pytest.approx([0.66, 1.6], abs=0.06)
    # the condition at the edge is necessary: it never asks for more
    local = 100 * (1 - confined_oc(12.0, 10.0, np.radians(degrees)) / 10)
    assert np.all(local <= depths + 1e-2)


def test_the_local_condition_is_what_the_protrusion_shows():
    phi = radians(45, 60, 75)
    least = confined_oc(12.0, 10.0, phi)
    assert np.all(lobe_protrusion(Lobe(phi, least + 0.02), 12.0, 10.0) > 1e-9)
    assert np.all(lobe_protrusion(Lobe(phi, least - 0.02), 12.0, 10.0) < 1e-12)
    # the shallow end of Figure 7.13, second row
    assert lobe_protrusion(Lobe(np.pi / 4, 10.0), 11.0, 10.0) == pytest.approx(6.6e-4, abs=5e-6)


def test_verdicts():
    published = conformity(lobed(12.0, 10.0, np.radians(30), 8.0))
    assert (published.inside, published.slope_continuous) == (True, True)
    assert (published.curvature_continuous, published.length_conserved) == (False, False)
    assert published.curvature_jump == pytest.approx(0.489 - 0.076, abs=6e-4)
    outside = conformity(lobed(12.0, 10.0, np.radians(60), 9.9))
    assert not outside.inside
    assert outside.protrusion == pytest.approx(2.2568146e-4, rel=1e-5)
    chicurel = conformity(chicurel_lobed(10.0, 10.0, 0.5))
    assert (chicurel.inside, chicurel.slope_continuous, chicurel.curvature_continuous) == (False, True, False)
    assert chicurel.protrusion == pytest.approx(2.4437e-4, rel=1e-4)
    free = conformity(quasi_ellipse(10.0, 1.0))
    assert free.protrusion == pytest.approx(1.0)
    assert (free.slope_continuous, free.curvature_continuous) == (True, True)
    assert free.stretch == pytest.approx(0.0056, abs=5e-5)


def test_successors_keep_what_the_published_lobe_promises():
    for r1, r2, phi, bearing in ((10.0, 10.0, 0.5, 1.0), (12.0, 10.0, 0.6, np.pi / 2), (12.0, 10.0, 0.4, 0.3)):
        oc = conserving_smooth_oc(r1, r2, phi, 3.0, bearing)
        found = conformity(smooth_lobed(r1, r2, phi, oc, 3.0, bearing), tolerance=1e-8)
        assert (found.inside, found.slope_continuous) == (True, True)
        assert (found.curvature_continuous, found.length_conserved) == (True, True)
        oc = conserving_oc(r1, r2, phi, 2.0, bearing)
        found = conformity(lobed(r1, r2, phi, oc, 2.0, bearing), tolerance=1e-8)
        assert (found.slope_continuous, found.length_conserved, found.curvature_continuous) == (True, True, False)
        assert 0.0 < oc < host_polar(bearing, r1, r2)[0]
    glock = conformity(smooth_lobed(12.0, 10.0, 0.5, 8.0, 2.0))
    assert (glock.inside, glock.slope_continuous, glock.curvature_continuous) == (True, True, False)


def test_conserving_depths_of_the_errata_and_against_integration():
    phi = radians(15, 30, 45)
    oc = conserving_oc(12.0, 10.0, phi)
    assert oc == pytest.approx([9.597, 8.380, 6.380], abs=5e-4)
    for half, one in zip(phi, oc, strict=True):
        lobe = Lobe(half, one)

        def speed(x, lobe=lobe):
            radius, slope, _ = lobe.polar(x, 12.0, 10.0)
            return float(np.hypot(radius, slope))

        assert 2 * quad(speed, 0, half, epsabs=1e-11)[0] == pytest.approx(
            float(host_arc(np.pi / 2 - half, np.pi / 2 + half, 12.0, 10.0)), rel=1e-9
        )
    narrow = conserving_oc(10.0, 10.0, [0.002, 0.02, 0.2])
    np.testing.assert_allclose((10 - narrow) / [0.002**2, 0.02**2, 0.2**2], (10 - narrow[1]) / 0.02**2, rtol=0.02)
    with pytest.raises(ParameterError, match="is too wide for a lobe that keeps its length"):
        conserving_oc(10.0, 10.0, [0.5, 2.5])
    assert np.isnan(conserving_oc(10.0, np.nan, 0.5))


def test_arcs_and_protrusions_batch():
    lobe = SmoothLobe([0.4, 0.5], [8.0, 11.0], 3.0)
    arcs = lobe_arc(lobe, 12.0, 10.0)
    assert arcs[1] == pytest.approx(lobe_arc(SmoothLobe(0.5, 11.0, 3.0), 12.0, 10.0))
    assert lobe_protrusion(lobe, 12.0, 10.0) == pytest.approx([0.0, 1.0])
