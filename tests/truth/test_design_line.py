"""Deviations from a design line: a simulated pipe against lines that stand off its true axis by known amounts."""

import json

import numpy as np
import pytest

import springline as sl
from springline.io.design_line import read_design_line
from springline.outputs.summary import summary
from springline.outputs.tables import stations_sigma_table, stations_table
from springline.simulate import parse, simulate

SCENARIO = """
name = "laid beside its design"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.02
start = [1000.0, 2000.0, 50.0]
run = [
    { kind = "straight", length = 3.0 },
    { kind = "bend", radius = 1.5, angle_deg = 22.5, towards = "right" },
    { kind = "straight", length = 3.0 },
]
[robot]
length = 0.5
wheelbase = 0.35
offset_z = { amplitude = 0.02, period = 3.0 }
offset_y = { amplitude = 0.004, period = 4.3 }
roll_deg = { amplitude = 3.0, period = 3.7 }
standstill = [{ chainage = 0.25, duration = 30.0 }]
[rings]
spacing = "20mm"
noise = "1mm"
bearings = 180
[inertial]
rate = 50.0
gyro_bias_deg_h = [10.0, -10.0, 10.0]
gyro_noise_deg_sqrt_h = 0.3
accel_bias = [0.01, -0.01, 0.01]
accel_noise = 0.0005
[odometer]
scale_error = 0.003
[ties]
chainages = [0.25, 6.0]
sigma = "2mm"
"""
UP, RIGHT = 0.035, -0.012


@pytest.fixture(scope="module")
def made():
    return simulate(parse(SCENARIO), seed=4)


def true_line(truth, up, right):
    """Return points that stand off the true axis by as much, seen along travel."""
    point = np.stack([truth[name].values for name in ("easting", "northing", "elevation")], axis=1)
    way = np.gradient(point[:, :2], axis=0)
    way /= np.hypot(*way.T)[:, None]
    beside = point[:, :2] + right * np.stack([way[:, 1], -way[:, 0]], axis=1)
    return np.column_stack([beside, point[:, 2] + up])


def written(path, columns, rows):
    path.write_text("\n".join([columns, *(",".join(f"{v:.9g}" for v in row) for row in rows)]) + "\n")
    return path


def held(survey, path, of=None):
    return sl.inspect(survey.with_group("design_line", read_design_line(path, of=of)))


@pytest.fixture(scope="module")
def result(made, tmp_path_factory):
    line = true_line(made.truth, -UP, -RIGHT)
    path = tmp_path_factory.mktemp("line") / "line.csv"
    return held(made, written(path, "easting_m,northing_m,axis_elevation_m", line[::-1]))


def test_a_line_in_plan_shows_how_far_the_pipe_stands_off_it_whichever_way_it_runs(result):
    table, sigma = stations_table(result), stations_sigma_table(result)
    for name, truth in (("deviation_up_mm", 1e3 * UP), ("deviation_right_mm", 1e3 * RIGHT)):
        error, one = table[name] - truth, sigma[name]
        assert np.isfinite(error).mean() > 0.98
        # Errors of one survey are shared by its stations: bounded here, their coverage is that of the layout.
        assert np.nanmax(np.abs(error / one)) < 3.5
        assert np.nanmax(one) < 3.0
    layout = result.layout
    straight = (layout["chainage"] > 4.5) & (layout["chainage"] < 5.0)
    assert np.abs(layout["deviation_gradient"].values[straight]).max() < 4.0 * float(
        layout["deviation_gradient_sigma"].values[straight].max()
    )
    assert layout.attrs["design_datum"] == "absolute"


def test_a_deviation_errs_as_the_layout_does_and_by_nothing_of_its_own(made, result):
    truth, layout = made.truth, result.layout
    east, north, up = (
        layout[name].values - np.interp(truth["ring_chainage"], truth["chainage"], truth[name])
        for name in ("easting", "northing", "elevation")
    )
    heading = layout["heading"].values
    right = east * np.cos(heading) - north * np.sin(heading)
    np.testing.assert_allclose(layout["deviation_right"] - RIGHT, right, atol=1e-4)
    # Where the station lies along the line is in doubt too: what lies below it falls by 2 in 100.
    along = east * np.sin(heading) + north * np.cos(heading)
    np.testing.assert_allclose(layout["deviation_up"] - UP, up + 0.02 * along, atol=1e-4)


def test_the_summary_has_the_largest_deviation_with_its_sign_and_place(result):
    found, table = summary(result), stations_table(result)
    assert found["deviation_up_max_mm"] == pytest.approx(np.nanmax(table["deviation_up_mm"]), abs=1e-3)
    assert found["deviation_right_max_mm"] == pytest.approx(np.nanmin(table["deviation_right_mm"]), abs=1e-3)
    at = np.nanargmax(table["deviation_up_mm"])
    assert found["deviation_up_max_chainage_m"] == pytest.approx(table["chainage_m"][at], abs=1e-3)


def test_without_ties_the_height_counts_from_the_first_station_and_the_plan_is_missing(made, tmp_path):
    survey = sl.Survey({n: made.group(n) for n in made.groups if n not in ("ties", "truth")}, made.attrs)
    at = made.truth["chainage"].values
    # The invert of a round pipe; the design is steeper by one in a hundred.
    invert = made.truth["elevation"].values - 0.15 - 0.01 * at
    path = written(
        tmp_path / "line.csv", "chainage_m,invert_elevation_ft", np.column_stack([at - 0.25, invert / 0.3048])
    )
    layout = held(survey, path).layout
    up, sigma = layout["deviation_up"].values, layout["deviation_up_sigma"].values
    expected = 0.01 * (layout["chainage"].values - layout["chainage"].values[0])
    assert up[0] == 0.0
    assert np.max(np.abs(up - expected)) < 3.0 * sigma[-1] < 0.1
    assert np.isnan(layout["deviation_right"]).all()
    why = json.loads(layout.attrs["why_missing"])
    assert "chainage and elevation alone" in why["deviation_right"]
    assert float(layout.attrs["design_datum"]) == pytest.approx(layout["chainage"].values[0], abs=1e-4)


def test_without_a_layout_the_survey_says_that_nothing_was_compared(made, tmp_path):
    survey = sl.Survey({"rings": made.rings}, made.attrs)
    path = written(tmp_path / "line.csv", "chainage_m,invert_elevation_m", [(0, 50), (6, 49)])
    found = held(survey, path)
    assert any("no layout was found" in sentence for sentence in found.warnings)
    assert summary(found)["deviation_up_max_mm"] is None
    assert summary(found)["deviation_right_max_chainage_m"] is None
    assert "deviation_up_mm" not in stations_table(found)
