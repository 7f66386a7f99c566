"""The stage itself: frames confirm, refine, reject or add to what rings show."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import MissingExtraError
from ...survey import add_assumption, add_warning
from .filmed import filmed
from .looking import Looking
from .merging import with_candidates, with_features
from .places import places_of
from .views import views_of

if TYPE_CHECKING:
    from ...config import Config
    from ...survey import Survey


def images(survey: Survey, config: Config) -> Survey:
    """Return the survey with what its frames show added to `/candidates` and `/features`.

    Rings propose places, and so does the regular spacing of joints; frames are chosen jointly so that few serve all,
    and what stays in doubt gets another (6.5). Each frame speaks for or against the places that it sees. What rings
    and images both show is one feature with the source `both`; what images show and rings do not stands with the
    source `images`; what rings alone suspected and images do not show is left out when it falls below
    `detect.least_confidence`. A frame that cannot be used is named in a warning.

    Args:
        survey: With `/candidates`, `/features`, `/section` and `/pose`; unchanged without `/frames` or a lens.
        config: `detect.least_confidence`, `detect.every_frame`.

    Raises:
        InputError: A lens table cannot be used.

    Source: dissertation 6.4 and 6.5.
    """
    film, radius = filmed(survey), _radius(survey)
    if film is None or not film.usable.any() or not survey.has("features") or not np.isfinite(radius):
        return survey
    views = views_of(survey, film.distance, film.cameras)
    places = places_of(survey, radius)
    looking = Looking(film.paths, film.folder, film.cameras, views, radius)
    try:
        if config.detect.every_frame:
            looking.everywhere(places)
        else:
            looking.at_places(places)
    except MissingExtraError as missing:
        return add_warning(survey, f"The frames were not looked at: {missing}")
    survey = _told(survey, looking, film.usable)
    seen = looking.sightings()
    survey = survey.corrected("candidates", with_candidates(survey, seen, film.paths))
    least = config.detect.least_confidence
    return survey.corrected("features", with_features(survey, places, seen, looking, least))


def _radius(survey: Survey) -> float:
    """The pipe's usual radius; NaN where no station has one."""
    width = 0.5 * (survey.metrics["diameter_x"].values + survey.metrics["diameter_y"].values)
    width = width[np.isfinite(width)]
    return 0.5 * float(np.median(width)) if len(width) else np.nan


def _told(survey: Survey, looking: Looking, usable: np.ndarray) -> Survey:
    """The survey with what was left out and what was assumed."""
    survey = add_warning(survey, *looking.left_out(usable))
    if looking.looked:
        survey = add_assumption(
            survey,
            f"{len(looking.looked)} of {int(usable.sum())} frames were looked at, where geometry proposes something.",
        )
    if looking.looked and looking.views.level is not None:
        survey = add_assumption(
            survey, "Roll, for camera and features, is that by which water or sediment at the invert lies level."
        )
    return survey
