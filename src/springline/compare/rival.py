"""The rival of 'same pipe': another pipe, laid with the same joints and entered at a manhole too."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from .features import JOINT, MANHOLE
from .fit import Sense

if TYPE_CHECKING:
    from .fit import Fit

_NATS_KEPT = 12.0


def another_pipe(sense: Sense, fit: Fit) -> float:
    """Return the log evidence of another pipe; 0 is that of independent features, which is the least.

    Joints laid to the same module fall into step, but the drift then walks by the spacing of both pipes' joints. Every
    inspection begins at a manhole, so the first one in common says nothing. No other feature is shared.
    """
    module, spacing = sense.laid.module, sense.laid.spacing
    noise, walk = fit.state.noise, sense.options.walk
    shared = np.zeros_like(fit.state.shared)
    if np.isfinite(module) and module > 0:
        own = max(spacing**2 - 2.0 * noise**2, (0.1 * spacing) ** 2)
        walk = float(np.sqrt(walk**2 + 2.0 * own / module))
        shared[JOINT] = fit.state.shared[JOINT]
    shared[MANHOLE] = fit.state.shared[MANHOLE]
    manhole = sense.a.kind == MANHOLE
    seen = sense.a.take(sense.laid.seen & (~manhole | (np.cumsum(manhole) == 1)))
    alike = Sense(seen, sense.b, sense.options, sense.shift)
    kept = fit.scales[fit.log_evidence > fit.log_evidence.max() - _NATS_KEPT]
    states = (replace(fit.state, scale=float(s), shared=shared, walk=walk) for s in kept)
    grid = alike.grid(noise)
    return max(0.0, *(alike.evidence(s, grid) for s in states))
