"""Laser rings in pictures drawn here point by point, against the pipe they were drawn from."""

import numpy as np
import pytest

from springline.errors import InputError, ParameterError
from springline.geometry.lenses import Lens

pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.imaging.lens_table import MountedCamera
from springline.imaging.ring_video import RingReader

WIDTH, HEIGHT, AHEAD, RADIUS = 640, 480, 0.3, 0.15
CENTRE = (0.5 * (WIDTH - 1), 0.5 * (HEIGHT - 1))
BEARING = np.arange(360) * 2.0 * np.pi / 360


def directions(model, k, tilt=None):
    """Return unit rays (ahead, up, right) of every pixel of a camera turned by `tilt` (rows its axes)."""
    column, row = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    z, y = column - CENTRE[0], CENTRE[1] - row
    r = np.hypot(z, y)
    zenith = {"perspective": np.arctan(r / k), "equidistant": r / k}[model]
    scale = np.sin(zenith) / np.maximum(r, 1e-9)
    return np.stack([np.cos(zenith), scale * y, scale * z], axis=-1) @ (np.eye(3) if tilt is None else tilt)


def drawn(rays, *, offset=(0.0, 0.0), line=0.003, hidden=(), noise=3.0, seed=0):
    """Return a picture of the ring that a plane AHEAD draws on a round pipe whose axis lies at -offset (y, z)."""
    a, up, right = np.moveaxis(rays, -1, 0)
    across = np.maximum(up**2 + right**2, 1e-12)
    along = up * offset[0] + right * offset[1]
    reach = (
        -along + np.sqrt(np.maximum(along**2 - across * (offset[0] ** 2 + offset[1] ** 2 - RADIUS**2), 0))
    ) / across
    light = np.exp(-0.5 * ((reach * a - AHEAD) / line) ** 2) * (a > 0)
    bearing = np.mod(np.degrees(np.arctan2(up, right)), 360.0)
    for low, high in hidden:
        light[(bearing > low) & (bearing < high)] = 0.0
    colour = np.array([20.0, 30.0, 180.0])
    picture = 12.0 + light[..., None] * colour
    picture += noise * np.random.default_rng(seed).standard_normal(picture.shape)
    return np.clip(picture, 0, 255).astype(np.uint8)


def truth(offset):
    y, z = np.sin(BEARING), np.cos(BEARING)
    along = y * offset[0] + z * offset[1]
    return -along + np.sqrt(along**2 - (offset[0] ** 2 + offset[1] ** 2 - RADIUS**2))


@pytest.mark.parametrize(("model", "k"), [("perspective", 420.0), ("equidistant", 480.0)])
@pytest.mark.parametrize("offset", [(0.0, 0.0), (0.012, -0.006)])
def test_radii_are_those_of_the_pipe(model, k, offset):
    reader = RingReader(MountedCamera(Lens(model, k), CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD))
    reading = reader.read(drawn(directions(model, k), offset=offset))
    error = reading.range - truth(offset)
    assert np.isfinite(error).mean() > 0.99
    assert abs(np.nanmean(error)) < 0.0005 * RADIUS
    assert np.sqrt(np.nanmean(error**2)) < 0.003 * RADIUS


def test_a_tilted_camera_sees_the_same_ring():
    pitch = np.radians(4.0)
    tilt = np.array([[np.cos(pitch), np.sin(pitch), 0], [-np.sin(pitch), np.cos(pitch), 0], [0, 0, 1.0]])
    picture = drawn(directions("perspective", 420.0, tilt))
    lens = Lens("perspective", 420.0)
    right = RingReader(MountedCamera(lens, CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD, pitch=pitch)).read(picture)
    wrong = RingReader(MountedCamera(lens, CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD)).read(picture)
    assert np.nanmax(np.abs(right.range - RADIUS)) < 0.005 * RADIUS
    assert np.nanmax(np.abs(wrong.range - RADIUS)) > 0.05 * RADIUS


def test_a_hidden_arc_stays_missing():
    picture = drawn(directions("perspective", 420.0), hidden=[(230.0, 310.0)])
    reading = RingReader(MountedCamera(Lens("perspective", 420.0), CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD)).read(
        picture
    )
    assert np.isnan(reading.range[231:310]).all()
    assert np.isfinite(reading.range[:225]).all() and np.isfinite(reading.range[316:]).all()


def test_a_fainter_second_ring_and_a_glint_are_not_followed():
    rays = directions("perspective", 420.0)
    ghost = drawn(rays * np.array([0.75, 1.0, 1.0]), noise=0.0).astype(float) - 12.0
    picture = drawn(rays, noise=2.0).astype(float) + 0.3 * ghost
    picture[100:108, 300:318] = 255.0
    reading = RingReader(MountedCamera(Lens("perspective", 420.0), CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD)).read(
        np.clip(picture, 0, 255).astype(np.uint8)
    )
    assert np.nanmax(np.abs(reading.range - RADIUS)) < 0.02 * RADIUS
    assert np.isfinite(reading.range).mean() > 0.95


def test_colour_is_found_and_grey_pictures_are_read():
    rays = directions("perspective", 420.0)
    camera = MountedCamera(Lens("perspective", 420.0), CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD)
    picture = drawn(rays)
    for view in (picture, picture[:, :, ::-1].copy(), picture[:, :, 2].copy()):
        assert np.nanmean(RingReader(camera).read(view).range) == pytest.approx(RADIUS, rel=5e-4)


@pytest.mark.parametrize("level", [0, 90])
def test_a_picture_without_a_ring_says_so(level):
    noise = level + 4.0 * np.random.default_rng(1).standard_normal((HEIGHT, WIDTH, 3))
    camera = MountedCamera(Lens("perspective", 420.0), CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD)
    reading = RingReader(camera).read(np.clip(noise, 0, 255).astype(np.uint8))
    assert not reading and "ring" in reading.reason
    assert np.isnan(reading.range).all()


def test_what_cannot_be_is_refused():
    lens = Lens("perspective", 420.0)
    with pytest.raises(ParameterError, match=r"ahead = -0\.1"):
        MountedCamera(lens, CENTRE, (WIDTH, HEIGHT), laser_ahead=-0.1)
    with pytest.raises(ParameterError, match=r"centre = 700 .* 640 x 480"):
        MountedCamera(lens, (700.0, 10.0), (WIDTH, HEIGHT), laser_ahead=AHEAD)
    camera = MountedCamera(lens, CENTRE, (WIDTH, HEIGHT), laser_ahead=AHEAD)
    with pytest.raises(ParameterError, match="'pink' is not known"):
        RingReader(camera, colour="pink")
    with pytest.raises(InputError, match="it is 320 by 240, its lens is for 640 by 480"):
        RingReader(camera).read(np.zeros((240, 320, 3), np.uint8))
