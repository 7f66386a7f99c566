"""Settings of an inspection: every one defaulted, read from TOML, saved as resolved beside the results."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

import tomli_w
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from .errors import InputError, nearest

Positive = Annotated[float, Field(gt=0)]
Fraction = Annotated[float, Field(ge=0, le=1)]


class _Settings(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class ScaleSigma(_Settings):
    """Relative one-sigma of a range sensor's scale by kind of sensor, used until a calibration replaces it.

    Ring lasers: makers of sewer profilers state 0.5 % accuracy of the diameter (the bar of FDOT 430), read as a 95 %
    bound. Stereo depth cameras: 2 % at 2 m stated as an upper bound; inside pipes, under half a metre, the built-in
    baseline error leaves about 0.7 %. Lidar: millimetres on a radius of decimetres.
    """

    ring_laser: Fraction = 0.0025
    depth_camera: Fraction = 0.007
    lidar: Fraction = 0.003
    unknown: Fraction = 0.005

    def of(self, kind: str) -> float:
        """Return the sigma for one of `conventions.SENSOR_KINDS`."""
        return getattr(self, kind.replace("-", "_"))


class SensorConfig(_Settings):
    """The range sensor."""

    scale_sigma: ScaleSigma = ScaleSigma()
    range_noise: Annotated[float | None, Field(ge=0)] = None
    """One-sigma of a reading [m]; estimated from the rings when not given."""
    counter_scale_sigma: Fraction = 0.005
    """Relative one-sigma of the odometer or cable counter, where nothing measures it: 1 % read as a 95 % bound."""
    baseline_sigma: Positive = 1e-3
    """One-sigma of the direction between two scanners on one robot [rad], where the survey does not state it: that of
    mounts which hold their places to 0.3 mm over 0.4 m."""


class RingsConfig(_Settings):
    """Slicing of clouds into rings."""

    spacing: Positive | None = None
    """Distance between stations [m]; a twentieth of the diameter when not given."""
    bearings: Annotated[int, Field(ge=24, le=3600)] = 360
    """Readings per ring."""


class CleanConfig(_Settings):
    """Which readings are used."""

    outlier_sigma: Positive = 4.0
    """A reading further than this many robust sigmas from its ring's section is an outlier."""
    range_limits: tuple[Fraction, Positive] = (0.5, 1.6)
    """Readings outside these multiples of the typical radius are out of range."""
    water: Literal["auto", "none"] = "auto"
    """Whether flat returns at the invert are taken for water or sediment."""


class EstimateConfig(_Settings):
    """Pose, section and layout."""

    method: Literal["auto", "rings", "joint"] = "auto"
    """Ring by ring, or robot, section and layout jointly; auto is jointly where there is an inertial log."""
    minimum_coverage: Fraction = 0.25
    """Stations with less coverage get no section."""
    largest_gap: Annotated[float, Field(gt=0, le=6.2831853)] = 2.36
    """Stations with a longer arc unseen in one piece [rad] get no section: 135 degrees, beyond which an ellipse
    follows the errors of the readings at the ends of the arc."""


class LinerConfig(_Settings):
    """Lobes of a liner."""

    fit: bool = False
    """Whether lobes are looked for: only the user knows that there is a liner."""
    kind: Literal["proposed", "smooth"] = "proposed"
    """The published lobe with varying amplitude, or the recommended one that never leaves its host."""
    power: Positive | None = None
    """Its power; 2 for the published lobe and 3 for the smooth one when not given."""
    free_power: bool = False
    """Whether the power is fitted too."""
    false_alarm: Annotated[float, Field(gt=0, lt=1)] = 1e-4
    """How often a station without a lobe may be said to show one."""


class DetectConfig(_Settings):
    """What rings show that is not plain wall."""

    false_alarm: Annotated[float, Field(gt=0, lt=1)] = 0.01
    """How many bumps and how many closed joints a survey may show by chance."""
    least_depth: Fraction = 0.005
    """Bumps shallower than this share of the diameter are left out."""
    least_confidence: Fraction = 0.5
    """Features less probable than this are left out."""
    every_frame: bool = False
    """Look at every frame, not only at those in which geometry proposes something."""


class TextureConfig(_Settings):
    """Frames laid on the wall."""

    lay: bool = True
    """Whether they are, where the survey has frames, their lens and their distance."""
    cell: Positive = 0.002
    """Length and width of a cell [m]; larger where a long pipe would have more than eight million."""


class MetricsConfig(_Settings):
    """Diameters and what they refer to."""

    reference: Literal["auto", "base", "nominal"] = "auto"
    """Dref of deflection and losses: the base diameter when known, else the nominal one, unless stated."""


class OutputsConfig(_Settings):
    """What people read."""

    units: Literal["si", "us"] = "si"
    """Metric units, or inches and feet in report and tables."""


class Config(_Settings):
    """All settings of an inspection."""

    sensor: SensorConfig = SensorConfig()
    rings: RingsConfig = RingsConfig()
    clean: CleanConfig = CleanConfig()
    estimate: EstimateConfig = EstimateConfig()
    detect: DetectConfig = DetectConfig()
    liner: LinerConfig = LinerConfig()
    metrics: MetricsConfig = MetricsConfig()
    texture: TextureConfig = TextureConfig()
    outputs: OutputsConfig = OutputsConfig()


def load_config(path: str | Path) -> Config:
    """Read settings from a TOML file.

    Args:
        path: The file; sections and keys are those of `Config`, all optional.

    Raises:
        InputError: The file is missing, is not TOML, or holds an unknown key or a value out of range; the message
            names the key and, for unknown keys, the nearest known one.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError("no such file", where=path, mend="check the path given to --config")
    try:
        return make_config(tomllib.loads(path.read_text(encoding="utf-8")), where=str(path))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"not a TOML file: {error}", where=path, expected="settings in TOML") from None


def make_config(values: dict[str, Any], *, where: str = "config") -> Config:
    """Return settings from nested dictionaries, the rest defaulted.

    >>> make_config({"rings": {"spacing": 0.01}}).rings.spacing
    0.01
    >>> make_config({"rings": {"spacin": 0.01}})
    Traceback (most recent call last):
    springline.errors.InputError: config, rings.spacin: unknown setting, did you mean 'spacing'?

    Raises:
        InputError: An unknown key or a value out of range.
    """
    try:
        return Config.model_validate(values)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        if first["type"] == "extra_forbidden":
            siblings = _known_keys(first["loc"][:-1])
            raise InputError(
                f"unknown setting{nearest(str(first['loc'][-1]), siblings)}", where=f"{where}, {place}"
            ) from None
        raise InputError(f"{first['msg']}, got {first['input']!r}", where=f"{where}, {place}") from None


def _known_keys(location: tuple[int | str, ...]) -> list[str]:
    model: Any = Config
    for part in location:
        model = model.model_fields[str(part)].annotation
    return list(model.model_fields)


def dump_config(config: Config) -> str:
    """Return the settings as TOML; settings that are None are left out.

    >>> "outlier_sigma = 4.0" in dump_config(Config())
    True
    """
    return tomli_w.dumps(config.model_dump(mode="json", exclude_none=True))
