"""Every section and liner keeps the interface's shapes, for one, for batches of any shape and for none."""

import numpy as np
import pytest

from springline.geometry import liners, sections

THETA = np.linspace(0.0, 6.0, 7)
BATCHES = {
    "mode 1": lambda x: sections.hinged(1, x),
    "mode 5 upside down": lambda x: sections.hinged(5, x, 0.95, 0.92, inverted=True),
    "egg": lambda x: sections.egg(x, 1.5, 0.1),
    "box": lambda x: sections.box(1.0, x),
    "ellipse": lambda x: sections.ellipse(x, 1.0),
    "linkage": lambda x: sections.linkage([0.0, 1.3, 3.0, 4.7], x),
    "lobe": lambda x: liners.lobed(12.0, 10.0, 0.5, 9.0 * x),
    "two lobes": lambda x: liners.lined(12.0, 10.0, liners.Lobe(0.4, 9.0), liners.SmoothLobe(0.3, 9 * x, bearing=-1.0)),
    "chicurel": lambda x: liners.chicurel_lobed(12.0, 10.0, 0.5 * x),
    "quasi-ellipse": lambda x: liners.quasi_ellipse(x, 0.1),
}


@pytest.mark.parametrize("shape", [(), (1, 3), (0,)])
@pytest.mark.parametrize("name", BATCHES)
def test_shapes(name, shape):
    section = BATCHES[name](np.full(shape, 0.9))
    assert section.shape == shape
    for measure in ("area", "perimeter", "mean_radius", "hull_perimeter", "width", "height", "crown_dip", "invert_dip"):
        assert np.shape(getattr(section, measure)) == shape
    for of in (section.polar_radius, section.polar_slope, section.curvature, section.chord, section.support):
        assert of(THETA).shape == (*shape, 7)
        assert np.shape(of(0.3)) == shape
    own = np.broadcast_to(THETA, (*shape, 7)) + 0.1
    np.testing.assert_array_equal(section.polar_radius(own), section.polar_radius(THETA + 0.1))
    z, y = section.contour(own)
    np.testing.assert_allclose(np.hypot(z, y), section.polar_radius(own), rtol=1e-14)
    found = section.diameters
    assert found.largest.length.shape == found.smallest.bearing.shape == np.shape(found.ovality("caliper")) == shape
    assert np.shape(section.moments.zy) == shape
    assert section.breaks.shape[:-1] == section.panels.shape[:-1] == shape


@pytest.mark.parametrize("name", BATCHES)
def test_a_batch_is_indexed_by_its_leading_axes(name):
    section = BATCHES[name](np.linspace(0.9, 0.92, 6).reshape(2, 3))
    for key in (1, (1, 2), slice(0, 1), np.array([[True, False, True], [False, True, False]])):
        part = section[key]
        np.testing.assert_allclose(part.polar_radius(THETA), section.polar_radius(THETA)[key], rtol=1e-13)
        assert np.shape(part.area) == np.shape(section.area[key])
