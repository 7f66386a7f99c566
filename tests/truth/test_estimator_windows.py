"""Windows bound memory and change nothing: no seam where they meet, and nothing is left behind."""

import os
import tempfile

import numpy as np
import pytest
from bench._joint import given
from tests.truth.test_estimator_ablations import survey

from springline.errors import InputError
from springline.estimation import Rings, estimate_joint

LEAST_RINGS = 100
"""Rings in a window: nine windows, which go to disk."""


@pytest.fixture(scope="module")
def arrays():
    return given(survey())


@pytest.fixture
def small(monkeypatch, tmp_path):
    monkeypatch.setattr("springline.estimation.windows.MOST_RINGS", LEAST_RINGS)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path


def test_windows_leave_no_seam(arrays, small, monkeypatch):
    cut = estimate_joint(*arrays, joints=np.array([2.5, 6.0]))
    monkeypatch.undo()
    whole = estimate_joint(*arrays, joints=np.array([2.5, 6.0]))
    # Rounding moves the states that are known worst by a few thousandths of their sigma.
    for name in ("section", "axis", "chainage"):
        moved = np.abs(getattr(cut, name) - getattr(whole, name))
        sigma = getattr(whole, f"{name}_sigma")
        assert np.max(moved[1:] / sigma[1:]) < 0.02
        np.testing.assert_allclose(getattr(cut, f"{name}_sigma")[1:], sigma[1:], rtol=2e-3)
    # Pitch and yaw at the ends of a bend have more doubt of their own, which hangs on where it is found to end.
    assert np.quantile(np.abs(cut.pose - whole.pose) / whole.pose_sigma, 0.98) < 0.02
    for parts in ("bends", "sags", "joints"):
        assert len(getattr(cut, parts)) == len(getattr(whole, parts)) > 0
    assert [one.depth for one in cut.sags] == pytest.approx([one.depth for one in whole.sags], abs=2e-6)
    assert [one.depth_sigma for one in cut.sags] == pytest.approx([one.depth_sigma for one in whole.sags], rel=2e-3)
    assert [one.right_sigma for one in cut.joints] == pytest.approx([one.right_sigma for one in whole.joints], rel=2e-3)


def test_nothing_is_left_on_disk_whatever_happens(arrays, small, monkeypatch):
    seen = []
    step = "springline.estimation.linearised.Linearised.covariance"
    monkeypatch.setattr(step, lambda *_: seen.extend(small.iterdir()) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        estimate_joint(*arrays)
    if os.name == "posix":
        assert seen == []
    assert list(small.iterdir()) == []


def test_gaps_without_rings_are_windows_of_their_own(arrays, small):
    rings, log, ties = arrays
    rows = (rings.distance < 2.0) | (rings.distance > 6.5)
    some = Rings(rings.distance[rows], rings.parameters[rows], rings.covariance[rows], rings.time[rows])
    found = estimate_joint(some, log, ties)
    assert np.isfinite(found.axis_sigma).all()
    middle = int(np.flatnonzero(np.diff(some.distance) > 1.0)[0])
    assert found.section_sigma[middle, 0] > np.median(found.section_sigma[:, 0])


def test_a_disk_without_room_is_said(arrays, small, monkeypatch):
    class Full:
        def seek(self, place):
            return place

        def write(self, values):
            raise OSError(28, "No space left on device")

        def close(self):
            pass

    monkeypatch.setattr(tempfile, "TemporaryFile", lambda **_: Full())
    with pytest.raises(OSError, match=r"No space left.*TMPDIR") as caught:
        estimate_joint(*arrays)
    assert not isinstance(caught.value, InputError)
