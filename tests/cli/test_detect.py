"""`springline detect` on drawn frames: its table, its pictures, its refusals."""

import csv
import json

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from springline.cli.detect import app
from springline.errors import InputError, OutputError
from springline.imaging.frames import read_frame

COLUMNS = ["image", "kind", "cx_px", "cy_px", "semi_major_px", "semi_minor_px", "angle_deg", "confidence"]


def _ring(radius):
    rows, columns = np.mgrid[:240, :320].astype(float)
    away = np.hypot(columns - 160, rows - 120)
    light = 20 + 150 * (1 - np.exp(-((away / 90) ** 2))) + 80 * np.exp(-0.5 * ((away - radius) / 1.5) ** 2)
    return np.repeat(np.clip(light, 0, 255).astype(np.uint8)[..., None], 3, axis=2)


@pytest.fixture
def frames(tmp_path):
    folder = tmp_path / "frames"
    folder.mkdir()
    for radius in (50, 80):
        cv2.imwrite(str(folder / f"ring{radius}.png"), _ring(radius))
    return folder


def _run(*arguments):
    return CliRunner().invoke(app, [str(a) for a in arguments])


def test_table_and_pictures_are_written(frames, tmp_path):
    done = _run(frames, "-o", tmp_path / "out")
    assert done.exit_code == 0, done.output
    with (tmp_path / "out" / "detections.csv").open() as table:
        rows = list(csv.DictReader(table))
    assert list(rows[0]) == COLUMNS
    assert [(row["image"], row["kind"]) for row in rows] == [("ring50.png", "joint"), ("ring80.png", "joint")]
    assert abs(float(rows[1]["semi_major_px"]) - 80.0) < 3.5
    picture = read_frame(tmp_path / "out" / "ring80.png.png")
    assert picture.shape == (240, 320, 3) and not np.array_equal(picture, _ring(80))
    assert "2 joints" in done.output


def test_damaged_frames_are_named_skipped_and_counted(frames, tmp_path):
    (frames / "cut.jpg").write_bytes(cv2.imencode(".jpg", _ring(60))[1].tobytes()[:900])
    (frames / "small.png").write_bytes(cv2.imencode(".png", _ring(60)[:20])[1].tobytes())
    done = _run(frames, "-o", tmp_path / "out", "--json")
    assert done.exit_code == 0
    told = json.loads(done.stdout)
    assert (told["frames"], told["skipped"], told["joints"]) == (2, 2, 2)
    assert "cut.jpg" in told["warnings"][0] and "small.png" in told["warnings"][1]


def test_nothing_is_written_when_no_frame_can_be_read(tmp_path):
    (tmp_path / "broken.png").write_bytes(b"nothing")
    done = _run(tmp_path / "broken.png", "-o", tmp_path / "out")
    assert isinstance(done.exception, InputError) and "none of the 1 images" in str(done.exception)
    assert not (tmp_path / "out").exists()


def test_an_existing_folder_is_kept_unless_forced_and_ours(frames, tmp_path):
    out = tmp_path / "out"
    assert _run(frames, "-o", out).exit_code == 0
    assert isinstance(_run(frames, "-o", out).exception, OutputError)
    assert _run(frames, "-o", out, "--force").exit_code == 0
    other = tmp_path / "other"
    other.mkdir()
    (other / "keep.txt").write_text("mine")
    assert isinstance(_run(frames, "-o", other, "--force").exception, OutputError)
    assert (other / "keep.txt").read_text() == "mine"


def test_frames_of_several_folders_with_one_name_are_told_apart(frames, tmp_path):
    second = tmp_path / "second"
    second.mkdir()
    cv2.imwrite(str(second / "ring80.png"), _ring(80))
    assert _run(frames, second, "-o", tmp_path / "out").exit_code == 0
    with (tmp_path / "out" / "detections.csv").open() as table:
        names = [row["image"] for row in csv.DictReader(table)]
    assert len(set(names)) == 3
    assert len(list((tmp_path / "out").glob("*.png"))) == 3
