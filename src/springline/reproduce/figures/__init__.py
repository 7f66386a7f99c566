"""The dissertation's figures, each made by one function; a chapter's figures are added by a line in `MAKERS`."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from springline.errors import ParameterError, nearest

if TYPE_CHECKING:
    from springline.reproduce.figure import Figure

MAKERS = {
    "2.34": "circles:fits",
    "2.36": "circles:variations",
    "3.4": "severities:limit",
    "3.5": "severities:mode_three",
    "3.7": "severities:mode_four",
    "3.11": "severities:mode_five_mild",
    "3.12": "severities:mode_five_severe",
    "3.14": "severities:area_loss",
    "3.15": "solids:pipes",
    "3.16": "means:ovality_and_factor",
    "3.17": "means:critical_pressure",
    "3.18": "means:thickness",
    "4.1": "offsets:coverage",
    "4.4": "offsets:deformation_offset",
    "4.6": "offsets:pitch_offset",
    "4.8": "bends:tori",
    "4.11": "bends:sharp_alone",
    "4.12": "bends:smooth_alone",
    "4.13": "bends:sharp_together",
    "4.14": "bends:smooth_together",
    "4.15": "bends:verification",
    "5.2": "oblique:extremes",
    "5.4": "oblique:shapes",
    "5.5": "roots:root_sign",
    "5.6": "convergence:wild_guess",
    "5.7": "convergence:close_guess",
    "5.8": "convergence:five_guess",
    "5.11": "scanner:correction",
    "6.1": "edges:operators",
    "6.2": "edges:morphology",
    "6.3": "views:frame_of_pipe",
    "6.4": "views:camera_pose",
    "6.5": "views:lateral_before_camera",
    "6.6": "views:joint_before_camera",
    "6.7": "views:small_laterals",
    "6.8": "views:large_laterals",
    "6.9": "views:projection",
    "6.10": "views:sizes",
    "6.11": "views:joints",
    "6.12": "views:by_intuition",
    "6.15": "criterion:templates",
    "6.16": "criterion:size_errors",
    "6.17": "criterion:large_moved",
    "6.18": "criterion:small_moved",
    "6.19": "criterion:large_turned",
    "6.20": "criterion:small_turned",
    "7.3": "lobes:quasi",
    "7.5": "lobes:chicurel",
    "7.6": "lobes:second_derivatives",
    "7.10": "lobes:angles",
    "7.11": "lobes:depths",
    "7.12": "lobes:powers",
    "7.13": "solids:liners",
}
"""Module and function of each figure, in the order of the text."""


def figure(number: str) -> Figure:
    """Return a figure made again, as SVG, with the text's statements about it checked.

    Args:
        number: As cited in the text, such as "5.6".

    Raises:
        ParameterError: There is no such figure here.

    >>> made = figure("5.7")
    >>> made.svg[:4], [check.holds for check in made.checks]
    ('<svg', [True, True])
    """
    if number not in MAKERS:
        raise ParameterError(
            f"figure {number!r} is not known{nearest(number, MAKERS)}", expected=f"one of {', '.join(MAKERS)}"
        )
    module, function = MAKERS[number].split(":")
    return getattr(import_module(f"{__name__}.{module}"), function)()
