"""Lobes of a liner per station: what is added to the section, when, and what is said about it."""

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.config import Config, make_config
from springline.stages.estimate import estimate
from springline.stages.liner import liner
from springline.survey import open_survey, save_survey, validate

BEARINGS = np.arange(180) * 2 * np.pi / 180
RADIUS, NOISE = 0.15, 0.0004
FIT = make_config({"liner": {"fit": True}})
TEXT = ("liner_lobe", "liner_lobe_false_alarm", "liner_protrusion")
QUANTITIES = (
    "liner_lobe_bearing",
    "liner_lobe_half_angle",
    "liner_lobe_depth",
    "liner_lobe_power",
    "liner_remaining_radius",
    "liner_gap_area",
)


def lobed(depth, clock_h=12.0, half_deg=35.0, power=2.0):
    """The published lobe in a circular host: r - depth (1 - |x|^p) cos(pi x / 2)."""
    centre = np.pi / 2 - clock_h * np.pi / 6
    offset = (BEARINGS - centre + np.pi) % (2 * np.pi) - np.pi
    x = np.minimum(np.abs(offset) / np.radians(half_deg), 1.0)
    return RADIUS - depth * (1.0 - x**power) * np.cos(np.pi / 2 * x)


def survey(ranges, config=FIT):
    ranges = np.asarray(ranges, "float32")
    rings = xr.Dataset(
        {"range": (("ring", "bearing"), ranges), "distance": ("ring", 0.02 * np.arange(len(ranges)))},
        coords={"bearing": BEARINGS},
        attrs={"referred_to": "sensor", "sensor_kind": "ring-laser"},
    )
    reason = np.where(np.isfinite(ranges), 0, 1).astype("uint8")
    mask = xr.Dataset(
        {"reason": (("ring", "bearing"), reason), "coverage": ("ring", (reason == 0).mean(axis=1))},
        coords={"bearing": BEARINGS},
    )
    return estimate(sl.Survey({"rings": rings, "mask": mask}, {"name": "test", "nominal_diameter": 0.3}), config)


@pytest.fixture(scope="module")
def found():
    """Forty rings without a lobe, forty with one at the crown, forty with one at 4 o'clock, five unseen."""
    rng = np.random.default_rng(3)
    clean = [lobed(0.0)] * 40 + [lobed(0.012)] * 40 + [lobed(0.006, 4.0, 25.0)] * 40 + [lobed(0.0)] * 5
    ranges = np.array(clean) + NOISE * rng.standard_normal((125, 180))
    ranges[120:, 60:] = np.nan
    return liner(survey(ranges), FIT)


def test_lobes_are_found_where_they_are_and_only_there(found):
    section = found.section
    assert section["liner_lobe"].values.tolist() == [0] * 40 + [1] * 80 + [0] * 5
    with np.errstate(invalid="ignore"):
        assert np.all(section["liner_lobe_false_alarm"].values[40:120] < 1e-4)
    assert np.isnan(section["liner_lobe_false_alarm"].values[120:]).all()
    for name in QUANTITIES:
        values = section[name].values
        assert np.isnan(values[:40]).all(), name
        assert np.isnan(values[120:]).all(), name
        assert np.isfinite(section[f"{name}_sigma"].values[40:120]).all(), name


@pytest.mark.parametrize(
    ("rows", "bearing", "half_deg", "depth"), [(slice(40, 80), 90.0, 35.0, 0.012), (slice(80, 120), 330.0, 25.0, 0.006)]
)
def test_their_shape_lies_within_its_sigma(found, rows, bearing, half_deg, depth):
    section = found.section
    truth = {
        "liner_lobe_bearing": np.radians(bearing),
        "liner_lobe_half_angle": np.radians(half_deg),
        "liner_lobe_depth": depth,
        "liner_remaining_radius": RADIUS - depth,
    }
    for name, true in truth.items():
        score = (section[name].values[rows] - true) / section[f"{name}_sigma"].values[rows]
        assert np.mean(np.abs(score) < 2.5) > 0.9, name
        assert np.abs(np.mean(score)) < 0.7, name
    assert np.all(section["liner_lobe_power"].values[rows] == 2.0)
    assert np.all(section["liner_protrusion"].values[rows] < 1e-9)
    x = np.linspace(-1.0, 1.0, 20001)
    inner = RADIUS - depth * (1.0 - x**2) * np.cos(np.pi / 2 * x)
    gap = np.trapezoid(0.5 * (RADIUS**2 - inner**2), x) * np.radians(half_deg)
    assert np.mean(section["liner_gap_area"].values[rows]) == pytest.approx(gap, rel=0.02)


def test_the_scale_of_the_sensor_counts(found):
    section = found.section
    scale = section.attrs["range_scale_sigma"]
    left = section["liner_remaining_radius"].values[40:120]
    assert np.all(section["liner_remaining_radius_sigma"].values[40:120] > scale * left)


def test_what_is_said(found):
    warning = found.warnings[-1]
    assert "at 80 of 125 stations" in warning
    assert "12 o'clock" in warning or "11.9 o'clock" in warning
    assert "Diameters, ovality, deflection, losses and verdicts are of the section without the lobe" in warning
    assert "user's word" in found.assumptions[-1]
    assert "at most 0.01 %" in found.assumptions[-1]
    assert found.section.attrs["liner_kind"] == "proposed"


def test_it_follows_the_contract_and_is_stored(found, tmp_path):
    validate(found)
    save_survey(found, tmp_path / "a.zarr.zip")
    again = open_survey(tmp_path / "a.zarr.zip").section
    for name in (*TEXT, *QUANTITIES):
        np.testing.assert_allclose(again[name].values, found.section[name].values, rtol=1e-6, atol=1e-9)
    assert again["liner_lobe_depth"].attrs["units"] == "m"


def test_nothing_is_looked_for_unless_asked():
    before = survey(np.array([lobed(0.012)] * 3), Config())
    assert liner(before, Config()) is before
    assert "liner_lobe" not in before.section


def test_wall_that_errs_together_is_no_lobe():
    """A rough wall has bumps as wide as lobes; they count for the few independent readings that they are."""
    rng = np.random.default_rng(4)
    rough = np.repeat(rng.standard_normal((80, 30)), 6, axis=1)
    smooth = rng.standard_normal((80, 180))
    shares = []
    for error in (smooth, rough):
        made = liner(survey(RADIUS + NOISE * error), FIT)
        shares.append(made.section["liner_lobe"].values.mean())
    assert shares[0] == 0.0
    assert shares[1] <= 0.05


def test_a_kind_and_a_power_of_ones_own():
    settings = make_config({"liner": {"fit": True, "kind": "smooth", "power": 2.5}})
    rng = np.random.default_rng(5)
    made = liner(survey(np.array([lobed(0.012)] * 10) + NOISE * rng.standard_normal((10, 180))), settings)
    assert made.section["liner_lobe"].values.all()
    assert np.all(made.section["liner_lobe_power"].values == 2.5)
    assert np.all(made.section["liner_lobe_power_sigma"].values == 0.0)
    free = make_config({"liner": {"fit": True, "free_power": True}})
    made = liner(survey(np.array([lobed(0.02, power=4.0)] * 10) + NOISE * rng.standard_normal((10, 180))), free)
    score = (made.section["liner_lobe_power"].values - 4.0) / made.section["liner_lobe_power_sigma"].values
    assert np.all(np.abs(score) < 3.5)


def test_the_chain_looks_for_lobes_when_asked():
    result = sl.inspect(sl.read(sl.builtin_survey()), FIT)
    assert "liner_lobe" in result.section
    assert result.has("metrics")


def test_the_flag_of_the_command_line_asks_for_them(tmp_path):
    from springline.cli.inspect import _settings

    config = tmp_path / "config.toml"
    config.write_text('[liner]\nkind = "smooth"\n')
    asked = _settings(config, None, liner=True, units=None).liner
    assert (asked.fit, asked.kind) == (True, "smooth")
    assert not _settings(config, None, liner=False, units=None).liner.fit
