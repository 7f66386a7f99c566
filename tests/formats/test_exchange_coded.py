"""ISYBAU, DWA-M 150, EN 13508-2 and PACP tables: read completely, written back equivalent."""

import json
import shutil
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import springline as sl
import springline.errors
from springline.conventions import clock_from_bearing
from springline.errors import FormatError, InputError
from springline.io.observations import TEXTS, inspections_of

from ..unit.outputs.finished import finished_survey
from .conftest import make_rings
from .isybau_structure import faults

HERE = Path(__file__).parent
SHARED = HERE.parents[1] / ".." / "shared" / "data"
EN = SHARED / "en13508-2-example" / "example_13508_2.txt"
PACP = SHARED / "pacp-repeat-inspections"

SAMPLES = {
    "en13508": ("en13508.txt", "latin-1"),
    "isybau": ("isybau.xml", "latin-1"),
    "m150": ("m150.xml", "latin-1"),
    "pacp": ("Conditions.csv", "utf-8"),
}


def sample(key, folder):
    """Return a copy of a sample, so that what is written beside it lands in a folder of the test."""
    return Path(shutil.copy(HERE / "samples" / SAMPLES[key][0], folder))


@pytest.mark.parametrize("key", SAMPLES)
def test_format_is_told_by_content_and_comes_back_equal(key, tmp_path):
    survey = sl.read(sample(key, tmp_path))
    assert survey.observations.attrs["format"] == key
    again = sl.read(sl.write(survey, tmp_path / "again", format=key))
    xr.testing.assert_allclose(again.observations, survey.observations, rtol=0, atol=1e-9)
    for one, other in zip(inspections_of(again), inspections_of(survey), strict=True):
        assert (one.common, one.own) == (other.common, other.own)
    assert json.loads(again.observations.attrs["layout"]) == json.loads(survey.observations.attrs["layout"])


def test_en13508_in_words_and_units(tmp_path):
    survey = sl.read(sample("en13508", tmp_path))
    data = survey.observations
    assert data["distance"].values.tolist() == [0.0, 12.5, 13.0]
    assert data["kind"].values.tolist() == ["start", "lateral", ""]
    np.testing.assert_allclose(data["bearing"].values, [np.nan, np.pi, np.nan])
    np.testing.assert_allclose(data["bearing_to"].values[1], np.pi / 2)
    assert data["remarks"].values[1] == 'gro\u00df; "neu"' and data["continuous"].values[1] == "A1"
    assert json.loads(data["fields"].values[1]) == {"L": "left"}
    assert survey.attrs["name"] == "R1" and survey.attrs["direction"] == "downstream"
    assert survey.attrs["date"] == "2007-07-19" and survey.attrs["nominal_diameter"] == 0.3
    assert any("BZZ" in sentence for sentence in survey.assumptions)


def test_isybau_carries_what_it_does_not_read(tmp_path):
    survey = sl.read(sample("isybau", tmp_path))
    data = survey.observations
    assert data["name"].values.tolist() == ["H7"] and survey.attrs["direction"] == "upstream"
    assert data["quantification_1"].values[1] == "100.00" and data["continuous"].values[1] == "A2"
    assert any("1 inspected manholes" in sentence for sentence in survey.assumptions)
    root = ET.parse(sl.write(survey, tmp_path / "b.isybau.xml")).getroot()
    ns = "{http://www.ofd-hannover.la/Identifikation}"
    assert root.tag == f"{ns}Identifikation"
    assert [e.text for e in root.iter(f"{ns}Objektbezeichnung")] == ["S1", "H7"]
    assert root.find(f".//{ns}MaxSKeAuto").text == "2" and root.find(f".//{ns}Frame").text == "55650"
    pipe = next(e for e in root.iter(f"{ns}Rohrleitung"))
    assert faults(pipe) == []


def test_a_later_isybau_file_becomes_2006_without_what_is_carried(tmp_path):
    survey = sl.read(sample("isybau", tmp_path))
    root = ET.parse(sl.write(survey, tmp_path / "old.xml", format="isybau-2006")).getroot()
    ns = "{http://www.ofd-hannover.la/Identifikation}"
    assert root.find(f"{ns}Version").text == "2006-10" and faults(root) == []
    other = sl.read(tmp_path / "old.xml").observations
    assert other["code"].values.tolist() == survey.observations["code"].values.tolist()


def test_m150_numbers_with_comma_or_point_and_several_inspections(tmp_path):
    data = sl.read(sample("m150", tmp_path)).observations
    assert data["distance"].values.tolist() == [0.0, 2.5, 1.25]
    assert data["inspection_row"].values.tolist() == [0, 0, 1]
    first = inspections_of(sl.read(tmp_path / "m150.xml"))[0].common
    assert first["date"] == "2006-04-07" and first["height_mm"] == "310" and first["direction"] == "upstream"


def test_pacp_in_feet_unless_said_otherwise(tmp_path):
    path = sample("pacp", tmp_path)
    survey = sl.read(path)
    np.testing.assert_allclose(survey.observations["distance"].values, np.array([0, 35.1, 103.9]) * 0.3048)
    assert any("feet" in sentence for sentence in survey.assumptions)
    assert sl.read(path, unit="m").observations["distance"].values[1] == 35.1
    written = sl.write(survey, tmp_path / "out.pacp")
    text = (written / "Conditions.csv").read_text()
    assert "'=1+1" in text  # no spreadsheet runs it, and reading takes the apostrophe off again
    assert sl.read(written).observations["remarks"].values[1] == "=1+1"


@pytest.mark.parametrize("wanted", ["isybau", "isybau-2006", "m150"])
def test_codes_of_one_system_go_from_format_to_format(wanted, tmp_path):
    survey = sl.read(sample("en13508", tmp_path))
    other = sl.read(sl.write(survey, tmp_path / "x", format=wanted))
    for name in ("code", "kind", "characterisation_1", "continuous", "photo"):
        assert other.observations[name].values.tolist() == survey.observations[name].values.tolist(), name
    for name in ("distance", "bearing", "bearing_to"):
        np.testing.assert_allclose(other.observations[name].values, survey.observations[name].values, atol=1e-9)
    said = inspections_of(other)[0].common
    for word in ("name", "node_from", "node_to", "date", "direction", "operator"):
        assert said[word] == inspections_of(survey)[0].common[word], word


def test_what_was_read_goes_back_under_a_plain_extension(tmp_path):
    for key in ("en13508", "isybau", "m150"):
        path = sample(key, tmp_path)
        survey = sl.read(path)
        written = sl.write(survey, tmp_path / f"{key}-again{path.suffix}")
        assert sl.read(written).observations.attrs["format"] == key
    with pytest.raises(InputError, match="none of /rings"):
        sl.write(survey, tmp_path / "a.txt")


def test_codes_of_different_systems_are_not_translated(tmp_path):
    survey = sl.read(sample("pacp", tmp_path))
    with pytest.raises(InputError, match="no agreed counterparts"):
        sl.write(survey, tmp_path / "a.isybau.xml")


@pytest.mark.parametrize("wanted", ["isybau", "isybau-2006", "m150", "en13508", "pacp"])
def test_found_features_come_back(wanted, tmp_path):
    survey = finished_survey(stations=60, bearings=36)
    found = survey.features
    data = sl.read(sl.write(survey, tmp_path / "x", format=wanted)).observations
    inner = slice(1, -1)  # between the start and the end
    np.testing.assert_allclose(data["distance"].values[inner], found["chainage"].values, atol=0.006)
    assert all(kind in text for kind, text in zip(found["kind"].values, data["remarks"].values[inner], strict=True))
    turn = data["bearing"].values[inner] - found["bearing"].values
    known = np.isfinite(turn)
    assert known.any()
    hours = np.round(clock_from_bearing(data["bearing"].values[inner][known]), 6)
    np.testing.assert_array_equal(hours % 1, 0)  # whole ones, as these formats have them
    assert (np.abs((turn[known] + np.pi) % (2 * np.pi) - np.pi) <= np.pi / 12 + 1e-9).all()


@pytest.mark.parametrize("edition", ["isybau", "isybau-2006"])
def test_written_isybau_follows_its_published_structure(edition, tmp_path):
    results = finished_survey(stations=60, bearings=36, name="A name that is longer than thirty letters \u0424\n&<x>")
    coded = sl.read(sample("en13508", tmp_path))
    for k, survey in enumerate((results, coded)):
        root = ET.parse(sl.write(survey, tmp_path / f"{k}.xml", format=edition)).getroot()
        assert root.tag == "{http://www.ofd-hannover.la/Identifikation}Identifikation"
        assert faults(root) == []


def test_isybau_refuses_what_its_stations_cannot_say(tmp_path):
    survey = finished_survey(stations=60, bearings=36, length=1200.0)
    with pytest.raises(InputError, match=r"beyond 999\.99 m"):
        sl.write(survey, tmp_path / "a.isybau.xml")
    assert sl.write(survey, tmp_path / "a.m150.xml").exists()


@pytest.mark.shared
@pytest.mark.skipif(not EN.is_file(), reason="needs ../shared/data/en13508-2-example")
def test_the_example_of_en13508_is_written_back_byte_for_byte(tmp_path):
    survey = sl.read(EN)
    assert survey.observations.sizes == {"observation": 335, "inspection": 19}
    lines = EN.read_text("latin-1").splitlines()
    assert sum(not line.startswith("#") for line in lines) - 19 == 335  # all rows but the values under #B01
    assert sl.write(survey, tmp_path / "a.en13508.txt").read_bytes() == EN.read_bytes()


@pytest.mark.shared
@pytest.mark.skipif(not PACP.is_dir(), reason="needs ../shared/data/pacp-repeat-inspections")
def test_real_pacp_tables_are_read_completely():
    data = sl.read(PACP).observations
    assert data.sizes == {"observation": 27_828, "inspection": 3_618}
    assert int((data["kind"] == "lateral").sum()) == 9_472
    assert np.isfinite(data["distance"].values).all()


@pytest.mark.parametrize(
    ("key", "old", "new", "said"),
    [
        ("en13508", "12,5;", "twelve;", "row 13, column I"),
        ("en13508", "#C=", "#Q=", "row 11"),
        ("en13508", ";9;12;", ";15;12;", "no clock position"),
        ("isybau", "<Station>27.30", "<Station>2x", "RZustand 2, Station"),
        ("isybau", "</Identifikation>", "", "not an XML file"),
        ("m150", "<HZ001>2,5", "<HZ001>?", "HG 1, HZ 2, HZ001"),
        ("pacp", '"35.1"', '"a"', "row 3, column Distance"),
    ],
)
def test_faults_are_named_with_their_place(key, old, new, said, tmp_path):
    path = sample(key, tmp_path)
    raw = path.read_text(SAMPLES[key][1])
    assert old in raw
    path.write_text(raw.replace(old, new), SAMPLES[key][1])
    with pytest.raises(FormatError, match=said):
        sl.read(path)


def test_entities_are_refused(tmp_path):
    path = tmp_path / "a.xml"
    path.write_text('<!DOCTYPE DATA [<!ENTITY a "aaaa">]><DATA><FD>&a;</FD></DATA>')
    with pytest.raises(FormatError, match="entities"):
        sl.read(path)


def test_observations_are_stored_with_a_survey(tmp_path):
    survey = sl.read(sample("en13508", tmp_path))
    stored = sl.read(sl.write(survey, tmp_path / "s.zarr.zip"))
    for name in TEXTS:
        assert stored.observations[name].values.tolist() == survey.observations[name].values.tolist()
    written = sl.write(stored, tmp_path / "b.en13508.txt").read_bytes()
    assert written.split() == (HERE / "samples" / "en13508.txt").read_bytes().split()


def test_coded_files_alone_cannot_be_inspected(tmp_path):
    with pytest.raises(sl.errors.SpringlineError, match="no scan to inspect: the survey holds /observations"):
        sl.inspect(sl.read(sample("m150", tmp_path)))


def test_a_survey_folder_brings_what_was_coded_beside_its_rings(tmp_path):
    folder = tmp_path / "survey"
    sl.write(make_rings(), folder)
    shutil.copy(HERE / "samples" / "m150.xml", folder / "observations.xml")
    survey = sl.read(folder)
    assert survey.observations["code"].values.tolist() == ["BCD", "BCA", "BAB"]
    assert survey.attrs["name"] != "R9"  # the folder says what the asset is called
    assert survey.source().has("observations")
    (folder / "observations.xml").write_text((folder / "rings.csv").read_text())
    with pytest.raises(InputError, match="format 'csv'; expected en13508, isybau, m150, pacp"):
        sl.read(folder)
