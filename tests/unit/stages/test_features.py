"""Features: sized, placed on the pipe, and written."""

import numpy as np
import pytest

import springline as sl
from springline.config import make_config
from springline.conventions import GROUPS
from springline.outputs.tables import features_table
from springline.survey import validate


@pytest.fixture(scope="module")
def builtin():
    return sl.inspect(sl.read(sl.builtin_survey()))


def of_kind(survey, kind):
    found = survey.features
    return found.isel(feature=np.flatnonzero(found["kind"].values == kind))


def test_every_column_of_the_contract_is_there(builtin):
    found = validate(builtin).features
    assert {v.name for v in GROUPS["features"].variables} <= set(found.data_vars)
    assert (np.diff(found["chainage"].values) >= 0).all()
    assert found.attrs["false_alarm"] == 0.01


def test_the_lateral_of_the_built_in_survey(builtin):
    lateral = of_kind(builtin, "lateral").isel(feature=0)
    for name, true in (("size", 0.1), ("bearing", np.pi / 6), ("inclination", 0.0), ("chainage", 10.5 / 1.003 - 0.135)):
        assert abs(float(lateral[name]) - true) < 2.5 * float(lateral[f"{name}_sigma"]), name
    assert float(lateral["size_sigma"]) < 0.01
    assert float(lateral["confidence"]) > 0.9


def test_the_dent_of_the_built_in_survey(builtin):
    dent = of_kind(builtin, "dent").isel(feature=0)
    assert float(dent["depth"]) == pytest.approx(-0.018, abs=5e-4)
    assert abs(float(dent["depth"]) + 0.018) < 1.96 * float(dent["depth_sigma"])
    assert float(dent["bearing"]) == pytest.approx(np.pi / 3, abs=0.03)


def test_the_open_joint_of_the_built_in_survey(builtin):
    joints = of_kind(builtin, "joint")
    joint = joints.isel(feature=int(np.argmax(joints["size"].values)))
    assert abs(float(joint["size"]) - 0.040) < 1.96 * float(joint["size_sigma"])
    assert float(joint["depth"]) == pytest.approx(0.0085, abs=1e-3)
    assert np.isnan(float(joint["bearing"]))


def test_a_pipe_with_nothing_on_it_has_an_empty_list():
    result = sl.inspect(sl.simulate("reference-ring", seed=4))
    assert result.features.sizes["feature"] == 0
    assert len(features_table(result)) == 0


def test_the_table_has_a_row_for_each(builtin):
    table = features_table(builtin)
    assert len(table) == builtin.features.sizes["feature"]
    assert set(table["kind"]) == {"joint", "lateral", "dent"}
    assert (table["source"] == "rings").all()
    lateral = table[table["kind"] == "lateral"].iloc[0]
    assert lateral["clock_h"] == pytest.approx(2.0, abs=0.1)


def test_less_probable_features_can_be_asked_for_and_left_out(builtin):
    survey = sl.read(sl.builtin_survey())
    none = sl.inspect(survey, make_config({"detect": {"least_confidence": 1.0}}))
    assert none.features.sizes["feature"] < builtin.features.sizes["feature"]
