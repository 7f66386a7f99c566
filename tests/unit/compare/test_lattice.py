"""A slip of one odometer lies before or after a joint that it alone has seen, by the other's regular joints."""

from __future__ import annotations

import numpy as np
import pytest

from springline.compare import feature_list, match

TRUE = np.cumsum(np.random.default_rng(6).normal(2.5, 0.008, 60))
BEARING = {9: 0.2, 24: 3.0, 41: 1.5, 52: 0.1}
LATERALS = np.array([TRUE[k] + 0.7 for k in BEARING])


def _listed(missing, slip_at=np.inf, seed=0):
    joints = np.delete(TRUE, missing)
    x = np.concatenate((joints, LATERALS))
    kind = np.array(["joint"] * joints.size + ["lateral"] * LATERALS.size, dtype=object)
    bearing = np.concatenate((np.full(joints.size, np.nan), list(BEARING.values())))
    order = np.argsort(x)
    noise = np.random.default_rng(seed).normal(0.0, 0.005, x.size)
    return feature_list((x + noise + 0.3 * (x > slip_at))[order], kind[order], bearing=bearing[order])


@pytest.mark.parametrize("after", [0, 1])
@pytest.mark.parametrize("mirrored", [False, True])
def test_a_slip_is_told_to_lie_before_or_after_a_joint_that_one_alone_has_seen(after, mirrored):
    slip_at = TRUE[30] + (1.0 if after else -1.0)
    a, b = _listed([], slip_at), _listed([30], seed=1)
    found = match(a, b.mirrored() if mirrored else b)
    x = TRUE[30] + 0.3 * (1 - after)
    place, sigma = found.drift.at(x)
    true = b.extent[0] + b.extent[1] - TRUE[30] if mirrored else TRUE[30]
    assert abs(place - true) < 0.04
    assert abs(place - true) < 3.0 * sigma
    assert sigma < 0.05
