"""`springline inspect --back`: what it writes, and what it says of a back pass that cannot be used."""

import json

import numpy as np
import pytest

import springline as sl
from springline.simulate import parse, simulate

from .command_line import run

SCENARIO = """
name = "short"
[pipe]
diameter = "300mm"
start = [0.0, 0.0, 10.0]
run = [{{ kind = "straight", length = 9.0 }}]
[[pipe.section]]
shape = "ellipse"
semi_major = {{ mean = 0.153, amplitude = 0.001, period = 2.0 }}
semi_minor = 0.148
[robot]
length = 0.4
from_end = {back}
[rings]
spacing = "20mm"
bearings = 120
noise = "0.5mm"
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    for name, word in (("out", "false"), ("back", "true")):
        sl.write(simulate(parse(SCENARIO.format(back=word)), seed=len(name)), folder / f"{name}.zarr.zip")
    return folder


def test_rings_alone_are_joined_where_their_sections_agree(files, tmp_path):
    done = run("inspect", files / "out.zarr.zip", "--back", files / "back.zarr.zip", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "joined by what both counters and sections say" in done.stderr
    result = sl.read(tmp_path / "out" / "survey.zarr.zip")
    alone = sl.inspect(sl.read(files / "out.zarr.zip"))
    ratio = result.section["covariance"].values[:, 0, 0] / alone.section["covariance"].values[:, 0, 0]
    assert np.median(ratio) == pytest.approx(0.5, abs=0.1)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "springline inspect out.zarr.zip --nominal 300mm --back back.zarr.zip" in page
    read = json.loads(result.attrs["provenance"])
    assert [one["name"] for one in read["inputs"]][:2] == ["out.zarr.zip", "back.zarr.zip"]


def test_a_back_pass_that_cannot_be_used_is_an_error_of_the_input(files, tmp_path):
    (tmp_path / "text.csv").write_text("distance_m,r_0_mm\n0,1\n")
    for path, said in ((tmp_path / "none.zarr", "no such file"), (tmp_path / "text.csv", "text.csv")):
        done = run("inspect", files / "out.zarr.zip", "--back", path, "-o", tmp_path / "out")
        assert done.returncode == 2
        assert said in done.stderr
        assert not (tmp_path / "out").exists()


def ring_table(path, distances):
    header = ",".join(["distance_m", *(f"r_{k}_mm" for k in range(24))])
    rows = [",".join(map(str, (d, *[150.0 + (k * 7 + d) % 3 for k in range(24)]))) for d in distances]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_a_counter_that_comes_back_makes_two_passes_or_says_why_not(tmp_path):
    table = ring_table(tmp_path / "rings.csv", (*range(20), *range(18, -1, -1)))
    done = run("inspect", table, "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "The counter goes out to 19.00 m and comes back" in done.stderr
    assert "The way back was left aside: " in done.stderr
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["stations"] == 20


@pytest.mark.parametrize(
    ("distances", "row"),
    [
        ((*range(20), *range(18, 12, -1)), 22),
        ((*range(20), *range(18, 3, -1), *range(5, 15)), 22),
        ((*range(15), 14, *range(15, 30)), 17),
        ((*range(15), 12.5, *range(15, 30)), 17),
    ],
)
def test_counters_that_go_elsewhere_are_refused_with_the_row(tmp_path, distances, row):
    done = run("inspect", ring_table(tmp_path / "rings.csv", distances), "-o", tmp_path / "out")
    assert done.returncode == 2
    assert f"row {row}" in done.stderr
    assert "come back once" in done.stderr
