"""The whole chain, readable on one screen: source groups in, result groups added stage by stage."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from . import __version__
from .calibration import apply_calibration
from .config import Config, make_config
from .design import judge, load_rule
from .errors import InputError, ParameterError
from .stages.clean import clean
from .stages.design_line import design_line
from .stages.detect import detect
from .stages.estimate import estimate
from .stages.facing import facing
from .stages.features import features
from .stages.images import images, texture
from .stages.liner import liner
from .stages.metrics import metrics
from .stages.overrides import corrections, masks
from .stages.passes import joined
from .stages.ring_video import ring_video
from .stages.rings import rings
from .stages.turning import out_and_back
from .survey import Survey, add_provenance, add_run, add_warning, validate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

STAGES = (rings, clean, masks, detect, estimate, liner, metrics, features, images, texture, corrections, design_line)
"""The stages in the order in which they run; each takes a survey and its settings and adds its groups."""

_ONE_PASS = (
    "An earlier inspection joined a back pass; it is not in this survey: section and centreline are now of the out "
    "pass alone. Give the back pass again, or inspect the original run."
)


def inspect(
    survey: Survey,
    config: Config | Mapping[str, Any] | None = None,
    *,
    back: Survey | None = None,
    checks: Iterable[str] = (),
    progress: Callable[[str, float], None] | None = None,
) -> Survey:
    """Run the whole chain on a survey.

    Args:
        survey: As `springline.read` returns it; results of an earlier run are left aside and made anew.
        config: Settings, or nested dictionaries of them; the defaults when not given.
        back: The same pipe driven from its other end; section and centreline are then of both passes. A survey
            whose counter comes back is parted into two passes by itself.
        checks: Names of acceptance rules to judge; their verdicts stand in the attribute `rules`.
        progress: Called with a stage's name and the share of the chain done, from 0 to 1.

    Returns:
        The survey with `/rings`, `/mask`, `/candidates`, `/pose`, `/section`, `/metrics` and `/features`, and with
        warnings and assumptions in its attributes.

    Raises:
        ParameterError: A rule is unknown, or an argument is no survey or no settings.
        ContractError: The survey does not follow the data contract.
        InputError: It holds nothing that can be inspected; the message says why.

    >>> import springline as sl
    >>> result = sl.inspect(sl.read(sl.builtin_survey()))
    >>> result.has("metrics")
    True
    """
    config, rules = _settings(config), [load_rule(name) for name in checks]
    apart, again = back is not None, _survey(survey, "survey").has("passes")
    survey = validate(survey.source())
    read = survey.assumptions
    if back is None:
        survey, back = out_and_back(survey)
    passes = [one for one in survey.assumptions if one not in read]
    survey = add_run(survey, version=__version__, config=config.model_dump(mode="json"))
    survey = _measurable(facing(apply_calibration(ring_video(survey, config))))
    known = [one for one in survey.assumptions if one not in passes]
    if again and back is None:
        survey = add_warning(survey, _ONE_PASS)
    for done, stage in enumerate(STAGES):
        if progress:
            progress(stage.__name__, done / len(STAGES))
        survey = stage(survey, config)
        if stage is estimate and back is not None:
            survey = _joined(survey, back, config, apart=apart)
    if rules:
        survey = judge(survey, rules)
    if progress:
        progress("done", 1.0)
    return add_provenance(survey, concluded=[one for one in survey.assumptions if one not in known] or None)


def _settings(config: Config | Mapping[str, Any] | None) -> Config:
    if config is None or isinstance(config, Config):
        return config or Config()
    if isinstance(config, Mapping):
        return make_config(dict(config))
    raise ParameterError(
        f"{config!r} is no settings",
        where="config",
        expected="a Config or nested dictionaries",
        mend="a TOML file is read by springline.config.load_config",
    )


def _survey(given: Survey, name: str) -> Survey:
    if isinstance(given, Survey):
        return given
    raise ParameterError(
        f"{given!r} is no survey", where=name, expected="a Survey", mend="a file is read by springline.read"
    )


def _joined(survey: Survey, back: Survey, config: Config, *, apart: bool) -> Survey:
    """Return both passes as one; a way back in the same run that cannot be joined is left aside, and said."""
    try:
        return joined(survey, _estimated(back, config))
    except InputError as error:
        if apart:
            raise
        return add_warning(survey, f"The way back was left aside: {error}")


def _estimated(survey: Survey, config: Config) -> Survey:
    """Return the back pass as far as it is needed."""
    survey = ring_video(validate(_survey(survey, "back").source(), where="the back pass"), config)
    survey = _measurable(facing(apply_calibration(survey)))
    for stage in STAGES[: STAGES.index(estimate) + 1]:
        survey = stage(survey, config)
    return survey


def _measurable(survey: Survey) -> Survey:
    """Return a survey that holds rings or points; refuse one that holds what people coded, and nothing measured."""
    if survey.has("rings") or survey.has("points"):
        return survey
    held = ", ".join(f"/{name}" for name in survey.groups) or "nothing"
    raise InputError(
        f"there is no scan to inspect: the survey holds {held}",
        where=str(survey.attrs.get("name", "survey")),
        expected="rings or points",
        mend="frames alone are looked at by `springline detect`" if survey.has("frames") else None,
    )
