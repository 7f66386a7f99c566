"""The simulator and `springline.geometry`, built by different constructions, agree to 1e-9 of the radius."""

from __future__ import annotations

import numpy as np
import pytest

from springline.geometry import sections as closed
from springline.geometry.bends import ring_bend
from springline.geometry.robot import offset_deformation, ring_cylinder
from springline.simulate import parse, simulate
from springline.simulate.path import ride_height
from springline.simulate.sections import ellipse, mode
from springline.simulate.shapes import arch, box, egg, horseshoe, loaf, upside_down
from springline.simulate.world import set_up

R = 0.15
BEARING = np.sort(np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, 2000))

SHAPES = {
    "circle": (ellipse(R, R), closed.circle(R)),
    "ellipse": (ellipse(0.16, 0.14, 0.3), closed.ellipse(0.16, 0.14, 0.3)),
    "egg": (egg(0.6, 0.9, 0.15), closed.egg(0.6, 0.9, 0.15)),
    "new egg": (egg(0.6, 0.9, 0.075), closed.egg(0.6, 0.9, 0.075)),
    "horseshoe": (horseshoe(1.2), closed.horseshoe(1.2)),
    "inverted horseshoe": (upside_down(horseshoe(1.2)), closed.inverted_horseshoe(1.2)),
    "loaf": (loaf(2.0, 1.0, 0.25), closed.loaf(2.0, 1.0, 0.25)),
    "loaf with corners": (loaf(2.0, 1.0), closed.loaf(2.0, 1.0, 0.0)),
    "arch": (arch(2.0, 0.6, 0.7), closed.arch(2.0, 0.6, 0.7)),
    "box": (box(2.0, 1.0, 0.2), closed.box(2.0, 1.0, 0.2)),
    "box with corners": (box(2.0, 1.0), closed.box(2.0, 1.0, 0.0)),
}


@pytest.mark.parametrize("name", SHAPES)
def test_sewer_shapes(name):
    ours, theirs = SHAPES[name]
    assert np.abs(ours.radius(BEARING) - np.squeeze(theirs.polar_radius(BEARING))).max() < 1e-9 * R


@pytest.mark.parametrize("rule", ["exact", "ramanujan"])
@pytest.mark.parametrize("number", [1, 2, 3, 4, 5])
def test_modes_over_their_whole_range(number, rule):
    for s1, s02, s01 in ((0.99, 1.0, 1.0), (0.9, 0.97, 0.95), (0.75, 0.9, 0.8), (0.6, 0.8, 0.7)):
        ours = mode(number, R, s1, s02, s01, rule=rule).radius(BEARING)
        theirs = np.squeeze(closed.hinged(number, s1, s02, s01, R, rule=rule).polar_radius(BEARING))
        assert np.abs(ours - theirs).max() < 1e-9 * R
        upset = upside_down(mode(number, R, s1, s02, s01, rule=rule)).radius(BEARING)
        theirs = np.squeeze(closed.hinged(number, s1, s02, s01, R, rule=rule, inverted=True).polar_radius(BEARING))
        assert np.abs(upset - theirs).max() < 1e-9 * R


ROBOT = """
[robot]
follow = false
length = 0.1
wheelbase = 0.05
half_span = 0.02
pitch_deg = {{amplitude = 14.0, period = 0.83}}
yaw_deg = {{amplitude = 11.0, period = 0.61, phase_deg = 40.0}}
roll_deg = {{amplitude = 25.0, period = 0.47}}
offset_y = {{amplitude = 0.02, period = 0.71}}
offset_z = {{amplitude = 0.03, period = 0.53, phase_deg = 70.0}}
[rings]
spacing = 0.013
noise = 0.0
bearings = {bearings}
"""


def noiseless(pipe: str, bearings: int = 90):
    text = f'name = "x"\n[pipe]\ndiameter = 0.3\n{pipe}\n' + ROBOT.format(bearings=bearings)
    world = set_up(parse(text), 0)
    survey = simulate(parse(text))
    return world, survey


def in_double(world, survey) -> np.ndarray:
    """Return the true ranges in double precision (a survey keeps single), and check that the survey holds them."""
    from springline.simulate.cast import cast_rays

    travelled = world.counter.where(survey.rings["distance"].values)
    origin, axes = world.motion.middle(travelled), world.motion.axes(travelled)
    bearing = survey.rings["bearing"].values
    rays = np.cos(bearing)[:, None] * axes[:, None, 2] + np.sin(bearing)[:, None] * axes[:, None, 1]
    cell = world.route.centreline.find(origin, travelled)
    exact, _, _ = cast_rays(world.wall, origin, cell, rays, 5.0)
    assert np.allclose(exact, survey.rings["range"], atol=1e-7)
    return exact


def pose(survey, keep=slice(None)):
    truth = survey.truth
    angles = [truth[name].values[keep, None] for name in ("pitch", "yaw", "roll")]
    offset = tuple(truth[f"offset_{axis}"].values[keep, None] for axis in "yz")
    return angles, offset


def test_rings_of_a_weaving_robot_in_an_elliptical_pipe():
    world, survey = noiseless(
        'gradient = -0.03\nheading_deg = 77.0\nrun = [{kind = "straight", length = 4.0}]\n'
        'section = [{shape = "ellipse", semi_major = 0.16, semi_minor = 0.14}]'
    )
    angles, offset = pose(survey)
    theirs = ring_cylinder(survey.rings["bearing"].values, 0.16, 0.14, *angles, offset=offset)
    assert np.abs(in_double(world, survey) - theirs).max() < 1e-9 * R


@pytest.mark.parametrize("radius", [0.45, 1.5])
def test_rings_of_a_weaving_robot_in_an_upward_elliptical_bend(radius):
    length = radius * np.radians(70.0)
    world, survey = noiseless(
        f'gradient = -0.5\nrun = [{{kind = "bend", radius = {radius}, angle_deg = 70.0, towards = "up"}}]\n'
        'section = [{shape = "ellipse", semi_major = 0.16, semi_minor = 0.14}]'
    )
    chainage = survey.truth["ring_chainage"].values
    # The closed form knows no end of the bend: take the rings whose readings all lie within it.
    keep = (chainage > 0.2) & (chainage < length - 0.2)
    angles, offset = pose(survey, keep)
    theirs = ring_bend(survey.rings["bearing"].values, radius, 0.16, 0.14, *angles, offset=offset)
    assert keep.sum() > 5
    assert np.abs(in_double(world, survey)[keep] - theirs).max() < 1e-9 * R


def test_wheels_ride_as_the_closed_form_says():
    text = (
        'name = "x"\n[pipe]\ndiameter = 0.3\nperimeter = "ramanujan"\nrun = [{kind = "straight", length = 4.0}]\n'
        'section = [{shape = "mode", mode = 1, s1 = 0.85}]\n[robot]\npath = "kinematic"\nhalf_span = 0.07\n'
        "[rings]\nspacing = 0.1\nbearings = 8"
    )
    survey = simulate(parse(text))
    lift = offset_deformation(0.85, half_span=0.07, r=R)
    assert np.allclose(survey.truth["offset_y"], lift, atol=1e-9)
    assert ride_height(parse(text)) == pytest.approx(np.sqrt(R**2 - 0.07**2))
