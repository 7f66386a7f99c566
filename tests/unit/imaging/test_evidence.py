"""What the misfit of the best fit does not say: the order of points along a joint, and irregular outlines."""

import numpy as np

from springline.geometry.camera import camera_matrix, project, turn_camera
from springline.geometry.lenses import Lens
from springline.geometry.openings import joint_contour, lateral_contour
from springline.imaging.decision import decide
from springline.imaging.reprojection import Place, PosePrior, fit_joint, fit_lateral

LENS = Lens.of_view_angle("sine", np.radians(120.0), 384.0)
AHEAD = camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
TURN = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
LOOSE = PosePrior(offset=0.3, turn=0.3)
NEAR = Place(2.2, 0.3, 0.5 * np.pi, 0.1)


def _seen(edge, seed=0, hidden=0):
    """Points of an edge, off by 1.4 px, a run of them hidden, by a camera that is turned."""
    rng = np.random.default_rng(seed)
    points = project(turn_camera(AHEAD, 0.25, -0.2, 0.3), edge, LENS) + rng.normal(0.0, 1.4, (200, 2))
    points = np.roll(points, -rng.integers(200), axis=0)
    points[:hidden] = np.nan
    return points


def test_a_small_far_bore_is_no_piece_of_a_joint():
    small = _seen(lateral_contour(TURN, 1.0, 1.0, 0.06, x=2.2), hidden=60)
    joint = fit_joint(small, AHEAD, LENS, 1.0, 1.0, prior=LOOSE, near=NEAR)
    lateral = fit_lateral(small, AHEAD, LENS, 1.0, 1.0, prior=LOOSE, near=NEAR)
    assert lateral.evidence > joint.evidence + 10.0


def test_points_of_a_joint_run_along_it_also_past_what_is_hidden():
    ring = joint_contour(TURN, 1.0, 1.0, x=1.5)
    near = Place(1.5, 0.3)
    for hidden in (0, 60, 120):
        fits = [
            fit_joint(points, AHEAD, LENS, 1.0, 1.0, prior=LOOSE, near=near)
            for points in (_seen(ring, hidden=hidden), _seen(ring, hidden=hidden)[::-1])
        ]
        assert np.isclose(fits[0].evidence, fits[1].evidence, atol=0.5)
        shuffled = np.random.default_rng(1).permutation(_seen(ring, hidden=hidden))
        assert fits[0].evidence > fit_joint(shuffled, AHEAD, LENS, 1.0, 1.0, prior=LOOSE, near=near, noise=1.4).evidence


def test_an_outline_that_waves_is_a_stain_and_a_round_one_a_bore():
    odds = {}
    for name, waves in (("bore", 0.0), ("stain", 0.12)):
        radius = 0.35 * (1.0 + waves * np.cos(3.0 * TURN) + waves * np.sin(4.0 * TURN))
        bearing = 0.5 * np.pi + np.arcsin(radius * np.sin(TURN))
        edge = np.stack([2.2 + radius * np.cos(TURN), np.sin(bearing), np.cos(bearing)], axis=-1)
        odds[name] = [decide(_seen(edge, k, 60), AHEAD, LENS, 1.0, 1.0, prior=LOOSE, near=NEAR) for k in range(3)]
    assert min(one.lateral.stain for one in odds["stain"]) > 5.0
    assert max(one.lateral.stain for one in odds["bore"]) < 0.0
    assert {one.kind for one in odds["bore"]} == {"lateral"}
    assert "lateral" not in {one.kind for one in odds["stain"]}


def test_a_pose_that_is_known_pays_for_no_freedom():
    contour = _seen(lateral_contour(TURN, 1.0, 1.0, 0.3, x=1.5))
    turned = turn_camera(AHEAD, 0.25, -0.2, 0.3)
    known = fit_lateral(contour, turned, LENS, 1.0, 1.0)
    loose = fit_lateral(contour, turned, LENS, 1.0, 1.0, prior=LOOSE)
    assert known.evidence > loose.evidence + 5.0
