"""`springline simulate` as a user meets it."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from springline.io import read, write
from springline.simulate import Footage, scenarios
from springline.survey import open_survey

from . import command_line

SCENARIO = """name = "mine"
[pipe]
diameter = "200mm"
run = [{ kind = "straight", length = 1.0 }]
[robot]
length = 0.2
wheelbase = 0.15
[rings]
spacing = 0.05
bearings = 36
[ties]
chainages = [0.0, 1.0]
"""


run = partial(command_line.run, "simulate")


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(SCENARIO, encoding="utf-8")
    return path


def test_list_names_every_ready_scenario():
    code, out, _ = run("--list")
    assert code == 0
    assert [line.split()[0] for line in out.splitlines()] == list(scenarios())


def test_a_zarr_holds_everything_and_the_seed_matters(mine, tmp_path):
    for seed, name in ((1, "a.zarr.zip"), (1, "b.zarr"), (2, "c.zarr.zip")):
        assert run(mine, "-o", tmp_path / name, "--seed", seed)[0] == 0
    a, b, c = (open_survey(tmp_path / name) for name in ("a.zarr.zip", "b.zarr", "c.zarr.zip"))
    assert a.groups == ("rings", "ties", "truth")
    assert a.rings["range"].equals(b.rings["range"])
    assert not a.rings["range"].equals(c.rings["range"])


def test_a_survey_folder_is_written_and_read_back(mine, tmp_path):
    code, _, err = run(mine, "-o", tmp_path / "folder", "--seed", 1)
    assert code == 0
    assert "/truth" in err  # what the folder does not hold is said
    survey = read(tmp_path / "folder")
    assert survey.attrs["name"] == "mine"
    assert survey.rings.sizes["bearing"] == 36
    assert survey.ties.sizes["tie"] == 2


CAMERA = """[camera]
spacing = 0.3
width = 64
height = 48
format = "png"
lens = { model = "sine", field_of_view_deg = 100.0 }
"""


@pytest.mark.parametrize(("output", "folder"), [("a.zarr.zip", "a-frames"), ("b.zarr", "b-frames"), ("c", "c/frames")])
def test_frames_lie_beside_the_survey_and_are_found_from_it(mine, tmp_path, output, folder):
    Image = pytest.importorskip("PIL.Image")
    mine.write_text(SCENARIO + CAMERA, encoding="utf-8")
    assert run(mine, "-o", tmp_path / output, "--seed", 2)[0] == 0
    survey = read(tmp_path / output)
    names = survey.frames["path"].values
    assert sorted(p.name for p in (tmp_path / folder).iterdir()) == [Path(name).name for name in names]
    footage = Footage(mine, 2)
    for k, name in enumerate(names):
        with Image.open(Path(survey.frames.attrs["folder"]) / name) as picture:
            assert np.array_equal(np.asarray(picture), footage.image(k))
    lens = json.loads(survey.calibration.attrs["lens"])["camera"]
    assert lens["model"] == "sine"
    assert lens["k_px"] == pytest.approx(32.0 / np.sin(np.radians(50.0)))
    write(survey, tmp_path / "elsewhere" / "copy")  # its list still leads to the pictures, which stay where they are
    copied = read(tmp_path / "elsewhere" / "copy").frames
    assert all(Path(copied.attrs["folder"], name).is_file() for name in copied["path"].values)
    assert "exists already" in run(mine, "-o", tmp_path / output)[2]
    assert run(mine, "-o", tmp_path / output, "--force")[0] == 0
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


def test_faults_are_one_message_and_exit_code_2(mine, tmp_path):
    assert run()[0] == 2
    assert "-o" in run(mine)[2]
    (tmp_path / "there.zarr").mkdir()
    assert "--force" in run(mine, "-o", tmp_path / "there.zarr")[2]
    mine.write_text(SCENARIO.replace("spacing", "spacin"), encoding="utf-8")
    code, _, err = run(mine, "-o", tmp_path / "x.zarr")
    assert code == 2
    assert "mine.toml, line 9: unknown key 'rings.spacin'" in err
    assert "did you mean 'spacing'?" in err
    assert not (tmp_path / "x.zarr").exists()
    mine.write_text(SCENARIO + CAMERA, encoding="utf-8")
    assert run(mine, "-o", tmp_path / "x.zarr", "--seed", 10**30)[0] == 2
    assert "Traceback" not in run(mine, "-o", mine / "x.zarr")[2]


@pytest.mark.parametrize("interrupted", [True, False])
def test_an_interrupt_within_a_kernel_is_an_interrupt(mine, tmp_path, monkeypatch, interrupted):
    def stop(*words, **options):
        raise SystemError("a result with an exception set") from (KeyboardInterrupt() if interrupted else KeyError())

    monkeypatch.setattr("springline.simulate.simulate_to", stop)
    if not interrupted:
        with pytest.raises(SystemError):
            run(mine, "-o", tmp_path / "x.zarr")
        return
    code, _, err = run(mine, "-o", tmp_path / "x.zarr")
    assert (code, "stopped" in err, "Traceback" in err) == (130, True, False)


def test_a_request_to_end_leaves_nothing_behind(tmp_path):
    long = tmp_path / "long.toml"
    long.write_text(SCENARIO.replace("length = 1.0", "length = 400.0"), encoding="utf-8")
    out = tmp_path / "out"
    out.mkdir()
    words = [sys.executable, "-m", "springline", "simulate", str(long), "-o", str(out / "x.zarr")]
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not list(out.glob(".*/*/*")):
        time.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, "Traceback" in err) == (130, False)
    assert list(out.iterdir()) == []
