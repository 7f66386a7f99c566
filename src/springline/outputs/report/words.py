"""Sentences of the report that depend on the survey, so that page and PDF say the same."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from .listings import LISTED

if TYPE_CHECKING:
    from ..results import Results
    from .scales import Scales


_TOGETHER = (
    " Where robot and pipe run was then estimated together with the sections, from rings, odometer, inertial log and "
    "ties, each weighed by its own sigma."
)


@dataclass(frozen=True)
class Words:
    """Sentences by where they stand.

    Attributes:
        wall: Above the maps.
        along: Above the charts.
        circle: The circle that sections are drawn against.
        worst: Above the worst sections.
        features: Below the list of features, or why there is none.
        definitions: Below the comparison of definitions.
        method: How it was measured, a paragraph each.
        end: The last lines.
    """

    wall: str
    along: str
    circle: str
    worst: str
    features: str
    definitions: str
    method: tuple[str, ...]
    end: str


def make_words(
    results: Results, scales: Scales, *, ranked_by: str, gaps: bool, silent: bool, marks: bool, crowded: bool
) -> Words:
    """Return the sentences.

    Args:
        results: The finished survey.
        scales: Printed units.
        ranked_by: What the worst sections are ranked by.
        gaps: Whether some stretch has no values.
        silent: Whether some stations are left out of the lines.
        marks: Whether features are marked on the maps.
        crowded: Whether some of them go without their number.
    """
    feet = results.units == "us"
    kind = str(results.survey.metrics.attrs.get("reference_kind", "none"))
    return Words(
        wall="As seen from inside with travel to the right: the crown (12 h) runs along the middle, the right side "
        "(3 h) above it, the invert (6 h) along both edges. Where several readings share a pixel, the one furthest "
        "from the fitted section is drawn." + _marks(crowded) * marks,
        along="Lines run through the smallest and the largest value of each pixel column, so that no peak is lost."
        + (" Shaded stretches have no section or no readings; nothing is drawn across them." if gaps else "")
        + (
            " Small triangles mark stations unlike their neighbours (joints, misread rings), which lines and largest "
            "values leave out."
            if silent
            else ""
        ),
        circle=f"{kind} circle" if kind != "none" else "circle of the mean diameter",
        worst=f"Ranked by {ranked_by}, each at least two diameters from the next. Drawn as seen looking forward, in "
        "clock hours; under each, how far the readings lie from the fitted section, outward up.",
        features=_features(results),
        definitions="Ovality by a mean M is (largest − M) / M. The diameters X and Y are chords of the fitted section, "
        "horizontal and vertical; its caliper width and height are larger where the section is dented.",
        method=_method(results, scales, kind),
        end="Values at every station stand in stations.csv beside this file, their one-sigma in stations_sigma.csv; "
        "the whole survey in survey.zarr.zip; the wall in three dimensions in viewer.html and pipe.glb."
        + (" Warnings, reasons and settings keep the metric units they were written in." if feet else ""),
    )


def _marks(crowded: bool) -> str:
    some = "; where they crowd, some go without it" if crowded else ""
    return f" Circles, and ticks at both edges for what goes all the way round, are features with their number{some}."


def _features(results: Results) -> str:
    if not results.survey.has("features"):
        return "This inspection did not look for features."
    count = results.survey.features.sizes.get("feature", 0)
    if not count:
        return "None were found."
    left = f"{count - LISTED} more stand in features.csv. " if count > LISTED else ""
    return f"{left}Numbers are those on the maps. Chainage ± 95 %. Depth is positive outward, negative inward."


def _method(results: Results, scales: Scales, kind: str) -> tuple[str, ...]:
    section, rings = results.survey.section.attrs, results.survey.rings.attrs
    about = "the pipe’s axis" if rings.get("referred_to") == "axis" else "the sensor"
    scale, source = section.get("range_scale_sigma"), section.get("range_scale_source")
    known = (
        "" if scale is None else f": one-sigma {float(scale) * 1e2:g} % of the range{f' ({source})' if source else ''}"
    )
    reference = results.metrics_attr("reference_diameter")
    against = (
        f"Deflection is (D − smallest) / D with D = {scales.small.plain(reference)}, the {kind} diameter; the signed "
        "deflections are (X − D) / D and (Y − D) / D. Losses of area and capacity are relative to the circle of D."
        if isfinite(reference)
        else "Deflection and losses need a nominal or base diameter, and none was given."
    )
    return (
        f"{_stations(results, scales)} of {results.bearing.size} readings each, taken about {about}. Readings that are "
        "outliers, water, occluded or out of range are set aside, each with its reason. A section "
        f"({section.get('model', 'ellipse')}) is fitted to the used readings of each station by least orthogonal "
        "distance with robust weights; a station whose readings cannot carry a section gets none, with the reason. "
        "Missing readings are never filled in." + _TOGETHER * results.survey.has("layout"),
        "Diameters are chords of the fitted section through its centre, never the raw largest reading. Intervals are "
        "95 %. The uncertainty of a diameter has two parts: that of the fit, which averages out, and that of the "
        f"sensor’s scale, which does not{known}. Ovality cannot be negative, so noise alone lifts it: near zero read "
        "its interval, not its value.",
        f"{against} Coverage is the share of possible readings that were used; a stretch counts as unseen where it is "
        "under 50 %.",
    )


def _stations(results: Results, scales: Scales) -> str:
    if results.stations == 1:
        return "A single station"
    return f"{results.stations} stations, {scales.small.text(results.spacing, 1)} apart,"
