"""Corrections beside a survey, and inches and feet, from the command line."""

import csv
import html
import json
import re
import shlex

import numpy as np
import pytest

import springline as sl

from .command_line import run

SIGNED = 'author = "A. <b>Surveyor</b>"\ndate = 2026-05-04\nreason = "=roots \\" & co"\n'
OVERRIDES = (
    f"[[mask]]\nfrom_m = 0.4\nto_m = 0.6\nfrom_clock = 10\nto_clock = 2\n{SIGNED}"
    f'[[add]]\nkind = "lateral"\nchainage_m = 0.5\nclock_h = 3\nsize_mm = 100\n{SIGNED}'
)


def write_rings(path):
    """Write 21 rings of a 300 mm pipe, oval by 2 %."""
    theta = np.arange(72) * 2 * np.pi / 72
    ranges = 150 + 3 * np.cos(2 * theta)
    rows = [f"{0.05 * k:.2f}," + ",".join(f"{r:.3f}" for r in ranges) for k in range(21)]
    header = "distance_m," + ",".join(f"r_{k}_mm" for k in range(72))
    path.write_text("\n".join([header, *rows]) + "\n")


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "survey"
    place.mkdir()
    write_rings(place / "rings.csv")
    (place / "survey.toml").write_text(
        'name = "A to B"\nnominal_diameter = "300mm"\n[sensor]\nbearing_zero = "right"\nbearing_sense = "ccw"\n'
    )
    return place


def rows(path):
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_a_survey_folder_brings_its_corrections(folder, tmp_path):
    (folder / "overrides.toml").write_text(OVERRIDES)
    done = run("inspect", folder, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "2 corrections made by hand stand in overrides.toml" in done.stderr
    result = sl.read(tmp_path / "out" / "survey.zarr.zip")
    assert [one["effect"] for one in result.overrides] == ["125 readings of 5 rings left out", "added"]
    features = rows(tmp_path / "out" / "features.csv")
    added = [row for row in features if row["source"] == "by hand"]
    assert [(row["kind"], row["chainage_m"], row["size_mm"]) for row in added] == [("lateral", "0.5000", "100.00")]
    page = (tmp_path / "out" / "report.html").read_text("utf-8")
    for one in result.overrides:
        assert one["effect"] in page
    assert "A. &lt;b&gt;Surveyor&lt;/b&gt;" in page and "<b>Surveyor" not in page


def test_a_file_has_them_beside_it_or_named(tmp_path):
    scan = tmp_path / "scan.csv"
    write_rings(scan)
    stated = ("--nominal", "300mm", "--bearing-zero", "right", "--bearing-sense", "ccw")
    (tmp_path / "scan.overrides.toml").write_text(OVERRIDES)
    assert run("inspect", scan, "-o", tmp_path / "a", *stated).returncode == 0
    assert len(sl.read(tmp_path / "a" / "survey.zarr.zip").overrides) == 2
    (tmp_path / "scan.overrides.toml").unlink()
    other = tmp_path / "mine.toml"
    other.write_text(OVERRIDES)
    done = run("inspect", scan, "-o", tmp_path / "b", *stated, "--overrides", other)
    assert done.returncode == 0, done.stderr
    assert len(sl.read(tmp_path / "b" / "survey.zarr.zip").overrides) == 2


def test_one_file_of_corrections_does_not_serve_two_scans(tmp_path):
    many = tmp_path / "many"
    many.mkdir()
    for name in ("a.csv", "b.csv"):
        write_rings(many / name)
    (many / "overrides.toml").write_text(OVERRIDES)
    done = run("inspect", many, "-o", tmp_path / "out", "--nominal", "300mm")
    assert done.returncode == 2 and "stands beside 2 surveys" in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_wrong_key_is_one_message(folder, tmp_path):
    (folder / "overrides.toml").write_text(OVERRIDES.replace("from_m", "form_m"))
    done = run("inspect", folder, "-o", tmp_path / "out")
    assert done.returncode == 2 and "unknown key 'form_m', did you mean 'from_m'" in done.stderr
    assert done.stderr.count("\n") == 1


def test_results_are_exported_by_convert(folder, tmp_path):
    assert run("inspect", folder, "-o", tmp_path / "out").returncode == 0
    stored = tmp_path / "out" / "survey.zarr.zip"
    done = run("convert", stored, tmp_path / "reach.csv", "--to", "reach-csv")
    assert done.returncode == 0 and "held by reach-csv: profile measures" in done.stderr
    row = rows(tmp_path / "reach.csv")[0]
    assert float(row["width_max_mm"]) == pytest.approx(306.0, abs=0.2)
    assert float(row["height_min_mm"]) == pytest.approx(294.0, abs=0.2)
    assert run("convert", stored, tmp_path / "a.isybau.xml").returncode == 0
    several = run("convert", stored, tmp_path / "a.xml")
    assert several.returncode == 2 and ".isybau.xml" in several.stderr and "--to" in several.stderr
    nowhere = run("convert", stored, tmp_path / "a.landxml.xml")
    assert nowhere.returncode == 2 and "where the pipe runs" in nowhere.stderr


def test_inches_and_feet(folder, tmp_path):
    for name, more in (("si", ()), ("us", ("--units", "us"))):
        assert run("inspect", folder, "-o", tmp_path / name, *more).returncode == 0
    si, us = rows(tmp_path / "si" / "stations.csv"), rows(tmp_path / "us" / "stations.csv")
    assert not [c for c in us[0] if c.endswith(("_mm", "_m", "_m2"))]
    for metric, inch in (("diameter_max_mm", "diameter_max_in"), ("diameter_y_mm", "diameter_y_in")):
        assert float(us[5][inch]) * 25.4 == pytest.approx(float(si[5][metric]), abs=1e-3)
    assert float(us[5]["chainage_ft"]) * 0.3048 == pytest.approx(float(si[5]["chainage_m"]), abs=1e-4)
    sigma = rows(tmp_path / "us" / "stations_sigma.csv")
    assert list(sigma[0]) == list(us[0])
    assert json.loads((tmp_path / "us" / "summary.json").read_text())["nominal_diameter_mm"] == 300.0
    assert 'units = "us"' in (tmp_path / "us" / "config.toml").read_text()
    page = (tmp_path / "us" / "report.html").read_text("utf-8")
    assert "[in]" in page and "[mm]" not in page and "[m]" not in page
    again = run("inspect", folder, "-o", tmp_path / "again", "--config", tmp_path / "us" / "config.toml")
    assert again.returncode == 0 and "diameter_max_in" in rows(tmp_path / "again" / "stations.csv")[0]
    wrong = run("inspect", folder, "-o", tmp_path / "no", "--units", "uk")
    assert wrong.returncode == 2 and "'uk' is unknown" in wrong.stderr


def told_command(report):
    """The words of the command that a report says makes its results again."""
    return shlex.split(html.unescape(re.search("springline inspect [^<]*", report.read_text("utf-8")).group()))[1:]


def test_the_command_that_the_report_tells_makes_the_same_results_again(tmp_path):
    write_rings(tmp_path / "two words.csv")
    (tmp_path / "mine.toml").write_text(OVERRIDES)
    stated = ["--bearing-zero", "crown", "--bearing-sense", "cw", "--nominal", "300mm", "--base", "298mm"]
    done = run("inspect", "two words.csv", *stated, "--overrides", "mine.toml", "-o", "out", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    command = told_command(tmp_path / "out" / "report.html")
    words = [word.replace("config.toml", "out/config.toml").replace("DIR", "again") for word in command]
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    for name in ("stations.csv", "features.csv", "summary.json"):
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "out" / name).read_bytes()
    # Inspected once more, the survey holds all that was stated, and is the only input.
    done = run("inspect", "out/survey.zarr.zip", "-o", "third", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    command = told_command(tmp_path / "third" / "report.html")
    assert command[1] == "survey.zarr.zip" and "two words.csv" not in command and "--overrides" not in command


def test_an_extension_that_no_format_has_is_told_all_that_have_one(folder, tmp_path):
    done = run("convert", folder, tmp_path / "out.foo")
    assert done.returncode == 2
    assert all(extension in done.stderr for extension in (".ply", ".gpkg", ".xlsx", ".isybau.xml"))
