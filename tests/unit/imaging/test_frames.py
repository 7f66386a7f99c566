"""Frames as files: what is found, what is refused and why."""

import cv2
import numpy as np
import pytest

from springline.errors import InputError
from springline.imaging.frames import checked_frame, find_frames, read_frame, write_picture

PICTURE = np.random.default_rng(0).integers(0, 255, (80, 100, 3), dtype=np.uint8)


def test_folders_patterns_and_files_are_found_once_in_order(tmp_path):
    for name in ("b.png", "a.JPG", "notes.txt"):
        (tmp_path / name).write_bytes(b"x")
    assert [p.name for p in find_frames([tmp_path, tmp_path / "b.png", str(tmp_path / "*.png")])] == ["a.JPG", "b.png"]
    assert [p.name for p in find_frames([tmp_path / "notes.txt"])] == ["notes.txt"]


@pytest.mark.parametrize("source", ["missing.png", "nothing*.png", "."])
def test_a_source_without_images_is_refused(tmp_path, source):
    with pytest.raises(InputError, match="no image found"):
        find_frames([tmp_path / source])


@pytest.mark.parametrize("ending", [".png", ".jpg"])
def test_pictures_cut_short_are_refused_instead_of_filled_with_grey(tmp_path, ending):
    whole = cv2.imencode(ending, PICTURE)[1].tobytes()
    path = tmp_path / f"frame{ending}"
    path.write_bytes(whole)
    assert read_frame(path).shape == (80, 100, 3)
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(InputError, match="cut short"):
        read_frame(path)


@pytest.mark.parametrize(("content", "why"), [(b"", "empty"), (b"no picture at all", "no image")])
def test_files_that_are_no_pictures_are_refused(tmp_path, content, why):
    path = tmp_path / "frame.png"
    path.write_bytes(content)
    with pytest.raises(InputError, match=why):
        read_frame(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_frame(tmp_path / "other.png")


def test_pictures_come_back_as_written(tmp_path):
    write_picture(tmp_path / "frame.png", PICTURE)
    assert np.array_equal(read_frame(tmp_path / "frame.png"), PICTURE)


@pytest.mark.parametrize(
    "image", [np.zeros((80, 40), np.uint8), np.zeros((80, 80, 4), np.uint8), np.zeros((80, 80)), np.zeros(80, np.uint8)]
)
def test_wrong_sizes_and_types_are_refused(image):
    with pytest.raises(InputError):
        checked_frame(image)


def test_grey_frames_are_tripled():
    assert checked_frame(np.full((70, 90), 7, np.uint8)).shape == (70, 90, 3)
