"""Circles and ellipses through noisy readings: batched over rings, robust, each estimate with its covariance.

The kernels are compiled when first called and kept on disk.
"""

from springline.geometry.fitting.circles import fit_circle, fit_circles, fit_circles_to_ranges
from springline.geometry.fitting.ellipses import fit_ellipse, fit_ellipses, fit_ellipses_to_ranges
from springline.geometry.fitting.options import SHORTEST_ARC, FitOptions
from springline.geometry.fitting.results import CircleFit, CircleFits, EllipseFit, EllipseFits

__all__ = [
    "SHORTEST_ARC",
    "CircleFit",
    "CircleFits",
    "EllipseFit",
    "EllipseFits",
    "FitOptions",
    "fit_circle",
    "fit_circles",
    "fit_circles_to_ranges",
    "fit_ellipse",
    "fit_ellipses",
    "fit_ellipses_to_ranges",
]
