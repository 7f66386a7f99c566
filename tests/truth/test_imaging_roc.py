"""The chosen decision tells laterals from joints where classical descriptors do not: bench/imaging_roc, shortened."""

import numpy as np
import pytest
from bench.imaging_roc import LENS, RADIUS, auc, contour, judge

from springline.geometry.camera import camera_matrix
from springline.imaging.decision import expected_contour

MATRIX = camera_matrix([0.0, 0.0, 0.0], [1.0, 0.0, 0.0])
TEMPLATE = expected_contour(MATRIX, LENS, RADIUS, RADIUS, ahead=2.0 * RADIUS)


def _scores(kind, error, hidden, method, count, seed):
    rng = np.random.default_rng(seed)
    made = [contour(rng, kind, error, hidden) for _ in range(count)]
    return np.array([judge(one, ahead, MATRIX, error, method, TEMPLATE) for one, ahead in made])


@pytest.mark.parametrize("error", ["size", "position", "orientation", "all"])
def test_reprojection_tells_laterals_from_joints_with_a_third_hidden(error):
    lateral = _scores("lateral", error, 0.3, "reprojection", 16, 1)
    joints = np.concatenate([_scores(kind, error, 0.3, "reprojection", 8, 2) for kind in ("circle", "oval")])
    assert auc(lateral, joints) >= 0.98


def test_the_published_criterion_fails_where_the_contour_is_partly_hidden():
    lateral = _scores("lateral", "orientation", 0.3, "frequency-norm", 60, 3)
    joints = np.concatenate([_scores(kind, "orientation", 0.3, "frequency-norm", 30, 4) for kind in ("circle", "oval")])
    assert auc(lateral, joints) < 0.7


def test_blobs_on_the_wall_are_told_apart_when_the_pose_is_known():
    lateral = _scores("lateral", "size", 0.0, "reprojection", 40, 5)
    blobs = _scores("blob", "size", 0.0, "reprojection", 40, 6)
    assert auc(lateral, blobs) >= 0.95


def test_half_of_a_blob_is_no_half_of_a_lateral_though_the_pose_errs():
    lateral = _scores("lateral", "all", 0.5, "reprojection", 20, 7)
    blobs = _scores("blob", "all", 0.5, "reprojection", 20, 8)
    assert auc(lateral, blobs) >= 0.9
