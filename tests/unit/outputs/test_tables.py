import csv
import json
import time

import numpy as np
import pytest
import xarray as xr

from springline.conventions import FEATURE_COLUMNS, STATION_COLUMNS
from springline.errors import ContractError
from springline.outputs.summary import summary
from springline.outputs.tables import (
    FEATURE_DECIMALS,
    STATION_DECIMALS,
    features_table,
    stations_sigma_table,
    stations_table,
    write_csv,
)
from springline.survey import Survey

from .finished import finished_survey


def read(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


@pytest.fixture(scope="module")
def rows(survey, tmp_path_factory):
    path = tmp_path_factory.mktemp("tables") / "stations.csv"
    write_csv(stations_table(survey), path, STATION_DECIMALS)
    return read(path)


def test_columns_stand_in_the_promised_order(survey, rows):
    promised = (
        "chainage_m, distance_m, coverage_pct, offset_y_mm, offset_z_mm, pitch_deg, yaw_deg, roll_deg, semi_major_mm, "
        "semi_minor_mm, axis_clock_h, diameter_max_mm, diameter_max_clock_h, diameter_min_mm, diameter_x_mm, "
        "diameter_y_mm, diameter_axes_mm, diameter_polar_mm, diameter_area_mm, diameter_caliper_mm, ovality_axes_pct, "
        "ovality_polar_pct, ovality_area_pct, ovality_caliper_pct, ovality_sigma_pct, deflection_pct, "
        "deflection_sigma_pct, deflection_x_pct, deflection_y_pct, area_m2, area_loss_pct, capacity_loss_pct, mode, "
        "s1, s2, s01, s02, residual_rms_mm, easting_m, northing_m, elevation_m, gradient_pct, bend_radius_m, "
        "liner_thickness_mm, liner_governing, flags"
    )
    assert list(rows[0]) == promised.split(", ") == list(stations_sigma_table(survey).columns)
    assert len(rows) == survey.section.sizes["station"]


def test_values_are_in_their_edge_units_with_their_decimals(rows):
    row = next(r for r in rows if r["chainage_m"] == "19.9875")
    assert row["semi_major_mm"] == "156.000"
    assert row["deflection_pct"] == "4.0000"
    assert row["area_m2"] == f"{np.pi * 0.156 * 0.144:.6f}"
    # The axis turns by 0.2 + 0.4 sin(x / 9) from 3 o'clock towards 12.
    assert float(row["axis_clock_h"]) == pytest.approx(3 - (0.2 + 0.4 * np.sin(19.9875 / 9)) * 6 / np.pi, abs=1e-3)


def test_what_is_not_available_is_empty_and_never_zero(rows):
    without = [r for r in rows if 12.0 <= float(r["chainage_m"]) < 12.4]
    assert without and all(r["semi_major_mm"] == r["ovality_polar_pct"] == r["offset_y_mm"] == "" for r in without)
    assert all(r["roll_deg"] == r["mode"] == r["easting_m"] == r["liner_thickness_mm"] == "" for r in rows)
    assert not {"nan", "None", "-0.000"} & {cell for row in rows for cell in row.values()}


def test_sigmas_are_the_variables_own(survey):
    table = stations_sigma_table(survey)
    known = np.isfinite(survey.metrics["diameter_max"].values)
    np.testing.assert_allclose(
        table["diameter_max_mm"][known], survey.metrics["diameter_max_sigma"].values[known] * 1e3
    )
    np.testing.assert_allclose(table["axis_clock_h"][known], 0.01 * 6 / np.pi)
    np.testing.assert_allclose(table["offset_y_mm"][known], 3e-2)
    assert table[["coverage_pct", "ovality_sigma_pct", "residual_rms_mm"]].isna().all(axis=None)


def test_twelve_o_clock_is_never_written_as_zero():
    survey = finished_survey(stations=3, bearings=24, dense=True)
    turned = survey.metrics.assign(axis_bearing=("station", np.array([np.pi / 2, np.pi / 2 - 1e-7, 0.0])))
    groups = {name: survey.group(name) for name in survey.groups} | {"metrics": turned}
    assert stations_table(Survey(groups))["axis_clock_h"].tolist() == [12.0, 12.0, 3.0]


def test_poses_of_more_rings_than_stations_are_taken_at_the_nearest_ring():
    survey = finished_survey(stations=40, bearings=24, dense=True)
    every_other = {n: survey.group(n).isel(station=slice(0, None, 2)) for n in ("section", "metrics")}
    groups = {name: survey.group(name) for name in survey.groups} | every_other
    table = stations_table(Survey(groups))
    np.testing.assert_array_equal(table["offset_y_mm"], survey.pose["offset_y"].values[::2] * 1e3)


def test_features_are_escaped_for_spreadsheets(tmp_path):
    features = xr.Dataset(
        {
            "kind": ("feature", np.array(["=cmd|' /C calc'!A0", 'a "wide", joint'], object)),
            "chainage": ("feature", np.array([1.0, 2.0])),
            "bearing": ("feature", np.array([np.pi / 2, np.nan])),
        }
    )
    table = features_table(Survey({"features": features}))
    write_csv(table, tmp_path / "features.csv", FEATURE_DECIMALS)
    first, second = read(tmp_path / "features.csv")
    assert tuple(first) == FEATURE_COLUMNS
    assert first["kind"].startswith("'=") and second["kind"] == 'a "wide", joint'
    assert (first["clock_h"], second["clock_h"], first["size_mm"], first["image"]) == ("12.000", "", "", "")


def test_without_features_the_heading_stands_alone(survey, tmp_path):
    table = features_table(Survey({"rings": survey.rings}))
    write_csv(table, tmp_path / "features.csv", FEATURE_DECIMALS)
    assert (tmp_path / "features.csv").read_text() == ",".join(FEATURE_COLUMNS) + "\n"


def test_a_long_survey_is_written_in_blocks_like_a_short_one(tmp_path):
    survey = finished_survey(stations=9000, bearings=24, dense=True)
    table = stations_table(survey)
    began = time.perf_counter()
    write_csv(table, tmp_path / "stations.csv", STATION_DECIMALS)
    assert time.perf_counter() - began < 10
    rows = read(tmp_path / "stations.csv")
    assert len(rows) == 9000
    for column in STATION_COLUMNS:
        if column.name in STATION_DECIMALS:
            written = np.array([float(r[column.name] or "nan") for r in rows])
            np.testing.assert_allclose(written, table[column.name], atol=0.5001 * 10.0**-column.decimals)


def test_an_unfinished_survey_is_refused(survey):
    with pytest.raises(ContractError, match="/section is missing"):
        stations_table(Survey({"rings": survey.rings}))


def test_summary_holds_the_promised_keys_and_plain_json(survey):
    result = summary(survey)
    promised = (
        "name, length_m, stations, nominal_diameter_mm, coverage_pct, unseen_m, diameter_mean_mm, diameter_sigma_mm, "
        "diameter_sigma_fit_mm, diameter_sigma_scale_mm, ovality_polar_max_pct, ovality_polar_max_chainage_m, "
        "deflection_max_pct, deflection_max_chainage_m, area_loss_max_pct, features, rules, warnings, assumptions, "
        "version, ovality_polar_max_sigma_pct, deflection_max_sigma_pct, area_loss_max_sigma_pct"
    )
    assert set(result) == set(promised.split(", "))
    assert json.loads(json.dumps(result, allow_nan=False)) == result
    assert result["deflection_max_pct"] == pytest.approx(4.0, abs=1e-3)
    at = int(np.nanargmax(survey.metrics["deflection"].values))
    assert result["deflection_max_sigma_pct"] == pytest.approx(
        100 * survey.metrics["deflection_sigma"].values[at], abs=1e-4
    )
    assert result["deflection_max_chainage_m"] == pytest.approx(20.0, abs=0.02)
    assert result["coverage_pct"] == pytest.approx(100 * float(survey.section["coverage"].mean()), abs=0.01)
    # 0.6 m behind the missing arc, 0.4 m without readings enough, 0.5 m without any station.
    assert result["unseen_m"] == pytest.approx(1.5, abs=0.03)


def test_summary_without_nominal_diameter_says_null():
    result = summary(finished_survey(stations=50, bearings=36, nominal=None, dense=True))
    assert result["deflection_max_pct"] is None and result["nominal_diameter_mm"] is None
    assert result["ovality_polar_max_pct"] > 3
