"""Images alone: joints and laterals from frames with lens and distance, without a scan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...errors import InputError
from ...geometry.robot import frame
from ...survey import add_assumption, add_warning
from .filmed import filmed
from .looking import Looking
from .merging import features_of_images
from .places import Place, spaced_joints
from .views import ROLL_SIGMA, Views

if TYPE_CHECKING:
    from ...config import Config
    from ...survey import Survey
    from .filmed import Filmed

_OFFSET = 0.06
_TILT = 0.02


def images_alone(survey: Survey, config: Config) -> Survey:
    """Return the survey with `/features` that its frames show, where nothing was scanned.

    The pipe is taken as round and of its nominal diameter, the robot as driving along its axis, level and straight,
    each within what robots do; chainage is what the counter read, plus how far ahead the camera sits. Every frame is
    looked at, and again those about a place where a joint is missing from an even row.

    Args:
        survey: With `/frames` that have distances, a plain lens in `/calibration` and `nominal_diameter`.
        config: `detect.least_confidence`.

    Raises:
        InputError: One of these is missing; it is named. Or a lens table cannot be used.
        MissingExtraError: OpenCV is not installed.

    Source: dissertation 6.4.
    """
    film, diameter = _needed(survey)
    radius = 0.5 * diameter
    looking = Looking(film.paths, film.folder, film.cameras, _views(film, radius), radius)
    looking.everywhere([])
    places = [
        Place("joint", one.x, 0.0, one.log_odds) for one in looking.sightings() if one.kind == "joint"
    ]  # fmt: skip
    looking.again(spaced_joints(places))
    survey = survey.with_group("features", features_of_images(looking, config.detect.least_confidence))
    survey = add_warning(survey, *looking.left_out(film.usable))
    return add_assumption(
        survey,
        f"Without a scan the pipe is taken as round, {1e3 * diameter:.0f} mm wide, and the camera as driving along its "
        "axis without roll; chainage is what the counter read.",
    )


def _needed(survey: Survey) -> tuple[Filmed, float]:
    """Return the frames and the pipe's diameter; raise when something that is needed is missing."""
    film, where = filmed(survey), str(survey.attrs.get("name", "survey"))
    if film is None:
        missing = "a lens, [lens.NAME] in survey.toml" if survey.has("frames") else "frames"
        raise InputError(f"the survey lacks {missing}", where=where, expected="frames with lens and distance")
    if not np.isfinite(film.distance).any():
        raise InputError(
            "no frame has a distance and a lens", where=where, expected="distance_m and lens in frames.csv"
        )
    diameter = float(survey.attrs.get("nominal_diameter", np.nan))
    if not diameter > 0.0:
        raise InputError("the pipe's diameter is not known", where=where, mend="state it with --nominal")
    return film, diameter


def _views(film: Filmed, radius: float) -> Views:
    """Where the camera was if the robot drove along the axis, level and straight."""
    from ...imaging.reprojection import PosePrior

    count = len(film.paths)
    lever = np.array([camera.position for camera in film.cameras]).reshape(-1, 3)
    eye = lever + np.stack([film.distance, np.zeros(count), np.zeros(count)], axis=-1)
    axes = np.array([camera.axes for camera in film.cameras]).reshape(-1, 3, 3) @ frame(0.0, 0.0, 0.0)
    prior = PosePrior(_OFFSET * radius, _TILT)
    return Views(
        eye[:, 0], film.distance, eye, axes, np.full((count, 2), radius), prior, float(ROLL_SIGMA), None
    )  # fmt: skip
