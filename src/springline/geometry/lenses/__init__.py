"""Camera lenses (2.7): five models and the polynomial fisheye, their inverses, and fits to calibration pairs.

Angles in radians from the optical axis; image radii in pixels from the image centre.
"""

from __future__ import annotations

from springline.geometry.lenses.boards import BoardFit, fit_boards
from springline.geometry.lenses.fit import fit_lens
from springline.geometry.lenses.joints import fit_joints
from springline.geometry.lenses.lens import LENS_MODELS, Lens
from springline.geometry.lenses.models import (
    MODELS,
    image_radius,
    image_slope,
    model_range,
    scale_of_view_angle,
    zenith_of_radius,
)
from springline.geometry.lenses.polynomial import (
    polynomial_limit,
    polynomial_radius,
    polynomial_slope,
    polynomial_zenith,
)
from springline.geometry.lenses.results import LensCandidate, LensFit

__all__ = [
    "LENS_MODELS",
    "MODELS",
    "BoardFit",
    "Lens",
    "LensCandidate",
    "LensFit",
    "fit_boards",
    "fit_joints",
    "fit_lens",
    "image_radius",
    "image_slope",
    "model_range",
    "polynomial_limit",
    "polynomial_radius",
    "polynomial_slope",
    "polynomial_zenith",
    "scale_of_view_angle",
    "zenith_of_radius",
]
