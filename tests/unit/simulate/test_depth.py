"""The depth camera: its points lie on the true wall, seen from where it stood."""

from __future__ import annotations

import numpy as np
import pytest

from springline.simulate import parse, simulate
from springline.simulate.attitude import in_pipe

TEXT = """
name = "depth"
[pipe]
diameter = 0.4
run = [{{kind = "straight", length = 4.0}}]
[robot]
follow = false
offset_y = -0.06
offset_z = 0.03
pitch_deg = 5.0
yaw_deg = -8.0
roll_deg = 20.0
[depth_camera]
captures = [0.5, 1.5]
width = 96
height = 64
focal_px = 50.0
range_max = 2.0
noise = {noise}
{more}
"""


def test_points_lie_on_the_wall():
    survey = simulate(parse(TEXT.format(noise=0.0, more="")))
    points, truth = survey.points, survey.truth
    xyz = np.stack([points[k].values for k in "xyz"], axis=1)
    assert (xyz[:, 0] > 0.0).all()
    for k in range(2):
        mine = points["time"].values == truth["capture_time"].values[k]
        axes = in_pipe(*(truth[f"capture_{n}"].values[k] for n in ("pitch", "yaw", "roll")))
        place = xyz[mine] @ axes + [0.0, truth["capture_offset_y"].values[k], truth["capture_offset_z"].values[k]]
        assert np.allclose(np.hypot(place[:, 1], place[:, 2]), 0.2, atol=1e-12)
        assert mine.sum() > 1000
    assert np.degrees(truth["capture_roll"].values) == pytest.approx([20.0, 20.0], abs=1e-6)
    assert points.attrs["origin_is_sensor"] == 1


def test_depth_noise_grows_with_depth_and_pixels_drop_out():
    clean = simulate(parse(TEXT.format(noise=0.0, more=""))).points
    noisy = simulate(parse(TEXT.format(noise=0.002, more="noise_quadratic = 0.01")), 2).points
    # The noise is along the camera's axis and leaves each ray where it was: match pixels by capture and ray.
    rays = [
        {(t, round(y / x, 6), round(z / x, 6)): x for t, x, y, z in zip(*(c[k].values for k in "txyz"), strict=True)}
        for c in (clean.rename(time="t"), noisy.rename(time="t"))
    ]
    both = sorted(set(rays[0]) & set(rays[1]))
    assert len(both) > 0.95 * len(rays[0])
    depth = np.array([rays[0][key] for key in both])
    error = np.array([rays[1][key] for key in both]) - depth
    assert np.std(error / np.hypot(0.002, 0.01 * depth**2)) == pytest.approx(1.0, abs=0.04)
    dropped = simulate(parse(TEXT.format(noise=0.0, more="dropout = 0.3")), 2).points
    assert dropped.sizes["point"] == pytest.approx(0.7 * clean.sizes["point"], rel=0.05)
