"""Frames on the wall in what people open: mesh, report and viewer; each place must show the colour painted there."""

from io import BytesIO

import numpy as np
import pytest
import trimesh
import xarray as xr
from PIL import Image

from springline.conventions import bearing_from_clock
from springline.outputs.mesh import write_glb
from springline.outputs.photo import UNSEEN, photo_of
from springline.outputs.png import rgb_png
from springline.outputs.report.model import make_report
from springline.outputs.results import Results
from springline.outputs.unroll import unroll
from springline.outputs.viewer.brightness import brightness_of

from .finished import finished_survey

CELL = 0.01
DARK = slice(500, 600)


def painted(chainage, bearing):
    red = 60 + 5 * np.asarray(chainage)
    green = 120 + 80 * np.cos(bearing)
    blue = 120 + 80 * np.sin(bearing)
    return np.stack(np.broadcast_arrays(red, green, blue), axis=-1)


@pytest.fixture(scope="module")
def survey():
    """The finished pipe of 30 m, photographed from 1 m to 29 m, with the stretch from 6 to 7 m in the dark."""
    x = 1.0 + CELL * (np.arange(2800) + 0.5)
    bearing = 2 * np.pi * np.arange(96) / 96
    seen = np.ones((2800, 96), np.uint8)
    seen[DARK] = 0
    colour = np.rint(painted(x[:, None], bearing)).astype(np.uint8) * seen[..., None]
    group = xr.Dataset(
        {
            "chainage": ("row", x),
            "bearing": ("column", bearing),
            "colour": (("row", "column", "channel"), colour),
            "seen": (("row", "column"), seen),
        },
        attrs={"cell": CELL, "frames": 70},
    )
    return finished_survey(stations=600, bearings=120).with_group("texture", group)


@pytest.fixture(scope="module")
def wall(survey):
    return unroll(Results(survey))


@pytest.mark.parametrize("shape", [(1, 1), (7, 5), (40, 3)])
def test_a_picture_comes_back_as_it_was(shape):
    pixels = np.random.default_rng(2).integers(0, 256, (*shape, 3), dtype=np.uint8)
    np.testing.assert_array_equal(np.array(Image.open(BytesIO(rgb_png(pixels)))), pixels)


def test_the_mesh_carries_the_picture(wall, tmp_path, monkeypatch):
    # several pictures along the pipe, as a long one has
    monkeypatch.setattr("springline.outputs.mesh._PICTURE", 800)
    write_glb(wall, tmp_path / "pipe.glb", name="pipe")
    scene = trimesh.load(tmp_path / "pipe.glb", process=False)
    meshes = list(scene.geometry.values())
    assert len(meshes) == 4
    for mesh in meshes:
        picture = np.array(mesh.visual.material.baseColorTexture).astype(float)
        height, width = picture.shape[:2]
        # trimesh counts upwards; a pixel's middle is half a pixel in
        column = np.clip((mesh.visual.uv[:, 0] * width).astype(int), 0, width - 1)
        row = np.rint((1 - mesh.visual.uv[:, 1]) * height - 0.5).astype(int) % height
        shown = picture[row, column]
        x, y, z = mesh.vertices.T
        truth = painted(x, np.arctan2(y, z))
        lit = (x > 1.02) & (x < 28.98) & ~((x > 5.98) & (x < 7.02))
        np.testing.assert_allclose(shown[lit], truth[lit], atol=6.0)
        dark = (x > 6.02) & (x < 6.98)
        assert (shown[dark] == UNSEEN).all()
        # no triangle runs backwards round the wall at the seam
        around = mesh.visual.uv[mesh.faces][:, :, 1]
        assert (np.ptp(around, axis=1) < 0.1).all()
    assert sum(len(mesh.faces) for mesh in meshes) > 60_000


def test_a_long_pipe_keeps_its_file_small(wall, tmp_path, monkeypatch):
    monkeypatch.setattr("springline.outputs.mesh._PIXELS", 30_000)
    write_glb(wall, tmp_path / "pipe.glb", name="pipe", vertices=5000)
    (mesh,) = trimesh.load(tmp_path / "pipe.glb", process=False).geometry.values()
    picture = mesh.visual.material.baseColorTexture
    assert picture.size[0] * picture.size[1] < 35_000
    x, y, z = mesh.vertices.T
    place = np.clip((mesh.visual.uv * [picture.size[0], 0]).astype(int)[:, 0], 0, picture.size[0] - 1)
    row = np.rint((1 - mesh.visual.uv[:, 1]) * picture.size[1] - 0.5).astype(int) % picture.size[1]
    lit = (x > 1.2) & (x < 5.8)
    np.testing.assert_allclose(np.array(picture)[row, place][lit], painted(x, np.arctan2(y, z))[lit], atol=12.0)


def test_the_report_shows_it_on_its_axis(survey):
    report = make_report(Results(survey), unroll(Results(survey)), "")
    (chart,) = [one for one in report.maps if one.key == "photo"]
    pixels = np.array(Image.open(BytesIO(chart.picture))).astype(float)
    low, high = report.axis.low, report.axis.high
    for chainage, clock in ((3.0, 12.0), (12.5, 3.0), (20.0, 9.0), (27.2, 4.5)):
        column = int((chainage - low) / (high - low) * pixels.shape[1])
        row = int(((6.0 - clock) % 12.0) / 12.0 * pixels.shape[0])
        np.testing.assert_allclose(pixels[row, column], painted(chainage, bearing_from_clock(clock)), atol=8.0)
    column = int((6.5 - low) / (high - low) * pixels.shape[1])
    assert (pixels[:, column] == UNSEEN).all() and chart.legend


def test_without_frames_nothing_changes():
    plain = finished_survey(stations=60, bearings=36)
    wall = unroll(Results(plain))
    assert photo_of(plain) is None and wall.photo is None
    assert "photo" not in [one.key for one in make_report(Results(plain), wall, "").maps]


def test_the_viewer_shades_the_wall_by_its_photograph(wall):
    shown = brightness_of(wall)
    assert shown.name == "Photograph" and shown.cells.shape == wall.shape.shape
    middle = (wall.start + wall.end) / 2
    truth = painted(middle[:, None], wall.bearing) @ [0.299, 0.587, 0.114]
    lit = (middle > 1.1) & (middle < 28.9) & ~((middle > 5.9) & (middle < 7.1))
    assert (shown.cells[(middle > 6.1) & (middle < 6.9)] == 0).all()
    assert np.corrcoef(shown.cells[lit].ravel(), truth[lit].ravel())[0, 1] > 0.995
    luma = np.array(shown.shades) @ [0.299, 0.587, 0.114]
    assert (np.diff(luma) > 0).all() and len(shown.shades) == 40
