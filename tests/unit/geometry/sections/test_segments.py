"""Segments: courses along the pipe, the published code's courses, refusals with the place."""

from functools import partial

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.sections import (
    constant,
    egg,
    hinged,
    linear,
    linkage,
    s2_of_s1,
    segment,
    sinusoidal,
    tabulated,
)

X = np.linspace(-20.0, 20.0, 41)


@pytest.mark.parametrize(
    ("mode", "others"), [(1, {}), (2, {}), (3, {}), (4, {"s02": 0.9}), (5, {"s02": 0.95, "s01": 0.9})]
)
@pytest.mark.parametrize("course", [constant(0.8), linear((-20, 0.9), (20, 0.7)), sinusoidal(0.8, 0.1, 40.0)])
def test_every_mode_runs_along_the_pipe(mode, others, course):
    pipe = segment(hinged, X, mode=mode, s1=course, r=0.15, **others)
    theta = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    x, y, z, radius = pipe.surface(theta)
    assert x.shape == y.shape == z.shape == radius.shape == (41, 24)
    i = 13
    there = hinged(mode, course(X)[i], others.get("s02", 1.0), others.get("s01", 1.0), 0.15)
    np.testing.assert_array_equal(radius[i], there.polar_radius(theta))
    np.testing.assert_allclose(np.arctan2(y[i], z[i]) % (2 * np.pi), theta, atol=1e-12)
    s1 = course(X)
    np.testing.assert_allclose(y[:, 6], 0.15 * s2_of_s1(mode, s1, *others.values()))


def test_courses_of_the_published_code():
    length, least, span = 20.0, 30.0, 30.0
    wave = np.abs(np.cos(np.radians(X / length * 90))) * span + least
    np.testing.assert_allclose(sinusoidal(least, span, 4 * length)(X), wave, rtol=1e-12)
    tent = (length - np.abs(X)) / length * span + least
    np.testing.assert_allclose(tabulated([-20, 0, 20], [30, 60, 30])(X), tent, rtol=1e-12)


def test_other_shapes_and_volumes():
    pipe = segment(egg, [0.0, 10.0], width=0.6, height=linear((0, 0.9), (10, 1.0)), invert_radius=0.15)
    assert pipe.volume == pytest.approx(5 * np.sum(egg(0.6, [0.9, 1.0], 0.15).area))
    skewed = segment(partial(linkage, [0.1, 1.5, 3.0, 4.7]), X, closing=linear((-20, 1.0), (20, 0.8)))
    assert skewed.section.shape == (41,)


def test_refusals_name_the_place():
    with pytest.raises(ParameterError, match="element 40: s1 = 0"):
        segment(hinged, X, mode=1, s1=linear((-20, 1.0), (20, 0.0)))
    with pytest.raises(ParameterError, match="element 0: x = -20 is out of range; expected 0 <= x <= 5"):
        segment(hinged, X, mode=1, s1=tabulated([0, 5], [1.0, 0.9]))
    with pytest.raises(ParameterError, match="does not ascend"):
        segment(hinged, X[::-1], mode=1, s1=0.9)
    with pytest.raises(ParameterError, match="x ascending"):
        tabulated([0, 0], [1, 1])
    with pytest.raises(ParameterError, match="x = 1 stands at both ends"):
        linear((1, 0), (1, 2))
