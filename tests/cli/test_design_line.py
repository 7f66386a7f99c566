"""`springline inspect --design-line`: what it writes and tells, and what it says of a line that cannot be used."""

import json

import pandas as pd
import pytest

from springline.simulate import parse, simulate_to

from .command_line import run

SCENARIO = """
name = "short"
[pipe]
diameter = "300mm"
gradient = -0.01
start = [0.0, 0.0, 10.0]
run = [{ kind = "straight", length = 2.5 }]
[robot]
length = 0.4
offset_z = { amplitude = 0.02, period = 2.0 }
standstill = [{ chainage = 0.2, duration = 20.0 }]
[rings]
spacing = "20mm"
bearings = 120
[inertial]
rate = 50.0
gyro_noise_deg_sqrt_h = 0.3
accel_noise = 0.0005
[ties]
chainages = [0.2, 2.3]
sigma = "2mm"
"""


@pytest.fixture(scope="module")
def survey(tmp_path_factory):
    return simulate_to(tmp_path_factory.mktemp("made") / "survey.zarr.zip", parse(SCENARIO), 1)


def test_tables_summary_and_report_tell_of_the_line(survey, tmp_path):
    line = tmp_path / "line.csv"
    # The pipe's invert begins at 9.85 m and falls by 1 in 100; the line runs 20 mm below it.
    line.write_text("easting_m,northing_m,invert_elevation_m\n0,-1,9.84\n0,4,9.79\n")
    done = run("inspect", survey, "-o", tmp_path / "out", "--design-line", line)
    assert done.returncode == 0, done.stderr
    assert "off its design" in done.stdout
    stations = pd.read_csv(tmp_path / "out" / "stations.csv")
    assert stations["deviation_up_mm"].median() == pytest.approx(20.0, abs=7.0)
    assert (pd.read_csv(tmp_path / "out" / "stations_sigma.csv")["deviation_right_mm"] > 0).all()
    found = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert found["deviation_up_max_mm"] == pytest.approx(stations["deviation_up_mm"].max(), abs=0.01)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "Deviation from the design line" in page
    assert "--design-line line.csv" in page


def test_a_line_that_cannot_be_used_is_an_error_of_the_input(survey, tmp_path):
    line = tmp_path / "line.csv"
    line.write_text("chainage_m,elevation_m\n0,9.8\n5,9.7\n")
    for words, said in (
        (("--design-line", line), "--design-line-of invert"),
        (("--design-line", tmp_path / "none.csv"), "no such file"),
        (("--design-line-of", "axis"), "there is no design line"),
    ):
        done = run("inspect", survey, "-o", tmp_path / "out", *words)
        assert done.returncode == 2
        assert said in done.stderr
        assert not (tmp_path / "out").exists()
