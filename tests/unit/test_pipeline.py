"""The whole chain as a caller meets it: what it takes, what it refuses, and what a second inspection says."""

import json
import warnings

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.errors import ContractError, InputError, ParameterError
from springline.simulate import parse, simulate

COUNT = 180
BEARING = np.arange(COUNT) * 2.0 * np.pi / COUNT

SCENARIO = """
name = "there and back"
[pipe]
diameter = "300mm"
start = [0.0, 0.0, 10.0]
run = [{ kind = "straight", length = 9.0 }]
[[pipe.section]]
shape = "ellipse"
semi_major = { mean = 0.153, amplitude = 0.001, period = 2.0 }
semi_minor = 0.148
[robot]
length = 0.4
returns = true
[rings]
spacing = "20mm"
bearings = 120
noise = "0.5mm"
"""


def rings(**changes):
    ranges = 0.15 + np.random.default_rng(4).normal(0.0, 5e-4, (3, COUNT))
    data = {"range": (("ring", "bearing"), ranges), "bearing": ("bearing", BEARING), "distance": ("ring", np.arange(3))}
    return xr.Dataset(data, attrs={"referred_to": "sensor", "sensor_kind": "ring-laser"}).assign(changes)


def survey(data=None, **attrs):
    return sl.Survey({"rings": rings() if data is None else data}, {"name": "A", "nominal_diameter": 0.3, **attrs})


def test_settings_may_be_nested_dictionaries():
    result = sl.inspect(survey(), {"clean": {"outlier_sigma": 5.0}})
    assert json.loads(result.attrs["provenance"])["config"]["clean"]["outlier_sigma"] == 5.0
    with pytest.raises(InputError, match=r"clean\.outlier_sigm: unknown setting"):
        sl.inspect(survey(), {"clean": {"outlier_sigm": 5.0}})


@pytest.mark.parametrize(
    ("given", "config", "said"),
    [
        ("scan.ply", None, "survey: 'scan.ply' is no survey"),
        (None, None, "survey: None is no survey"),
        ("survey", "settings.toml", "config: 'settings.toml' is no settings"),
    ],
)
def test_other_arguments_are_refused(given, config, said):
    with pytest.raises(ParameterError, match=said):
        sl.inspect(survey() if given == "survey" else given, config)


def test_bearings_in_degrees_are_refused():
    with pytest.raises(InputError, match=r"bearings run from 0 to 358; expected radians within one turn"):
        sl.inspect(survey(rings(bearing=("bearing", np.degrees(BEARING)))))


def test_a_missing_distance_is_named():
    with pytest.raises(ContractError, match="variable 'distance' is missing"):
        sl.inspect(survey(rings().drop_vars("distance")))


@pytest.mark.parametrize("value", ["300mm", 0.0, -0.3, np.nan, True])
def test_a_nominal_diameter_is_a_length(value):
    with pytest.raises(ContractError, match="attribute 'nominal_diameter'"):
        sl.inspect(survey(nominal_diameter=value))


def test_an_infinite_reading_is_no_return():
    ranges = rings()["range"].values
    gone = np.where(BEARING < 1.0, np.nan, ranges)
    endless = np.where(BEARING < 1.0, np.inf, ranges)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        one, two = (sl.inspect(survey(rings(range=(("ring", "bearing"), each)))) for each in (gone, endless))
    assert np.array_equal(one.metrics["diameter_area"], two.metrics["diameter_area"])
    assert np.array_equal(one.mask["reason"], two.mask["reason"])


def test_a_second_inspection_assumes_only_what_it_assumes_itself():
    first = sl.inspect(survey())
    second = sl.inspect(first.with_attrs(base_diameter=0.31))
    assert "Deflection and losses refer to the nominal diameter, 300 mm." in first.assumptions
    assert [one for one in second.assumptions if "Deflection" in one] == [
        "Deflection and losses refer to the base diameter, 310 mm."
    ]


def test_a_second_inspection_of_joined_passes_says_that_one_is_lost(tmp_path):
    run = simulate(parse(SCENARIO), seed=3)
    sl.write(sl.inspect(run), tmp_path / "joined.zarr.zip")
    joined = sl.read(tmp_path / "joined.zarr.zip")
    assert any("passes were joined" in one for one in joined.assumptions)
    again = sl.inspect(joined)
    assert not any("joined by" in one or "second pass" in one for one in again.assumptions)
    assert any("not in this survey" in one and "out pass alone" in one for one in again.warnings)
    ratio = joined.section["covariance"].values[:, 0, 0] / again.section["covariance"].values[:, 0, 0]
    assert np.median(ratio) == pytest.approx(0.5, abs=0.1)
