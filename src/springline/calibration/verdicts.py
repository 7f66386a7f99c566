"""Whether a profiler is accurate and repeatable enough for Florida DOT's laser profiling: 0.5 % and 0.12 %."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from .precision import PrecisionStudy

ACCURACY = 0.005
"""Largest bias against the reference, over it (FDOT)."""
REPEATABILITY = 0.0012
"""Largest repeatability standard deviation, over the mean (FDOT)."""


@dataclass(frozen=True)
class PrecisionVerdict:
    """One requirement on one material.

    Attributes:
        material: Its name.
        requirement: accuracy or repeatability.
        value: Bias over the reference, or repeatability standard deviation over the mean; NaN when not known.
        low: Lower end of its 95 % interval.
        high: Upper end.
        limit: What is asked for.
        verdict: pass, fail, uncertain (the interval straddles the limit) or not_assessed.
    """

    material: str
    requirement: str
    value: float
    low: float
    high: float
    limit: float
    verdict: str


def judge_precision(
    study: PrecisionStudy, *, accuracy: float = ACCURACY, repeatability: float = REPEATABILITY
) -> tuple[PrecisionVerdict, ...]:
    """Return the verdicts on accuracy and repeatability for each material.

    Args:
        study: With references for accuracy, and repeated results for repeatability.
        accuracy: Largest bias over the reference.
        repeatability: Largest repeatability standard deviation over the mean. The procedure does not say whether it
            means that or the limit r, 2.8 times as much; the study states both, and this judges the first.

    >>> from springline.calibration import study_precision
    >>> mm = [300.1, 300.2, 300.1, 300.0, 300.2, 300.1]
    >>> study = study_precision(["a"] * 6, ["ring"] * 6, mm, reference={"ring": [300.0, 300.1, 299.9, 300.0]})
    >>> [(one.requirement, one.verdict) for one in judge_precision(study)]
    [('accuracy', 'pass'), ('repeatability', 'pass')]
    """
    low, high = study.repeatability_interval()
    found = []
    for k, name in enumerate(study.materials):
        bias, half = study.bias[k] / study.reference[k], study.bias_half_width[k] / study.reference[k]
        ends = float(bias - half), float(bias + half)
        found.append(
            PrecisionVerdict(name, "accuracy", float(bias), *ends, accuracy, _verdict(*_size(*ends), accuracy))
        )
        values = (float(v[k] / study.mean[k]) for v in (study.repeatability, low, high))
        value, *ends = values
        verdict = _verdict(*ends, repeatability)
        found.append(PrecisionVerdict(name, "repeatability", value, *ends, repeatability, verdict))
    return tuple(found)


def _size(low: float, high: float) -> tuple[float, float]:
    """Return the interval of the absolute value."""
    if low <= 0.0 <= high:
        return 0.0, max(-low, high)
    return min(abs(low), abs(high)), max(abs(low), abs(high))


def _verdict(low: float, high: float, limit: float) -> str:
    if not np.isfinite([low, high]).all():
        return "not_assessed"
    return "pass" if high <= limit else "fail" if low > limit else "uncertain"
