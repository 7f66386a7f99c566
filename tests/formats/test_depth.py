"""Depth images: the pinhole by hand, and real captures against the clouds that their makers saved."""

from __future__ import annotations

import numpy as np
import pytest

import springline as sl
from springline.errors import FormatError, InputError

Image = pytest.importorskip("PIL.Image")
SMALL = (421.139, 421.139, 426.176, 237.017)


def save(path, counts: np.ndarray) -> None:
    Image.fromarray(counts).save(path)


def test_pinhole_by_hand(tmp_path):
    counts = np.zeros((4, 6), np.uint16)
    counts[0, 5] = 500  # above and to the right of the axis
    counts[3, 1] = 250
    save(tmp_path / "a.png", counts)
    survey = sl.read(tmp_path / "a.png", intrinsics=(2.0, 4.0, 3.0, 2.0), depth_unit="mm")
    points = survey.points
    np.testing.assert_allclose(points["x"], [0.5, 0.25])
    np.testing.assert_allclose(points["y"], [2 * 0.5 / 4, -1 * 0.25 / 4])
    np.testing.assert_allclose(points["z"], [2 * 0.5 / 2, -2 * 0.25 / 2])
    assert points.attrs["sensor_kind"] == "depth-camera"
    assert points.attrs["origin_is_sensor"] == 1
    assert survey.assumptions == []
    assert "millimetres" in sl.read(tmp_path / "a.png", intrinsics=(2.0, 4.0, 3.0, 2.0)).assumptions[0]


@pytest.mark.shared
def test_captures_equal_the_clouds_saved_from_them(depth_captures):
    clouds = sorted((depth_captures / "ply").glob("*.ply"))
    assert len(clouds) == 3
    for cloud in clouds:
        *place, stem = cloud.stem.split("__")
        image = depth_captures.joinpath("depth16", *place, f"{stem}.png")
        nominal = float(place[1][:3]) / 1000
        from_cloud = sl.read(cloud, nominal_diameter=nominal).points
        from_image = sl.read(image, intrinsics=SMALL, nominal_diameter=nominal).points
        for axis in "xyz":
            # The clouds passed through float32: 6e-8 of the depth, which in a few wild pixels is 65 m.
            off = np.abs(from_cloud[axis].values - from_image[axis].values)
            assert (off <= 1e-6 * np.maximum(1.0, from_image["x"].values)).all()


@pytest.mark.shared
def test_every_capture_passes_the_check_against_its_nominal_diameter(depth_captures):
    images = sorted(depth_captures.glob("depth16/**/*.png"))
    assert len(images) == 26
    for image in images:
        large = "1280x720" in image.parts
        intrinsics = (635.682, 635.682, 643.285, 355.427) if large else SMALL
        nominal = float(next(p for p in image.parts if "mm_" in p)[:3]) / 1000
        survey = sl.read(image, intrinsics=intrinsics, nominal_diameter=nominal)
        assert survey.points.sizes["point"] > 10_000
        with pytest.raises(InputError, match="far from the nominal"):
            sl.read(image, intrinsics=intrinsics, nominal_diameter=nominal / 10)


@pytest.mark.parametrize(
    ("counts", "options", "message"),
    [
        (np.ones((4, 6), np.uint16), {}, "--intrinsics fx,fy,cx,cy"),
        (np.ones((4, 6), np.uint16), {"intrinsics": (2, 2, 300, 200)}, "outside the image of 6 x 4"),
        (np.ones((4, 6), np.uint8), {"intrinsics": (2, 2, 3, 2)}, "not 16 bits"),
        (np.zeros((4, 6), np.uint16), {"intrinsics": (2, 2, 3, 2)}, "no point has coordinates"),
        (np.ones((4, 6), np.uint16), {"intrinsics": (0, 2, 3, 2)}, "positive focal lengths"),
        (np.ones((4, 6), np.uint16), {"intrinsics": (2, 2, 3)}, "fx,fy,cx,cy"),
    ],
)
def test_what_is_refused(counts, options, message, tmp_path):
    save(tmp_path / "a.png", counts)
    with pytest.raises(InputError, match=message):
        sl.read(tmp_path / "a.png", **options)


def test_an_image_in_name_only(tmp_path):
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(50))
    with pytest.raises(FormatError):
        sl.read(tmp_path / "a.png", intrinsics=(2, 2, 3, 2))
