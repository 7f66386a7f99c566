"""A calibration in a survey: applied once, undone before another, told to the scale's sigma, kept by every format."""

import json

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.calibration import apply_calibration, with_calibration
from springline.errors import InputError
from springline.io.calibration_file import as_values, read_calibration, write_calibration
from springline.survey import Survey

BEARINGS = np.arange(90) * 2 * np.pi / 90


def calibration(scale=1.02, sigma=0.0004, **more):
    return xr.Dataset(
        {"range_scale": scale, "range_scale_sigma": sigma, **more}, attrs={"reference_diameter": 0.3, "notes": "[]"}
    )


def survey(radius=0.153, count=12):
    rng = np.random.default_rng(3)
    rings = xr.Dataset(
        {
            "range": (("ring", "bearing"), (radius + 2e-4 * rng.standard_normal((count, 90))).astype("float32")),
            "bearing": ("bearing", BEARINGS),
            "distance": ("ring", 0.05 * np.arange(count)),
        },
        attrs={"referred_to": "sensor", "sensor_kind": "ring-laser", "distance_source": "odometer"},
    )
    return Survey({"rings": rings}, {"name": "test", "nominal_diameter": 0.3})


def test_an_inspection_divides_by_the_scale_and_takes_its_sigma():
    plain = sl.inspect(survey())
    found = sl.inspect(with_calibration(survey(), calibration()))
    assert plain.metrics.attrs["diameter_mean"] / found.metrics.attrs["diameter_mean"] == pytest.approx(1.02, rel=1e-6)
    assert found.metrics.attrs["diameter_mean"] == pytest.approx(0.3, abs=1e-4)
    assert found.section.attrs["range_scale_sigma"] == 0.0004
    assert found.section.attrs["range_scale_source"] == "calibration"
    assert found.metrics.attrs["diameter_sigma_scale"] == pytest.approx(0.0004 * 0.3, rel=1e-3)
    assert any("divided by 1.02" in sentence for sentence in found.assumptions)


def test_no_scale_is_applied_twice_and_another_undoes_it():
    once = apply_calibration(with_calibration(survey(), calibration()))
    twice = apply_calibration(once)
    np.testing.assert_array_equal(once.rings["range"], twice.rings["range"])
    other = apply_calibration(with_calibration(once, calibration(0.99)))
    np.testing.assert_allclose(other.rings["range"], survey().rings["range"].values / 0.99, rtol=1e-6)
    assert other.rings.attrs["range_scale_applied"] == 0.99


def test_a_result_that_is_inspected_again_stays(tmp_path):
    found = sl.inspect(with_calibration(survey(), calibration()))
    for name in ("again.zarr.zip", "folder"):
        sl.write(found.source(), tmp_path / name)
        again = sl.inspect(sl.read(tmp_path / name))
        assert again.metrics.attrs["diameter_mean"] == pytest.approx(found.metrics.attrs["diameter_mean"], abs=2e-6)
        assert again.section.attrs["range_scale_sigma"] == 0.0004


def test_boresight_and_noise_are_handed_to_the_rings():
    more = {"boresight_pitch": 0.005, "boresight_yaw": np.nan, "noise_constant": 3e-4, "noise_relative": 0.002}
    rings = apply_calibration(with_calibration(survey(), calibration(**more))).rings
    assert rings.attrs["boresight_pitch"] == 0.005 and "boresight_yaw" not in rings.attrs
    assert rings.attrs["range_noise"] == pytest.approx(np.hypot(3e-4, 0.002 * 0.15), rel=1e-3)


def test_points_from_the_sensor_are_scaled_and_others_refused():
    points = xr.Dataset({axis: ("point", np.array([1.0, 2.0])) for axis in "xyz"}, attrs={"origin_is_sensor": 1})
    moved = apply_calibration(Survey({"points": points, "calibration": calibration()})).points
    np.testing.assert_allclose(moved["x"], [1 / 1.02, 2 / 1.02])
    with pytest.raises(InputError, match="origin is not the sensor"):
        apply_calibration(Survey({"points": points.assign_attrs(origin_is_sensor=0), "calibration": calibration()}))


def test_a_survey_with_a_lens_alone_is_left_as_it_is():
    made = with_calibration(survey(), xr.Dataset(attrs={"lens": "{}"}))
    assert apply_calibration(made) is made


@pytest.mark.parametrize("name", ["c.toml", "c.zarr", "c.zarr.zip"])
def test_files_keep_every_number_and_the_reasons(name, tmp_path):
    terms = ["range_scale", "boresight_pitch", "boresight_yaw", "boresight_roll", "noise_constant", "noise_relative"]
    spread = np.full((6, 6), np.nan)
    spread[np.ix_([0, 4], [0, 4])] = [[1.6e-7, 1e-12], [1e-12, 4e-10]]
    made = calibration(noise_constant=3e-4, noise_constant_sigma=2e-5, boresight_pitch=np.nan).assign(
        covariance=(("calibration_term", "calibration_term_2"), spread)
    )
    made = made.assign_coords(calibration_term=terms, calibration_term_2=terms)
    made = made.assign_attrs(why_missing=json.dumps({"boresight_pitch": "no tilt"}))
    back = read_calibration(write_calibration(made, tmp_path / name))
    for key in ("range_scale", "range_scale_sigma", "noise_constant", "boresight_pitch", "covariance"):
        np.testing.assert_allclose(back[key], made[key], rtol=1e-12)
    assert json.loads(back.attrs["why_missing"]) == {"boresight_pitch": "no tilt"}
    assert "boresight_pitch" not in as_values(made)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("range_scal = 1.0", "unknown key, did you mean 'range_scale'"),
        ("range_scale = 'x'\nrange_scale_sigma = 0.1", "is not a number"),
        ("range_scale = 1.0", "one-sigma is missing"),
        ("range_scale = ", "not a TOML file"),
        ("[covariance]\nterms = ['range_scale']\nvalues = [[1.0, 2.0]]", "do not fit"),
        ("[covariance]\nterms = ['range_scales']\nvalues = [[1.0]]", "unknown term"),
    ],
)
def test_a_wrong_file_is_refused_by_key(text, message, tmp_path):
    (tmp_path / "c.toml").write_text(text)
    with pytest.raises(InputError, match=message):
        read_calibration(tmp_path / "c.toml")


def test_a_missing_file_and_a_survey_without_one_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_calibration(tmp_path / "none.toml")
    sl.write(survey(), tmp_path / "s.zarr")
    with pytest.raises(InputError, match="no calibration in it"):
        read_calibration(tmp_path / "s.zarr")
    with pytest.raises(InputError, match="extension"):
        write_calibration(calibration(), tmp_path / "c.json")
