"""Families: derivatives against differences of the sections themselves, ranges against what is refused."""

import numpy as np
import pytest

from springline.errors import ParameterError
from springline.geometry.sections import FAMILIES, SHAPES, mode_family

THETA = np.linspace(0.01, 2 * np.pi, 50)
MODES = {
    "mode 1": [0.15, 0.8],
    "mode 2": [0.15, 0.8],
    "mode 3": [0.15, 0.8],
    "mode 4": [0.15, 0.8, 0.9],
    "mode 5": [0.15, 0.7, 0.9, 0.8],
}


@pytest.mark.parametrize("name", FAMILIES)
def test_derivatives_are_those_of_the_sections(name):
    family = FAMILIES[name]
    p = np.array(MODES.get(name) or SHAPES[name].example)
    radius, by = family.derivatives(THETA, p)
    np.testing.assert_allclose(radius, family.section(p).polar_radius(THETA), rtol=1e-14)
    np.testing.assert_array_equal(family.polar_radius(THETA, p), radius)
    for k, step in enumerate(np.eye(p.size) * 3e-5 * p):
        differences = (family.section(p + step).polar_radius(THETA) - family.section(p - step).polar_radius(THETA)) / (
            2 * step[k]
        )
        np.testing.assert_allclose(by[:, k], differences, atol=2e-6)


@pytest.mark.parametrize("mode", [1, 2, 3, 4, 5])
@pytest.mark.parametrize("rule", ["exact", "ramanujan"])
def test_batches_of_rings(mode, rule):
    family = mode_family(mode, rule=rule)
    p = np.array(MODES[f"mode {mode}"]) * np.array([[1.0], [1.001], [0.999]])
    own = THETA + np.arange(3)[:, None]
    radius, by = family.derivatives(own, p)
    shared, _ = family.derivatives(THETA, p)
    assert by.shape == (3, THETA.size, len(family.parameters))
    for i in range(3):
        np.testing.assert_array_equal(family.derivatives(own[i], p[i])[1], by[i])
        np.testing.assert_array_equal(family.polar_radius(own[i], p[i]), radius[i])
        np.testing.assert_array_equal(family.polar_radius(THETA, p[i]), shared[i])


@pytest.mark.parametrize("name", ["mode 1", "mode 3", "mode 4", "mode 5", "egg", "loaf", "arch", "box"])
def test_limits_are_where_building_is_refused(name):
    family = FAMILIES[name]
    p = np.array(MODES.get(name) or SHAPES[name].example)
    low, high = family.limits(p)
    assert np.all((low <= p) & (p <= high))
    for k in range(p.size):
        for limit, outward in ((low, -1.0), (high, 1.0)):
            if np.isfinite(limit[k]):
                inside, outside = p.copy(), p.copy()
                inside[k], outside[k] = limit[k] - outward * 1e-6, limit[k] + outward * 1e-6
                if family.parameters[k] not in ("s02", "s01"):  # the limits of s1 follow them
                    assert np.isfinite(family.section(inside).area)
                with pytest.raises(ParameterError):
                    family.section(outside)


def test_a_kernel_gives_nan_where_there_is_no_section_and_one_sided_differences_at_a_limit():
    assert np.isnan(FAMILIES["mode 4"].polar_radius([1.0], [0.15, 0.2, 0.95])).all()
    radius, by = FAMILIES["box"].derivatives(THETA, [1.5, 1.0, 0.0])
    assert np.isfinite(radius).all()
    assert np.isfinite(by).all()
