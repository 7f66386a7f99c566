"""The rival of 'same pipe': another pipe, laid with the same joints."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .features import JOINT

if TYPE_CHECKING:
    from .fit import Fit, Sense

_NATS_KEPT = 12.0


def same_joints(sense: Sense, fit: Fit) -> float:
    """Return the log evidence of another pipe laid with the same joints; 0 is that of independent features.

    Joints fall into step, but the drift walks by the spacing of both pipes' joints, and no other kind is shared.
    """
    module, spread = sense.laid.module, sense.laid.spacing
    if not np.isfinite(module) or module <= 0:
        return 0.0
    noise = fit.state.noise
    own = max(spread**2 - 2.0 * noise**2, (0.1 * spread) ** 2)
    shared = np.zeros_like(fit.state.shared)
    shared[JOINT] = fit.state.shared[JOINT]
    walk = float(np.sqrt(sense.options.walk**2 + 2.0 * own / module))
    kept = fit.scales[fit.log_evidence > fit.log_evidence.max() - _NATS_KEPT]
    states = (replace(fit.state, scale=float(s), shared=shared, walk=walk) for s in kept)
    grid = sense.grid(noise)
    return float(max(sense.evidence(s, grid) for s in states))
