"""`springline inspect` and `demo`, as a user meets them: results, exit codes, messages, nothing half-written."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import springline as sl
from springline.conventions import STATION_COLUMNS
from springline.survey import open_survey

from .command_line import run

FILES = {
    "summary.json",
    "stations.csv",
    "stations_sigma.csv",
    "features.csv",
    "survey.zarr.zip",
    "report.html",
    "report.pdf",
    "viewer.html",
    "pipe.glb",
    "config.toml",
}


def rings_csv(path, radius_mm=150.0, rings=40, header_unit="_mm", spoil=None):
    """A ring table of a slightly oval pipe, written without the library."""
    rng = np.random.default_rng(3)
    bearings = np.arange(72) * 2 * np.pi / 72
    radii = radius_mm * (1 + 0.01 * np.cos(2 * bearings)) + 0.3 * rng.standard_normal((rings, 72))
    rows = [[f"{0.02 * i:.3f}", *(f"{r:.3f}" for r in row)] for i, row in enumerate(radii)]
    if spoil:
        spoil(rows)
    header = ["distance_m", *(f"r_{k}{header_unit}" for k in range(72))]
    path.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n")
    return path


@pytest.fixture(scope="module")
def demo(tmp_path_factory):
    out = tmp_path_factory.mktemp("demo") / "report"
    words = [sys.executable, "-m", "springline", "demo", "-o", str(out)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return out, done


def test_demo_writes_every_file_and_says_where_the_report_is(demo):
    out, done = demo
    assert {p.name for p in out.iterdir()} == FILES
    assert str(out / "report.html") in done.stdout
    assert (out / "report.html").stat().st_size < 5e6
    assert (out / "viewer.html").stat().st_size < 30e6


def test_stations_have_the_promised_columns_and_no_zero_for_missing(demo):
    stations = pd.read_csv(demo[0] / "stations.csv")
    sigma = pd.read_csv(demo[0] / "stations_sigma.csv")
    assert list(stations.columns) == list(sigma.columns) == [c.name for c in STATION_COLUMNS]
    assert stations["easting_m"].isna().all()
    fitted = stations["diameter_max_mm"].notna()
    assert fitted.mean() > 0.99
    assert (stations["diameter_max_mm"] >= stations["diameter_min_mm"])[fitted].all()
    assert (sigma["diameter_area_mm"].dropna() > 0).all()


def test_demo_recovers_the_truth_it_never_reads(demo):
    stations = pd.read_csv(demo[0] / "stations.csv")
    sigma = pd.read_csv(demo[0] / "stations_sigma.csv")
    truth = open_survey(sl.builtin_survey()).truth
    chainage = truth["ring_chainage"].values
    plain = np.array(stations["flags"] != "unlike_neighbours")
    for kind, where, length in zip(
        truth["feature_kind"].values, truth["feature_chainage"].values, truth["feature_length"].values, strict=True
    ):
        if length < 5:
            plain &= np.abs(chainage - where) > length / 2 + 0.1 + 0.1 * float(kind == 4)
    plain &= stations["diameter_area_mm"].notna().to_numpy()
    for name in ("diameter_area", "diameter_x", "diameter_y"):
        true = np.interp(chainage, truth["chainage"].values, truth[name].values) * 1e3
        error = np.abs(stations[f"{name}_mm"] - true)[plain]
        assert np.median(error) < 0.2
        assert error.max() < 1.5
        assert np.mean(error < 1.96 * sigma[f"{name}_mm"][plain]) > 0.95


def test_deleting_truth_changes_nothing(demo, tmp_path):
    survey = open_survey(sl.builtin_survey())
    groups = {name: survey.group(name) for name in survey.groups if name != "truth"}
    sl.write(sl.Survey(groups, survey.attrs), tmp_path / "blind.zarr.zip")
    done = run("inspect", tmp_path / "blind.zarr.zip", "-o", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "stations.csv").read_text() == (demo[0] / "stations.csv").read_text()


def test_result_can_be_inspected_again_with_the_same_numbers(demo, tmp_path):
    done = run("inspect", demo[0] / "survey.zarr.zip", "-o", tmp_path / "again")
    assert done.returncode == 0, done.stderr
    first = pd.read_csv(demo[0] / "stations.csv")["diameter_area_mm"]
    again = pd.read_csv(tmp_path / "again" / "stations.csv")["diameter_area_mm"]
    assert np.allclose(first, again, atol=2e-3, equal_nan=True)


def test_summary_json_on_stdout(tmp_path):
    table = rings_csv(tmp_path / "run.csv")
    done = run("inspect", table, "--nominal", "300mm", "-o", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found == json.loads((tmp_path / "out" / "summary.json").read_text())
    assert found["diameter_mean_mm"] == pytest.approx(300, abs=0.2)
    parts = np.hypot(found["diameter_sigma_fit_mm"], found["diameter_sigma_scale_mm"])
    assert found["diameter_sigma_mm"] == pytest.approx(parts, abs=1e-3)
    assert any("crown" in sentence for sentence in found["assumptions"])


@pytest.mark.parametrize(("limit", "code", "verdict"), [("deflection-5", 0, "pass"), ("tight.toml", 3, "fail")])
def test_rules_decide_the_exit_code(tmp_path, limit, code, verdict):
    rule = Path(sl.__file__).parent / "design" / "rules" / "deflection-5.toml"
    (tmp_path / "tight.toml").write_text(rule.read_text().replace("limit = 0.05", "limit = 0.0001"))
    done = run(
        "inspect", rings_csv(tmp_path / "run.csv"), "--nominal", "300mm", "-o", "out", "--check", limit, cwd=tmp_path
    )
    assert done.returncode == code, done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert [rule["verdict"] for rule in summary["rules"]] == [verdict]


def test_a_rule_without_reference_diameter_is_not_assessed(tmp_path):
    done = run("inspect", rings_csv(tmp_path / "run.csv"), "-o", tmp_path / "out", "--check", "deflection-5")
    assert done.returncode == 3
    assert "not_assessed" in done.stdout


def empty(path):
    path.write_bytes(b"")


def cut(path):
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _nan(rows):
    for row in rows:
        row[1:] = ["nan"] * 72


def _word(rows):
    rows[4][6] = "abc"


def _repeat(rows):
    rows[5][0] = rows[4][0]


def _back(rows):
    rows[5][0] = "0.001"


@pytest.mark.parametrize(
    ("spoil", "words", "expected"),
    [
        (None, ["nowhere.csv"], ["nowhere.csv", "no such file"]),
        (_nan, [], ["run.csv", "missing"]),
        (_word, [], ["run.csv", "row 6", "r_5_mm", "abc"]),
        (_repeat, [], ["run.csv", "repeat"]),
        (_back, [], ["run.csv", "back"]),
        (None, ["--nominal", "3000mm"], ["run.csv", "3 m", "--nominal"]),
        (None, ["--nominal", "300"], ["--nominal", "400mm"]),
        (None, ["--nominal", "-300mm"], ["--nominal"]),
        (None, ["--check", "deflection-6"], ["deflection-6", "deflection-5"]),
        (None, ["--config", "none.toml"], ["none.toml", "--config"]),
        (None, ["--spacing", "0mm"], ["--spacing"]),
    ],
)
def test_bad_input_ends_with_one_message_and_nothing_written(tmp_path, spoil, words, expected):
    table = rings_csv(tmp_path / "run.csv", spoil=spoil)
    inputs = [tmp_path / words[0]] if words and not words[0].startswith("--") else [table]
    options = words if words and words[0].startswith("--") else []
    done = run("inspect", *inputs, "-o", tmp_path / "out", *options, cwd=tmp_path)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    for word in expected:
        assert word in done.stderr, done.stderr
    assert {p.name for p in tmp_path.iterdir()} == {"run.csv"}


@pytest.mark.parametrize("damage", [empty, cut])
@pytest.mark.parametrize("name", ["cloud.ply", "cloud.laz", "run.zarr.zip"])
def test_damaged_files_are_refused(tmp_path, name, damage):
    path = tmp_path / name
    if name.endswith("zip"):
        shutil.copy(sl.builtin_survey(), path)
    else:
        angle = np.random.default_rng(0).uniform(0, 2 * np.pi, 4000)
        along = np.linspace(0, 1, 4000)
        cloud = sl.Survey({"points": _points(along, 0.15 * np.sin(angle), 0.15 * np.cos(angle))}, {"name": "c"})
        sl.write(cloud, path)
    damage(path)
    done = run("inspect", path, "-o", tmp_path / "out")
    assert done.returncode == 2, done.stderr
    assert name in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def _points(x, y, z):
    import xarray as xr

    return xr.Dataset(
        {"x": ("point", x), "y": ("point", y), "z": ("point", z)},
        attrs={"source_axes": "x,y,z", "sensor_kind": "unknown", "origin_is_sensor": 0},
    )


@pytest.mark.parametrize("shape", ["plane", "box", "sphere", "noise"])
def test_a_cloud_that_is_not_a_pipe_is_refused(tmp_path, shape):
    rng = np.random.default_rng(1)
    if shape == "plane":
        points = np.column_stack([rng.uniform(0, 1, (6000, 2)), 0.001 * rng.standard_normal(6000)])
    elif shape == "box":
        points = rng.uniform(-0.5, 0.5, (12000, 3))
        points[np.arange(12000), rng.integers(0, 3, 12000)] = rng.choice([-0.5, 0.5], 12000)
    elif shape == "sphere":
        points = rng.standard_normal((8000, 3))
        points *= 0.2 / np.linalg.norm(points, axis=1, keepdims=True)
    else:
        points = rng.uniform(-0.3, 0.3, (8000, 3))
    path = tmp_path / "thing.xyz"
    np.savetxt(path, points)
    done = run("inspect", path, "--unit", "m", "-o", tmp_path / "out")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "pipe" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_folder_of_mixed_files_goes_on_only_when_told(tmp_path):
    folder = tmp_path / "scans"
    folder.mkdir()
    rings_csv(folder / "good.csv")
    rings_csv(folder / "fine.csv", radius_mm=100)
    (folder / "bad.ply").write_bytes(b"ply\nformat ascii 1.0\nelement vertex 100\n")
    (folder / "notes.txt").write_text("call the client back\n")
    refused = run("inspect", folder, "-o", tmp_path / "out")
    assert refused.returncode == 2
    assert "bad.ply" in refused.stderr
    assert "notes.txt" in refused.stderr
    assert "--keep-going" in refused.stderr
    assert not (tmp_path / "out").exists()
    done = run("inspect", folder, "-o", tmp_path / "out", "--keep-going")
    assert done.returncode == 0, done.stderr
    assert "bad.ply" in done.stderr
    index = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert {scan["folder"] for scan in index["scans"]} == {"good", "fine"}
    assert {p.name for p in (tmp_path / "out" / "good").iterdir()} == FILES


def test_existing_results_are_kept_without_force(tmp_path):
    table = rings_csv(tmp_path / "run.csv")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.txt").write_text("years of work")
    assert run("inspect", table, "-o", tmp_path / "out").returncode == 2
    forced = run("inspect", table, "-o", tmp_path / "out", "--force")
    assert forced.returncode == 2
    assert (tmp_path / "out" / "thesis.txt").read_text() == "years of work"


@pytest.mark.parametrize("kind", ["folder", "pipe"])
@pytest.mark.parametrize("option", ["config", "overrides", "calibration", "design-line", "back"])
def test_a_file_to_read_beside_is_a_file(tmp_path, option, kind):
    given = tmp_path / "beside.toml"
    given.mkdir() if kind == "folder" else os.mkfifo(given)
    done = run("inspect", rings_csv(tmp_path / "a.csv"), f"--{option}", given, "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "beside.toml: " in done.stderr and done.stderr.count("springline: ") == 1
    assert not (tmp_path / "out").exists()


def test_demo_refuses_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr("springline.data.builtin_survey", lambda: pytest.fail("the work was begun"))
    done = run("demo", "-o", tmp_path)
    assert done.returncode == 2
    assert f"{tmp_path}: it exists already" in done.stderr


def test_the_version_is_said():
    done = run("--version")
    assert (done.returncode, done.stdout) == (0, f"springline {sl.__version__}\n")


def test_import_loads_no_heavy_library():
    code = "import sys, springline; print([m for m in ('numpy', 'xarray', 'numba', 'pydantic') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "[]\n"
