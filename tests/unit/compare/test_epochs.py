"""What an inspection brings to a comparison: the bends of its layout stand among its features."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.compare.epochs import Epoch
from springline.compare.features import KINDS


@pytest.fixture(scope="module")
def bent():
    """The built-in survey with a sure bend of 22.5 degrees to the right, and one that is noise."""
    survey = sl.inspect(sl.read(sl.builtin_survey()))
    columns = {
        "start": [1.0, 2.0], "length": [0.6, 0.1], "angle": [0.39, 0.002], "arc_radius": [1.5, 50.0],
        "towards": [0.0, np.pi], "start_sigma": [0.01, 0.2], "angle_sigma": [0.001, 0.001],
        "arc_radius_sigma": [0.03, 40.0],
    }  # fmt: skip
    layout = xr.Dataset({f"bend_{name}": ("bend", np.array(values)) for name, values in columns.items()})
    return survey, survey.with_group("layout", layout)


def test_sure_bends_stand_among_the_features(bent):
    plain, survey = (Epoch("A", s) for s in bent)
    assert survey.kinds().count("bend") == plain.kinds().count("bend") + 1
    i = survey.kinds().index("bend")
    assert survey.features.kind[i] == KINDS.index("bend")
    assert survey.features.chainage[i] == pytest.approx(1.3)
    assert survey.features.bearing[i] == 0.0
    assert survey.features.size[i] == 0.6
    assert np.all(np.diff(survey.features.chainage) >= 0.0)
    angle, sigma = survey.measured("angle")
    assert (angle[i], sigma[i]) == (0.39, 0.001)
    assert np.isnan(np.delete(angle, i)).all()


def test_other_features_keep_their_values_beside_bends(bent):
    plain, survey = (Epoch("A", s) for s in bent)
    others = np.array([k != "bend" for k in survey.kinds()])
    for name in ("chainage", "size", "step"):
        for with_bend, without in zip(survey.measured(name), plain.measured(name), strict=True):
            np.testing.assert_array_equal(with_bend[others], without)
