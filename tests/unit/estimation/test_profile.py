"""Sags and angles at joints of made-up axes, against what was made."""

import numpy as np
import pytest

from springline.estimation.covariance import Covariance
from springline.estimation.profile import find_sags, joint_angles
from springline.estimation.states import AXIS, BLOCK, DIRECTION, SCALARS, SECTION

STEP, COUNT = 0.05, 401
AT = STEP * np.arange(COUNT)


def knots_of(elevation, heading=None):
    """Return knots of a straight northward axis with this elevation."""
    knots = np.zeros((COUNT, BLOCK))
    knots[:-1, AXIS.start + 1], knots[:-1, AXIS.start + 2] = STEP, np.diff(elevation)
    knots[:, SECTION.start] = 0.15
    knots[:, DIRECTION.start + 1] = np.gradient(elevation, STEP)
    if heading is not None:
        knots[:, DIRECTION.start] = heading
    return knots


def certain_to(sigma):
    """Return a covariance in which every state errs by itself."""
    return Covariance.of(
        np.tile(sigma**2 * np.eye(BLOCK), (COUNT, 1, 1)),
        np.zeros((COUNT - 1, BLOCK, BLOCK)),
        np.zeros((COUNT, BLOCK, SCALARS)),
        np.eye(SCALARS),
        np.zeros((COUNT, 4, 4)),
    )


def dip(depth, middle=10.0, length=6.0):
    inside = np.abs(AT - middle) < length / 2.0
    return np.where(inside, -0.5 * depth * (1.0 + np.cos(2.0 * np.pi * (AT - middle) / length)), 0.0)


def test_a_dip_in_a_level_pipe_is_found_and_holds_water_to_its_brim():
    (sag,) = find_sags(AT, knots_of(dip(0.025)), dip(0.025), certain_to(1e-5))
    assert (sag.depth, sag.ponding) == pytest.approx((0.025, 0.025), rel=1e-6)
    assert sag.lowest == pytest.approx(10.0)
    # A hundred ways or so before and after the middle err by themselves, at half weight each; so do mean radius and
    # ovality at the ends, at half weight, and in the middle.
    ways = sag.length / STEP
    assert sag.depth_sigma == pytest.approx(1e-5 * np.sqrt(ways / 4.0 + 2.0 * 1.5), rel=0.02)


def test_a_pipe_that_falls_steeply_drains_its_sag():
    elevation = dip(0.025) - 0.05 * AT
    (sag,) = find_sags(AT, knots_of(elevation), elevation, certain_to(1e-5))
    assert sag.depth == pytest.approx(0.025, rel=1e-3)
    assert sag.ponding == 0.0


def test_what_lies_within_its_sigma_is_no_sag():
    assert find_sags(AT, knots_of(dip(0.004)), dip(0.004), certain_to(1e-3)) == ()
    assert find_sags(AT, knots_of(dip(0.001)), dip(0.001), certain_to(1e-6)) == ()


def test_the_angle_at_a_joint_is_the_turn_of_the_axis():
    heading = np.where(AT > 8.0, 0.004, 0.0)
    (one,) = joint_angles(np.array([8.0]), AT, knots_of(0.002 * np.maximum(AT - 8.0, 0.0), heading), certain_to(1e-4))
    assert (one.right, one.up) == pytest.approx((0.004, 0.002), rel=1e-3)
    assert one.right_sigma == pytest.approx(1e-4 * np.sqrt(2.0 / 13.0), rel=0.05)
    assert joint_angles(np.array([0.1]), AT, knots_of(0.0 * AT), certain_to(1e-4)) == ()
