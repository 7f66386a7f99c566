"""Frames of a laser ring become rings, or are named."""

import json

import numpy as np
import pytest
import xarray as xr

from springline.config import Config
from springline.errors import InputError
from springline.survey import Survey

cv2 = pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.stages.ring_video import ring_video  # noqa: E402

SIZE, K, AHEAD, RADIUS = (320, 240), 210.0, 0.3, 0.15
LENS = {
    "model": "perspective", "k_px": K, "width_px": SIZE[0], "height_px": SIZE[1], "laser_ahead_m": AHEAD,
    "position_m": [0.1, 0.0, 0.0],
}  # fmt: skip


@pytest.fixture
def survey(tmp_path):
    """Three frames of a ring, one that is black, one that is cut short, one without a distance."""
    for name in ("a", "b", "c", "d"):
        picture = np.full((SIZE[1], SIZE[0], 3), 10, np.uint8)
        middle = (round(16 * 0.5 * (SIZE[0] - 1)), round(16 * 0.5 * (SIZE[1] - 1)))
        cv2.circle(picture, middle, round(16 * K * RADIUS / AHEAD), (20, 20, 200), 3, cv2.LINE_AA, 4)
        cv2.imwrite(str(tmp_path / f"{name}.png"), picture)
    cv2.imwrite(str(tmp_path / "black.png"), np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
    (tmp_path / "cut.png").write_bytes((tmp_path / "a.png").read_bytes()[:200])
    frames = xr.Dataset(
        {
            "path": ("frame", ["a.png", "b.png", "black.png", "cut.png", "c.png", "d.png"]),
            "distance": ("frame", [0.0, 0.05, 0.1, 0.15, 0.2, np.nan]),
            "lens": ("frame", ["laser"] * 6),
        },
        attrs={"folder": str(tmp_path)},
    )
    calibration = xr.Dataset(attrs={"lens": json.dumps({"laser": LENS, "view": {"model": "sine"}})})
    return Survey({"frames": frames, "calibration": calibration}, {"name": "ring video"})


def test_frames_become_rings_and_the_others_are_named(survey):
    found = ring_video(survey, Config())
    assert found.rings["distance"].values.tolist() == [0.0, 0.05, 0.1, 0.2]
    ranges = found.rings["range"].values
    assert np.isnan(ranges[2]).all()
    assert np.nanmean(ranges[[0, 1, 3]]) == pytest.approx(RADIUS, rel=2e-3)
    assert found.rings.attrs["position_x"] == pytest.approx(0.1 + AHEAD)
    (warning,) = found.warnings
    assert warning.startswith("3 of 6 frames gave no ring")
    for said in ("d.png (it has no distance)", "cut.png (the image is cut short)", "black.png (no ring"):
        assert said in warning


def test_rings_and_frames_without_a_laser_pass_through(survey):
    with_rings = ring_video(survey, Config())
    assert ring_video(with_rings, Config()) is with_rings
    plain = survey.corrected("calibration", xr.Dataset(attrs={"lens": json.dumps({"view": {"model": "sine"}})}))
    assert ring_video(plain, Config()) is plain


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"k_px": -1}, "lens.laser.k_px: -1 cannot be used"),
        ({"kpx": 1}, "lens.laser.kpx: unknown key, did you mean 'k_px'"),
        ({"model": "sin"}, "'sin' is no lens model, did you mean 'sine'"),
        ({"width_px": 640}, "no frame shows a laser ring"),
    ],
)
def test_a_wrong_lens_table_is_refused_by_key(survey, change, said):
    calibration = xr.Dataset(attrs={"lens": json.dumps({"laser": LENS | change})})
    with pytest.raises(InputError, match=said):
        ring_video(survey.corrected("calibration", calibration), Config())
