"""Circles and ellipses through noisy readings: batched over rings, robust, each estimate with its covariance.

The kernels are compiled when first called and kept on disk.
"""

from springline.geometry.fitting.boundary import amplitude_interval
from springline.geometry.fitting.circles import fit_circle, fit_circles, fit_circles_to_ranges
from springline.geometry.fitting.conics import (
    CircleShape,
    EllipseShape,
    circle_from_coefficients,
    conic_to_ellipse,
    ellipse_to_conic,
)
from springline.geometry.fitting.ellipses import fit_ellipse, fit_ellipses, fit_ellipses_to_ranges
from springline.geometry.fitting.options import SHORTEST_ARC, FitOptions
from springline.geometry.fitting.results import CircleFit, CircleFits, EllipseFit, EllipseFits

__all__ = [
    "SHORTEST_ARC",
    "CircleFit",
    "CircleFits",
    "CircleShape",
    "EllipseFit",
    "EllipseFits",
    "EllipseShape",
    "FitOptions",
    "amplitude_interval",
    "circle_from_coefficients",
    "conic_to_ellipse",
    "ellipse_to_conic",
    "fit_circle",
    "fit_circles",
    "fit_circles_to_ranges",
    "fit_ellipse",
    "fit_ellipses",
    "fit_ellipses_to_ranges",
]
