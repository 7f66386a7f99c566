"""The simulator's camera against `springline.geometry`, OpenCV and photometry: two programs that share no formula."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from springline.geometry import camera as closed
from springline.geometry.lenses import Lens
from springline.geometry.openings import joint_contour, lateral_contour
from springline.geometry.robot import frame
from springline.simulate import Footage, parse
from springline.simulate.lens import LIMITS, LensModel

R = 0.15
CURVED = (0.05, -0.02, 0.003, -0.0004)

PIPE = """
name = "x"
[pipe]
diameter = 0.3
material = "PVC-U"
run = [{{kind = "straight", length = 5.0}}]
surface = {{dirt = 0.0}}
{pipe}
[robot]
follow = false
offset_y = {{mean = 0.01, amplitude = 0.008, period = 0.9}}
offset_z = {{amplitude = 0.02, period = 0.7}}
pitch_deg = {{amplitude = 4.0, period = 0.83}}
yaw_deg = {{amplitude = 3.0, period = 0.61}}
roll_deg = {{amplitude = 10.0, period = 0.47}}
[camera]
spacing = 0.2
{camera}
"""


def footage(pipe: str = "", camera: str = "", seed: int = 0) -> Footage:
    return Footage(parse(PIPE.format(pipe=pipe, camera=camera)), seed)


def at_rest(pipe: str = "", camera: str = "") -> Footage:
    text = PIPE.format(pipe=pipe, camera=camera)
    return Footage(parse(text[: text.index("[robot]")] + text[text.index("[camera]") :]))


@pytest.mark.parametrize("model", LIMITS)
def test_lenses_agree_with_the_closed_forms(model):
    coefficients = CURVED if model == "polynomial" else ()
    ours, theirs = LensModel(model, 300.0, coefficients), Lens(model, 300.0, coefficients)
    rng = np.random.default_rng(1)
    ways = rng.standard_normal((4000, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    ahead = closed.camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
    # Within a degree of its end a model's own slope magnifies the rounding of a direction.
    zenith = np.arccos(ways[:, 0])
    sure = np.abs(zenith - theirs.max_zenith) > np.radians(1.0)
    image, expected = ours.project(ways), closed.project(ahead, ways, theirs)
    assert np.array_equal(np.isnan(image[sure]), np.isnan(expected[sure]))
    seen = sure & np.isfinite(image[:, 0])
    assert seen.sum() > 1500
    assert np.abs(image - expected)[seen].max() <= 1e-9 * np.abs(expected[seen]).max()
    assert np.abs(ours.directions(image[seen]) - ways[seen]).max() < 1e-9
    assert np.abs(ours.directions(image[seen]) - closed.rays(ahead, image[seen], theirs)).max() < 1e-9


def test_the_polynomial_is_that_of_opencv():
    cv2 = pytest.importorskip("cv2")
    rng = np.random.default_rng(2)
    ways = np.column_stack([np.ones(500), rng.uniform(-1.5, 1.5, (500, 2))])
    ours = LensModel("polynomial", 280.0, CURVED).project(ways)
    matrix = np.diag([280.0, 280.0, 1.0])
    # OpenCV looks along its z, with x right and y down.
    points = np.stack([ways[:, 2], -ways[:, 1], ways[:, 0]], axis=1)[:, None]
    theirs = cv2.fisheye.projectPoints(points, np.zeros(3), np.zeros(3), matrix, np.array(CURVED))[0][:, 0]
    assert np.abs(ours - theirs * [1.0, -1.0]).max() < 1e-9 * 280.0


def pose(film: Footage, index: int) -> np.ndarray:
    """Return the camera matrix of a frame in pipe axes whose origin lies at chainage 0, from the truth alone."""
    truth = film.truth().isel(frame=index)
    eye = [float(truth[f"frame_{name}"]) for name in ("chainage", "offset_y", "offset_z")]
    return closed.camera_at(eye, frame(*(float(truth[f"frame_{name}"]) for name in ("pitch", "yaw", "roll"))))


@pytest.mark.parametrize("model", ["equidistant", "perspective", "stereographic"])
def test_outlines_are_where_the_closed_forms_project_them(model):
    film = footage(
        "lateral = [{chainage = 2.5, clock_h = 2.0, diameter = 0.12, inclination_deg = 35.0}]\n"
        "joint = [{chainage = 3.1, gap = 0.02}]",
        f'width = 900\nheight = 700\npitch_deg = 5.0\nyaw_deg = -8.0\nlens = {{model = "{model}"}}',
    )
    lens = Lens(model, film.lens.k)
    turn = np.linspace(0.0, 2.0 * np.pi, 20001)
    # The scenario's chainage is where the bore's axis meets the wall, the closed form's where it meets the axis.
    x = 2.5 - R * np.tan(np.radians(35.0))
    bearing = np.pi / 2 - 2.0 * np.pi / 6.0
    curves = {
        ("lateral", 0): lateral_contour(turn, R, R, 0.06, bearing=bearing, inclination=np.radians(35.0), x=x),
        ("joint", 0): joint_contour(turn, R, R, x=3.09),
        ("joint", 1): joint_contour(turn, R, R, x=3.11),
    }
    compared = 0
    for k in range(4, 12):
        for one in film.outlines(k):
            curve = closed.to_pixels(closed.project(pose(film, k), curves[one.kind, one.part], lens), film.centre)
            points = one.points[one.seen]
            away = np.sqrt(np.nanmin(np.sum((points[:, None] - curve[None]) ** 2, axis=2), axis=1))
            assert away.max() < 0.06  # half the step of a curve of 20,000 points, near the picture's edge
            compared += 1
    assert compared > 12


def test_pictures_show_a_lateral_where_its_outline_lies():
    film = footage("lateral = [{chainage = 2.5, clock_h = 3.0, diameter = 0.1}]", "ambient = 0.2")
    k = int(np.argmin(np.abs(2.5 - film.chainage - 0.2)))
    light = film.light(k).sum(axis=2)
    (outline,) = film.outlines(k)
    middle = outline.points.mean(axis=0)
    steps = np.arange(-8.0, 8.01, 0.1)
    errors = []
    for point in outline.points[::2]:
        out = (point - middle) / np.linalg.norm(point - middle)
        column, row = (point + steps[:, None] * out).T
        profile = map_coordinates(light, [row, column], order=1)
        hole, wall = profile[steps < -3.0].mean(), profile[steps > 3.0].mean()
        if wall > 1.5 * hole:  # elsewhere the bore's own wall is as bright as the pipe's
            errors.append(steps[np.argmax(profile > 0.5 * (hole + wall))])
    assert len(errors) > 24
    assert np.abs(np.median(errors)) < 0.3
    assert np.percentile(np.abs(errors), 90) < 1.0


def test_the_laser_draws_the_true_ring():
    film = footage(
        "section = [{shape = 'ellipse', semi_major = 0.155, semi_minor = 0.145, axis_deg = 20.0}]",
        "width = 1280\nheight = 960\nlamp = []\nlaser = {ahead = 0.2, speckle = 0.0, pitch_deg = 2.0}",
    )
    ring, theta = film.laser_ring(), np.radians(np.arange(360))
    for k in (3, 9):
        source, axes = film.laser_pose(k)
        wall = source + ring[k][:, None] * (np.cos(theta)[:, None] * axes[2] + np.sin(theta)[:, None] * axes[1])
        image = film.lens.project((wall - film.origin[k]) @ film.axes[k].T)
        radius = np.hypot(*image.T)
        steps = np.arange(-10.0, 10.01, 0.1)
        along = image[:, None] * (1.0 + steps[None, :, None] / radius[:, None, None])
        light = map_coordinates(
            film.light(k)[..., 0], [film.centre[1] - along[..., 1], film.centre[0] + along[..., 0]], order=1
        )
        error = (light * steps).sum(axis=1) / light.sum(axis=1)
        assert light.max(axis=1).min() > 0.2
        assert abs(error.mean()) < 0.0003 * radius.mean()
        assert error.std() < 0.0006 * radius.mean()


def test_the_true_ring_is_that_of_the_closed_form():
    film = footage("", "lamp = []\nlaser = {ahead = 0.2}")
    truth = film.truth()
    assert truth["laser_range"].shape == (len(film), 360)
    # In a round pipe a ring across a robot tilted by pitch and yaw is at least as far away as the wall's nearest side.
    source, axes = film.laser_pose(np.arange(len(film)))
    theta = truth["laser_bearing"].values
    ways = np.cos(theta)[:, None] * axes[:, None, 2] + np.sin(theta)[:, None] * axes[:, None, 1]
    wall = source[:, None] + truth["laser_range"].values[..., None] * ways
    assert np.allclose(np.hypot(wall[..., 0], wall[..., 2]), R, atol=1e-9)


def test_light_falls_with_distance_and_slant():
    film = at_rest(camera="lamp = [{half_angle_deg = 60.0}]\nambient = 0.0\nsight = 20.0")
    light = film.light(4).mean(axis=2)
    zenith = np.radians(np.arange(20.0, 44.0, 4.0))
    turn = np.linspace(0.0, 2.0 * np.pi, 2000)
    measured, expected = [], []
    for angle in zenith:
        r = film.lens.k * angle
        ring = map_coordinates(light, [film.centre[1] - r * np.sin(turn), film.centre[0] + r * np.cos(turn)], order=1)
        measured.append(ring.mean())
        # The wall at range R/sin, met at the slant of the zenith, by a lamp whose beam falls as the cosine off it.
        expected.append(np.cos(angle) * np.sin(angle) ** 3)
    ratio = np.array(measured) / np.array(expected)
    # A gloss on the wall throws back little at these slants; the rest is the wall's own mottle.
    assert np.abs(ratio / ratio.mean() - 1.0).max() < 0.05
