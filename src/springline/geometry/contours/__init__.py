"""Closed contours (2.9.2, 6.6): sampling, Fourier transform and descriptors, distances between shapes.

Contours are arrays (..., n, 2) of z and y; complex curves (..., n) are z + i y.
"""

from __future__ import annotations

from springline.geometry.contours.curves import from_complex, orient, resample, signed_area, to_complex
from springline.geometry.contours.distances import (
    elliptic_descriptors,
    elliptic_distance,
    fourier_distance,
    procrustes_distance,
)
from springline.geometry.contours.fourier import (
    descriptor_norm,
    dft,
    inverse_dft,
    kept_frequencies,
    norm_difference,
    normalised_magnitudes,
    reversed_dft,
    shifted_dft,
    unit_descriptors,
)

__all__ = [
    "descriptor_norm",
    "dft",
    "elliptic_descriptors",
    "elliptic_distance",
    "fourier_distance",
    "from_complex",
    "inverse_dft",
    "kept_frequencies",
    "norm_difference",
    "normalised_magnitudes",
    "orient",
    "procrustes_distance",
    "resample",
    "reversed_dft",
    "shifted_dft",
    "signed_area",
    "to_complex",
    "unit_descriptors",
]
