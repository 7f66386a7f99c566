"""`springline calibrate`: files in, a calibration out that the next inspection uses, and what is refused how."""

import csv
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from springline.simulate.attitude import in_pipe

from .command_line import run

TILTS = [(0, 0), (0, 0), (20, 0), (-20, 0), (0, 20), (0, -20)]
BEARINGS = np.arange(180) * 2 * np.pi / 180


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Six scans of a reference of 300 mm by a scanner that reads 0.5 % too long and looks 0.3 degrees up."""
    folder = tmp_path_factory.mktemp("reference")
    rng = np.random.default_rng(8)
    with (folder / "tilts.csv").open("w", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(["scan", "pitch_deg", "yaw_deg"])
        for k, (pitch, yaw) in enumerate(TILTS):
            axes = in_pipe(np.radians(0.3), 0.0, 0.0) @ in_pipe(*np.radians([pitch, yaw]), 0.0)
            ray = np.cos(BEARINGS)[:, None] * axes[2] + np.sin(BEARINGS)[:, None] * axes[1]
            true = 0.15 / np.hypot(ray[:, 1], ray[:, 2])
            rings = 1.005 * true + 0.0005 * rng.standard_normal((12, 180))
            write_rings(folder / f"ring-{k}.csv", rings)
            table.writerow([f"ring-{k}", pitch, yaw])
    return folder


def write_rings(path: Path, rings: np.ndarray) -> None:
    with path.open("w", newline="") as stream:
        table = csv.writer(stream)
        table.writerow(["distance_m", *(f"r_{k}_m" for k in range(rings.shape[1]))])
        table.writerows([[f"{0.05 * k:.3f}", *(f"{r:.6f}" for r in ring)] for k, ring in enumerate(rings)])


BEARING = ("--bearing-zero", "right", "--bearing-sense", "ccw")


def test_a_calibration_is_found_written_and_used(folder, tmp_path):
    scans = sorted(folder.glob("ring-*.csv"))
    file = tmp_path / "c.toml"
    code, out, err = run("calibrate", "ring", *scans, "--diameter", "300mm", "--sigma", "0.03mm", "--tilts",
                         folder / "tilts.csv", "--tilt-sigma", 0, "-o", file, *BEARING)  # fmt: skip
    assert (code, err) == (0, "")
    assert "range scale" in out and "boresight pitch" in out and str(file) in out
    values = tomllib.loads(file.read_text())
    assert values["range_scale"] == pytest.approx(1.005, abs=2e-4)
    assert np.degrees(values["boresight_pitch"]) == pytest.approx(0.3, abs=0.05)
    assert len(values["scans"][0]["inputs"][0]["sha256"]) == 64
    plain = summary(run, scans[0], tmp_path / "plain")
    found = summary(run, scans[0], tmp_path / "found", "--calibration", file)
    assert plain["diameter_mean_mm"] == pytest.approx(301.5, abs=0.1)
    assert found["diameter_mean_mm"] == pytest.approx(300.0, abs=0.1)
    assert found["diameter_sigma_mm"] < 0.1 < plain["diameter_sigma_mm"]


def summary(run, scan, output, *more):
    code, out, err = run("inspect", scan, "--nominal", "300mm", "-o", output, "--json", *BEARING, *more)
    assert code == 0, err
    return json.loads(out)


def test_without_tilts_boresight_is_said_to_be_unobservable(folder, tmp_path):
    code, out, err = run("calibrate", "ring", folder / "ring-0.csv", folder / "ring-1.csv", "--diameter", "300mm",
                         "-o", tmp_path / "c.zarr.zip", *BEARING)  # fmt: skip
    assert code == 0
    assert out.count("not observable") == 4
    assert "taken as exact" in err
    code, out, _ = run("calibrate", "ring", folder / "ring-0.csv", "--diameter", "300mm", "-o", tmp_path / "d.toml",
                       "--json", *BEARING)  # fmt: skip
    found = json.loads(out)
    assert "boresight_pitch" not in found and "boresight_pitch" in found["why_missing"]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("scan,pitch_deg\nring-0,1\n", "the column 'yaw_deg' is missing"),
        ("scan,pitch_deg,yaw_deg,rol_deg\n", "unknown column 'rol_deg', did you mean 'roll_deg'"),
        ("scan,pitch_deg,yaw_deg\nring-9,0,0\n", "row 2, column scan: 'ring-9' is none of the scans"),
        ("scan,pitch_deg,yaw_deg\nring-0,x,0\n", "row 2, column pitch_deg: the cell 'x' is not a number"),
        ("scan,pitch_deg,yaw_deg\nring-0,0,0\nring-0,0,0\n", "stands in it twice"),
        ("scan,pitch_deg,yaw_deg\n", "there is no tilt for it"),
    ],
)
def test_a_wrong_table_of_tilts_is_refused_by_row_and_column(table, message, folder, tmp_path):
    (tmp_path / "t.csv").write_text(table)
    code, _, err = run("calibrate", "ring", folder / "ring-0.csv", "--diameter", "300mm", "--tilts", tmp_path / "t.csv",
                       "-o", tmp_path / "c.toml", *BEARING)  # fmt: skip
    assert code == 2 and message in err
    assert not (tmp_path / "c.toml").exists()


def test_an_existing_file_is_kept_and_a_bad_calibration_refused(folder, tmp_path):
    (tmp_path / "c.toml").write_text("range_scale = 1.0\n")
    code, _, err = run(
        "calibrate", "ring", folder / "ring-0.csv", "--diameter", "300mm", "-o", tmp_path / "c.toml", *BEARING
    )
    assert code == 2 and "exists already" in err
    code, _, err = run("inspect", folder / "ring-0.csv", "--nominal", "300mm", "--calibration", tmp_path / "c.toml",
                       "-o", tmp_path / "r", *BEARING)  # fmt: skip
    assert code == 2 and "one-sigma is missing" in err


RESULTS = """laboratory,material,diameter_mm
a,ring,300.1
a,ring,300.2
b,ring,300.0
b,ring,300.1
c,ring,299.9
c,ring,300.1
"""
MEASURES = tuple(word for value in ("300.1mm", "299.9mm", "300.0mm", "300.1mm") for word in ("--reference", value))


def test_a_study_of_results_is_written_as_tables_and_a_page(tmp_path):
    (tmp_path / "results.csv").write_text(RESULTS)
    code, out, err = run("calibrate", "study", tmp_path / "results.csv", *MEASURES, "-o", tmp_path / "study")
    assert (code, err) == (0, "")
    assert "accuracy" in out and "study.html" in out and "the practice asks for 6" in out
    (row,) = csv.DictReader((tmp_path / "study" / "precision.csv").read_text().splitlines())
    assert float(row["mean_mm"]) == pytest.approx(300.0667, abs=1e-3)
    assert float(row["bias_mm"]) == pytest.approx(300.0667 - 300.025, abs=1e-3)
    found = json.loads((tmp_path / "study" / "study.json").read_text())
    # Three pairs leave three degrees of freedom: too few to be sure of 0.12 %.
    assert [one["verdict"] for one in found["verdicts"]] == ["pass", "uncertain"]
    page = (tmp_path / "study" / "study.html").read_text()
    assert page.count("<rect") == 6 and "http" not in page
    again = ("calibrate", "study", tmp_path / "results.csv", "-o")
    code, _, err = run(*again, tmp_path / "study")
    assert code == 2 and "exists already" in err
    assert run(*again, tmp_path / "study", "--force")[0] == 0
    code, _, err = run(*again, tmp_path, "--force")
    assert code == 2 and "other files than those of a precision study" in err
    assert (tmp_path / "results.csv").read_text() == RESULTS


def test_a_study_reads_scans_and_fails_a_check_that_is_asked_for(folder, tmp_path):
    rows = ["laboratory,scan"]
    for k in range(4):
        # The same reference, inspected again and again by a scanner that reads 0.5 % too long.
        (tmp_path / f"s{k}.csv").write_text((folder / f"ring-{k % 2}.csv").read_text())
        rows.append(f"one,s{k}.csv")
    (tmp_path / "scans.csv").write_text("\n".join(rows) + "\n")
    measures = [word for value in ("299.4mm", "299.5mm", "299.5mm", "299.6mm") for word in ("--reference", value)]
    code, out, _ = run("calibrate", "study", tmp_path / "scans.csv", *measures, "-o", tmp_path / "study", "--check",
                       *BEARING)  # fmt: skip
    assert code == 3 and "fail" in out and "One laboratory alone" in out
    code, out, _ = run("calibrate", "study", tmp_path / "scans.csv", "-o", tmp_path / "bare", *BEARING, "--unit", "m")
    assert code == 0 and "not_assessed" in out


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("laboratory,material\na,m\n", "the columns with a result are missing"),
        ("laboratory,diameter_mm,scan\na,1,x\n", "contradict one another"),
        ("material,diameter_mm\nm,300\n", "the column 'laboratory' is missing"),
        ("laboratory,materiel,diameter_mm\na,m,300\n", "did you mean 'material'"),
        ("laboratory,diameter_mm\na,x\n", "row 2, column diameter_mm: the cell 'x' is not a number"),
        ("laboratory,diameter_mm\na,-3\n", "row 2, column diameter_mm: -3 is not a diameter"),
        ("laboratory,diameter_mm\n,300\n", "row 2, column laboratory: the cell is empty"),
        ("laboratory,diameter_mm\n", "there is no row in it"),
    ],
)
def test_a_wrong_table_of_results_is_refused(table, message, tmp_path):
    (tmp_path / "t.csv").write_text(table)
    code, _, err = run("calibrate", "study", tmp_path / "t.csv", "-o", tmp_path / "study")
    assert code == 2 and message in err


def test_references_stand_in_a_table_of_their_own(tmp_path):
    (tmp_path / "results.csv").write_text(RESULTS)
    (tmp_path / "r.csv").write_text("material,diameter_in\n" + "ring,11.811\n" * 4)
    code, out, _ = run("calibrate", "study", tmp_path / "results.csv", "--references", tmp_path / "r.csv", "-o",
                       tmp_path / "study", "--json")  # fmt: skip
    assert code == 0
    assert json.loads(out)["materials"][0]["reference_mm"] == pytest.approx(299.9994)
