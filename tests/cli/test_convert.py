"""`springline convert`: what it writes and tells; bad input gives exit code 2, one message, nothing half-written."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import springline as sl

from .command_line import run

WIDE = "distance_m,r_0_mm,r_1_mm,r_2_mm,r_3_mm\n0,150,151,152,153\n1,150,151,152,153\n"


@pytest.fixture
def table(tmp_path) -> Path:
    path = tmp_path / "in" / "run.csv"
    path.parent.mkdir()
    path.write_text(WIDE)
    return path


def test_convert_and_what_it_tells(table, tmp_path):
    code, out, err = run("convert", table, tmp_path / "a.zarr.zip", "--bearing-zero", "crown", "--bearing-sense", "cw",
                         "--nominal", "12in", "--name", "MH 1", "--sensor", "ring-laser")  # fmt: skip
    assert (code, err) == (0, "")
    assert "a.zarr.zip" in out
    survey = sl.read(tmp_path / "a.zarr.zip")
    np.testing.assert_allclose(survey.rings["range"][0], [0.151, 0.150, 0.153, 0.152], atol=1e-5)
    assert survey.attrs["name"] == "MH 1"
    assert survey.attrs["nominal_diameter"] == pytest.approx(0.3048)
    assert survey.rings.attrs["sensor_kind"] == "ring-laser"
    code, _, err = run("convert", table, tmp_path / "b.ply")
    assert code == 0
    assert "assumed: run.csv: where the device's zero lies" in err
    assert "which ring a point belongs to" in err


def test_json(table, tmp_path):
    code, out, err = run("convert", table, tmp_path / "a", "--json")
    record = json.loads(out)
    assert (code, err, record["format"]) == (0, "", "folder")
    assert record["groups"] == {"rings": {"ring": 2, "bearing": 4}}
    assert len(record["assumptions"]) == 1
    assert sorted(p.name for p in (tmp_path / "a").iterdir()) == ["rings.csv", "survey.toml"]


def test_axes_may_begin_with_a_minus(tmp_path):
    np.save(tmp_path / "a.npy", np.random.default_rng(0).normal(0, 0.1, (50, 3)))
    assert run("convert", tmp_path / "a.npy", tmp_path / "a.ply", "--axes", "-z,y,x", "--unit", "m")[0] == 0


def test_to_overrules_the_extension(table, tmp_path):
    assert run("convert", table, tmp_path / "odd.name", "--to", "csv")[0] == 0
    assert (tmp_path / "odd.name").read_text().startswith("distance_m,r_0,r_1")


def test_an_output_that_exists(table, tmp_path):
    (tmp_path / "a.csv").write_text("mine")
    code, _, err = run("convert", table, tmp_path / "a.csv")
    assert (code, (tmp_path / "a.csv").read_text()) == (2, "mine")
    assert "--force" in err
    assert run("convert", table, tmp_path / "a.csv", "--force")[0] == 0
    assert (tmp_path / "a.csv").read_text() != "mine"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "in"]


def bad_inputs(folder: Path) -> dict[str, tuple[Path, tuple[str, ...]]]:
    """Return what the issue of bad input lists, each with options."""
    good = folder / "good.csv"
    good.write_text(WIDE)
    survey = sl.read(good)
    made = {}
    for name in ("a.ply", "a.laz", "a.zarr.zip"):
        sl.write(survey, folder / name)
        data = (folder / name).read_bytes()
        (folder / f"cut-{name}").write_bytes(data[: len(data) * 2 // 3])
        made[f"truncated {name}"] = (folder / f"cut-{name}", ())
    sl.write(survey, folder / "cut.zarr")
    (folder / "cut.zarr/rings/range/c/0/0").unlink()
    made["zarr without a chunk"] = (folder / "cut.zarr", ())
    texts = {
        "empty": "",
        "NaN only": WIDE.split("\n")[0] + "\n0,NaN,NaN,,\n",
        "duplicate distance": WIDE.replace("\n1,", "\n0,"),
        "decreasing distance": WIDE.replace("\n1,", "\n-1,"),
        "non-numeric cell": WIDE.replace("152,153\n1", "l52,153\n1"),
        "no unit": WIDE.replace("_mm", ""),
        "neither table nor cloud": "a,b\n1,2\n",
    }
    for name, text in texts.items():
        made[name] = (folder / f"{name}.csv", ())
        made[name][0].write_text(text)
    made["missing"] = (folder / "nowhere.ply", ())
    made["ten times off"] = (good, ("--nominal", "3m"))
    made["a tenth"] = (good, ("--nominal", "30mm"))
    made["nominal without unit"] = (good, ("--nominal", "300"))
    made["bearing"] = (good, ("--bearing-zero", "top"))
    made["intrinsics"] = (good, ("--intrinsics", "1,2,3"))
    made["format"] = (good, ("--format", "docx"))
    made["to"] = (good, ("--to", "docx"))
    made["meaningless option"] = (good, ("--axes", "x,y,z"))
    made["directory"] = (folder, ())
    return made


def test_bad_input_is_exit_code_2_with_one_message_and_nothing_written(tmp_path):
    sources, target = tmp_path / "in", tmp_path / "out"
    sources.mkdir()
    target.mkdir()
    for name, (path, options) in bad_inputs(sources).items():
        code, out, err = run("convert", path, target / "a.parquet", *options)
        assert (code, out) == (2, ""), name
        assert err.startswith("springline: "), name
        assert err.count("\n") == 1, name
        assert "Traceback" not in err, name
        assert (options and options[0] in err) or path.name in err, f"{name}: {err}"
        assert list(target.iterdir()) == [], name


def test_the_cell_is_named(tmp_path):
    (tmp_path / "a.csv").write_text(WIDE.replace("152,153\n1", "l52,153\n1"))
    _, _, err = run("convert", tmp_path / "a.csv", tmp_path / "b.zarr")
    assert err == (
        f"springline: {tmp_path / 'a.csv'}, row 2, column r_2_mm: the cell 'l52' is not a number; "
        "expected a number, or an empty cell for no return\n"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="limits of file size are POSIX")
@pytest.mark.parametrize("name", ["a.csv", "a.parquet", "a.zarr", "a.zarr.zip", "a.ply", "a.laz", "a.las", "a"])
def test_a_full_disk(name, tmp_path):
    """A limit on file size fails writes half-way, as a full disk does."""
    ranges = np.random.default_rng(0).uniform(0.1, 0.2, (400, 90))
    np.savez(tmp_path / "in.npz", distance_m=np.arange(400.0), range_m=ranges)
    (tmp_path / "out").mkdir()
    code = (
        "import resource, sys; from springline.cli import main; "
        "resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000)); "
        f"sys.argv = ['springline', 'convert', {str(tmp_path / 'in.npz')!r}, {str(tmp_path / 'out' / name)!r}]; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
    )
    assert done.returncode == 2, done.stderr
    last = done.stderr.strip().splitlines()[-1]
    assert "cannot be written" in last
    assert "Traceback" not in done.stderr
    assert list((tmp_path / "out").iterdir()) == []


def test_as_a_module(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "springline", "convert", str(tmp_path / "a.ply"), str(tmp_path / "b.ply")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"springline: {tmp_path / 'a.ply'}: no such file. Check the path\n"


def test_help_has_examples():
    code, out, _ = run("convert", "--help")
    assert code == 0
    assert "springline convert scan.laz" in out
