"""What must be known to read a comparison: stretches that could not be compared, and plain sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .edges import COMPARED, WHY_NOT

if TYPE_CHECKING:
    from .pair import Comparison


def missing(whole: Comparison) -> tuple[tuple[float, float, str], ...]:
    """Return the stretches of A that cannot be compared, and why."""
    spans = [(s.start, s.end, s.reason) for s in whole.placed.flagged]
    first, last = whole.a.extent
    nodes = whole.placed.drift.chainage_a
    for start, end in ((first, nodes[0]), (nodes[-1], last)):
        if end > start + 1e-6:
            spans.append((float(start), float(end), "not inspected by both"))
    if whole.difference is not None:
        d = whole.difference
        for code, words in WHY_NOT.items():
            if code == COMPARED or words.startswith("place"):
                continue
            rows = (d.why == code).mean(axis=1) > 0.5
            edges = np.flatnonzero(np.diff(np.concatenate(([False], rows, [False]))))
            spans += [
                (float(d.chainage[i]), float(d.chainage[j - 1] + d.step), words)
                for i, j in zip(edges[::2], edges[1::2], strict=True)
            ]
    clipped = ((max(s, first), min(e, last), why) for s, e, why in spans)
    return tuple(sorted(s for s in clipped if s[1] > s[0]))


def notes(whole: Comparison, agreed: bool) -> tuple[str, ...]:
    """Return what must be known to read the result, in plain sentences.

    Args:
        whole: The comparison.
        agreed: Whether the matched features lie where the registration has them.
    """
    told, placed = [], whole.placed
    if whole.match is not None and not whole.match.accepted:
        told.append(f"The features alone do not place B on A ({whole.match.reason}); the wall's relief does.")
    elif whole.match is not None and not agreed:
        told.append("The wall's relief contradicts the match of features, and decides: it holds far more detail.")
    if whole.difference is None:
        return tuple(told)
    if not placed.refined.any():
        told.append(
            "The wall is too smooth for its relief to place rings on rings: chainage stands on matched features alone."
        )
    if placed.roll_source == "assumed":
        told.append(
            "How the second sensor was rolled against the first is not known and taken as zero: places round the pipe "
            "and horizontal and vertical diameters are comparable only as far as both sensors rode upright."
        )
    found = whole.difference
    stated = np.hypot(whole.a.range_scale_sigma, whole.b.range_scale_sigma)
    told.append(
        f"Ranges of B are {abs(found.scale) * 1e2:.3f} % {'longer' if found.scale >= 0 else 'shorter'} than those of A "
        f"throughout. That was taken out as a difference of calibration (the sensors' scales are known to "
        f"{stated * 1e2:.2g} %): a change of all diameters alike cannot be told from it."
    )
    most = float(np.abs(found.pattern).max())
    if most > 0:
        told.append(
            f"A pattern that all rings share (up to {most * 1e3:.2f} mm) was taken out: wear alike along the whole "
            "pipe cannot be told from a sensor's error at that bearing."
        )
    if "pose" not in (whole.a.wall.roll_source, whole.b.wall.roll_source):
        told.append(
            "The tilt of the sensors was not estimated; 2 degrees of it, one-sigma, stand in the uncertainty of "
            "diameters and ovality."
        )
    return tuple(told)
