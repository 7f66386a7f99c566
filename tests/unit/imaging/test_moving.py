"""Frames in order from files and from videos, and what is said of those that cannot be read."""

import numpy as np
import pytest

from springline.errors import InputError

cv2 = pytest.importorskip("cv2", reason="needs the extra 'vision'")
av = pytest.importorskip("av", reason="needs the extra 'video'")

from springline.imaging.moving import each_frame  # noqa: E402

LEVELS = [30, 90, 150, 210]


@pytest.fixture
def folder(tmp_path):
    """A folder with a video of four grey frames, each of its own level, and one picture."""
    with av.open(str(tmp_path / "ring.mp4"), "w") as file:
        stream = file.add_stream("mpeg4", rate=25)
        stream.width, stream.height, stream.pix_fmt = 128, 96, "yuv420p"
        for level in LEVELS:
            frame = av.VideoFrame.from_ndarray(np.full((96, 128, 3), level, np.uint8), format="bgr24")
            file.mux(stream.encode(frame))
        file.mux(stream.encode())
    cv2.imwrite(str(tmp_path / "one.png"), np.full((96, 128, 3), 60, np.uint8))
    return tmp_path


def levels(names, folder):
    return [
        str(picture) if isinstance(picture, InputError) else round(float(picture.mean()) / 10) * 10
        for _, picture in each_frame(names, folder)
    ]


def test_frames_of_a_video_come_by_their_number_and_mix_with_pictures(folder):
    names = ["ring.mp4#0", "ring.mp4#2", "one.png", "ring.mp4#3", "ring.mp4#1"]
    assert levels(names, folder) == [30, 150, 60, 210, 90]


def test_what_cannot_be_read_is_named_and_the_rest_is_read(folder):
    (folder / "cut.mp4").write_bytes((folder / "ring.mp4").read_bytes()[:300])
    (folder / "no.avi").write_bytes(b"not a video")
    names = ["ring.mp4#9", "cut.mp4#0", "no.avi#0", "ring.mp4", "ring.mp4#x", "none.png", "ring.mp4#1"]
    *refusals, last = levels(names, folder)
    assert last == 90
    for said, expected in zip(
        refusals,
        ["has only 4 frames", "cannot be read", "cannot be read", "not a frame", "no frame's number", "cannot be read"],
        strict=True,
    ):
        assert expected in said
