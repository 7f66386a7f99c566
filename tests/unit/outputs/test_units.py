"""Inches and feet: numbers, names and headings change together."""

import json

import numpy as np
import pandas as pd
import pytest

from springline.conventions import STATION_COLUMNS
from springline.errors import ParameterError
from springline.outputs import tables
from springline.outputs.results import Results
from springline.outputs.units import SYSTEMS, column, converted, heading, unit


def test_factors_are_exact():
    assert unit("mm", "us").factor * 25.4 == pytest.approx(1.0, abs=1e-15)
    assert unit("m", "us").factor * 0.3048 == pytest.approx(1.0, abs=1e-15)
    assert unit("m2", "us").factor * 0.09290304 == pytest.approx(1.0, abs=1e-15)
    assert all(unit(name, "si").factor == 1.0 for name in ("mm", "m", "m2", "pct"))


def test_every_heading_and_column_of_the_stations_loses_its_metric_unit():
    for one in STATION_COLUMNS:
        name, title = column(one.name, "us"), heading(one.heading, "us")
        assert not name.endswith(("_mm", "_m", "_m2")), name
        assert not any(f"[{u}]" in title for u in ("mm", "m", "m2")), title
        assert heading(one.heading, "si") == one.heading and column(one.name, "si") == one.name


def test_tables_convert_numbers_and_leave_the_rest(survey):
    table = tables.stations_table(survey)
    us, decimals = converted(table, tables.STATION_DECIMALS, "us")
    np.testing.assert_allclose(us["diameter_max_in"] * 25.4, table["diameter_max_mm"])
    np.testing.assert_allclose(us["chainage_ft"] * 0.3048, table["chainage_m"])
    np.testing.assert_array_equal(us["ovality_polar_pct"], table["ovality_polar_pct"])
    assert list(us["flags"]) == list(table["flags"]) and len(us.columns) == len(table.columns)
    assert set(decimals) == {column(name, "us") for name in tables.STATION_DECIMALS}


def test_a_written_table_loses_no_precision(survey, tmp_path):
    table = tables.stations_table(survey)
    for system in SYSTEMS:
        tables.write_csv(table, tmp_path / f"{system}.csv", tables.STATION_DECIMALS, units=system)
    si, us = (pd.read_csv(tmp_path / f"{system}.csv") for system in SYSTEMS)
    np.testing.assert_allclose(us["diameter_max_in"] * 25.4, si["diameter_max_mm"], atol=7e-4)
    np.testing.assert_allclose(us["chainage_ft"] * 0.3048, si["chainage_m"], atol=7e-5)


def test_the_run_says_in_which_units_people_read_it(survey):
    assert Results(survey).units == "si"
    record = json.loads(survey.attrs["provenance"])
    record["config"]["outputs"] = {"units": "us"}
    assert Results(survey.with_attrs(provenance=json.dumps(record))).units == "us"


def test_an_unknown_system_is_refused():
    with pytest.raises(ParameterError, match=r"'uk' is unknown.*expected si or us"):
        unit("mm", "uk")
