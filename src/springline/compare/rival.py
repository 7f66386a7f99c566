"""The rival of 'same pipe': another pipe, laid with the same joints."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .features import KINDS

if TYPE_CHECKING:
    from .features import FeatureList
    from .fit import Fit, Sense

_JOINT = KINDS.index("joint")
_FEWEST_JOINTS = 4
_NATS_KEPT = 12.0


def joint_module(features: FeatureList) -> tuple[float, float]:
    """Return the distance between joints [m] and its standard deviation [m]; NaN with fewer than four joints.

    The median of the distances is taken for one pipe's length; only distances near it count, so that a missed joint
    (twice the length) or a false one (a part of it) does not.

    >>> from .features import feature_list
    >>> joint_module(feature_list([0.0, 2.0, 4.0, 6.1, 10.1, 12.0], "joint"))[0]
    2.0
    """
    x = features.chainage[features.kind == _JOINT]
    if x.size < _FEWEST_JOINTS:
        return np.nan, np.nan
    gaps = np.diff(x)
    module = float(np.median(gaps))
    near = gaps[np.abs(gaps - module) < 0.3 * module]
    return module, float(1.4826 * np.median(np.abs(near - np.median(near))))


def same_joints(sense: Sense, fit: Fit) -> float:
    """Return the log evidence of another pipe laid with the same joints; 0 is that of independent features.

    Joints fall into step, but the drift walks by the spacing of both pipes' joints, and no other kind is shared.
    """
    module, spread = joint_module(sense.a)
    if not np.isfinite(module) or module <= 0:
        return 0.0
    noise = fit.state.noise
    own = max(spread**2 - 2.0 * noise**2, (0.1 * spread) ** 2)
    shared = np.zeros_like(fit.state.shared)
    shared[_JOINT] = fit.state.shared[_JOINT]
    walk = float(np.sqrt(sense.options.walk**2 + 2.0 * own / module))
    kept = fit.scales[fit.log_evidence > fit.log_evidence.max() - _NATS_KEPT]
    states = (replace(fit.state, scale=float(s), shared=shared, walk=walk) for s in kept)
    grid = sense.grid(noise)
    return float(max(sense.evidence(s, grid) for s in states))
