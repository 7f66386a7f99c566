"""Calibration of a range sensor against references, and how precise a method is found to be by repeating it.

`calibrate_ring` makes the group `/calibration` from scans of a reference ring or pipe of known diameter;
`apply_calibration` corrects a survey by it; `study_precision` is the interlaboratory study of ASTM E691.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..lazy import lazy_names

if TYPE_CHECKING:
    from .apply import apply_calibration, with_calibration
    from .noise import NoiseLaw, fit_noise_law
    from .precision import PrecisionStudy, study_precision
    from .reference import ReferenceFit, fit_reference, reference_shapes
    from .ring import calibrate_ring

_HOMES = {
    "NoiseLaw": "noise",
    "PrecisionStudy": "precision",
    "ReferenceFit": "reference",
    "apply_calibration": "apply",
    "calibrate_ring": "ring",
    "fit_noise_law": "noise",
    "fit_reference": "reference",
    "reference_shapes": "reference",
    "study_precision": "precision",
    "with_calibration": "apply",
}

__all__ = [
    "NoiseLaw",
    "PrecisionStudy",
    "ReferenceFit",
    "apply_calibration",
    "calibrate_ring",
    "fit_noise_law",
    "fit_reference",
    "reference_shapes",
    "study_precision",
    "with_calibration",
]


__getattr__ = lazy_names(__name__, _HOMES)
