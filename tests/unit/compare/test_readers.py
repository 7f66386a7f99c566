"""Readers: PACP conditions and plain columns become features in m and rad."""

from __future__ import annotations

from datetime import time

import numpy as np
import pandas as pd
import pytest

from springline.compare import KINDS, column_features, pacp_features
from springline.conventions import clock_from_bearing
from springline.errors import FormatError, InputError

PACP = pd.DataFrame(
    {
        "InspectionID": ["3", "4", "4", "4", "4", "4", "4"],
        "Distance": ["1", "0", "0", "9", "20.5", "42.4", "76.1"],
        "PACP_Code": ["TFA", "AMH", "MWL", "TFA", "LFW", "TBD", "AMH"],
        "Clock_At_From": ["1", "", "", "9", "2", "", ""],
        "Value_1st_Dimension": ["", "", "", "6", "", "", ""],
    }
)


def test_pacp_taps_and_manholes_in_metres():
    found = pacp_features(PACP, 4)
    np.testing.assert_allclose(found.chainage, np.array([0, 9, 42.4, 76.1]) * 0.3048)
    assert [KINDS[k] for k in found.kind] == ["manhole", "lateral", "lateral", "manhole"]
    assert clock_from_bearing(found.bearing[1]) == pytest.approx(9.0)
    assert found.size[1] == pytest.approx(0.1524)
    assert np.isnan(found.bearing[[0, 2, 3]]).all()


def test_pacp_names_what_is_missing():
    with pytest.raises(FormatError, match="no column 'PACP_Code'"):
        pacp_features(PACP.drop(columns="PACP_Code"), 4)
    with pytest.raises(InputError, match="inspection 99: there is no such inspection"):
        pacp_features(PACP, 99)
    with pytest.raises(InputError, match="inspection 4: there is no feature in it"):
        pacp_features(PACP.assign(PACP_Code="MWL"), 4)


def test_pacp_unsorted_is_refused_unless_asked_for():
    turned = PACP.iloc[::-1].reset_index(drop=True)
    with pytest.raises(InputError, match="Sort the list by chainage"):
        pacp_features(turned, 4)
    np.testing.assert_allclose(pacp_features(turned, 4, sort=True).chainage, pacp_features(PACP, 4).chainage)


def test_a_cell_that_is_no_number_is_named_by_row_and_column():
    bad = PACP.assign(Distance=["1", "0", "0", "9 ft", "20.5", "42.4", "76.1"])
    with pytest.raises(InputError, match="row 4 of the table, column Distance"):
        pacp_features(bad, 4)


def test_plain_columns_by_a_map():
    tally = {"log": [0, 40, 80], "what": ["weld", "anode", "tee"], "pos": [None, 6, 12], "dn": [None, None, 2]}
    columns = {"chainage": "log", "kind": "what", "clock": "pos", "size": "dn"}
    found = column_features(
        tally, columns, kinds={"weld": "joint", "tee": "lateral"}, length_unit="ft", size_unit="in", name="tally"
    )
    np.testing.assert_allclose(found.chainage, [0.0, 24.384])
    assert found.bearing[1] == pytest.approx(np.pi / 2)
    assert found.size[1] == pytest.approx(0.0508)


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"chainage": "logg"}, "did you mean 'log'"),
        ({"chainge": "log"}, "did you mean 'chainage'"),
        ({"clock": "log"}, "does not say where the chainage is"),
    ],
)
def test_a_wrong_map_is_told(columns, told):
    with pytest.raises(FormatError, match=told):
        column_features({"log": [0, 1]}, columns)


def test_an_unknown_unit_is_told():
    with pytest.raises(InputError, match="unit 'feet'"):
        column_features({"x": [0, 1]}, {"chainage": "x"}, length_unit="feet")


@pytest.mark.parametrize(
    ("cell", "hours"),
    [("4:30", 4.5), ("04:30:00", 4.5), (time(4, 30), 4.5), ("4.5", 4.5), ("12:45", 0.75), ("0", 12.0)],
)
def test_clocks_are_hours_or_hours_and_minutes(cell, hours):
    found = column_features({"x": [0, 1], "o'clock": ["", cell]}, {"chainage": "x", "clock": "o'clock"})
    assert clock_from_bearing(found.bearing[1]) == pytest.approx(hours)


@pytest.mark.parametrize("cell", ["144", "-3", "inf", "15", "4:75", "4:30:00:00", "three"])
def test_what_is_no_clock_is_refused(cell):
    with pytest.raises(InputError, match=r"row 2 of the table, column o'clock.* not a clock"):
        column_features({"x": [0, 1], "o'clock": ["", cell]}, {"chainage": "x", "clock": "o'clock"})
    with pytest.raises(InputError, match=r"column Clock_At_From.* not a clock"):
        pacp_features(PACP.assign(Clock_At_From=cell), 4)


def test_a_row_that_repeats_another_is_read_once_and_counted():
    table = {
        "x": [0, 4, 4, 4, 4],
        "kind": ["joint", "lateral", "lateral", "lateral", "joint"],
        "clock": ["", 3, 9, 3, ""],
    }
    found = column_features(table, {"chainage": "x", "kind": "kind", "clock": "clock"})
    assert found.repeated == 1
    assert [KINDS[k] for k in found.kind] == ["joint", "lateral", "lateral", "joint"]
    np.testing.assert_allclose(clock_from_bearing(found.bearing[1:3]), [3.0, 9.0])
