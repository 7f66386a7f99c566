"""Options of `springline design`, and the design that they make."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, ParameterError
from .quantities import quantity

if TYPE_CHECKING:
    from ..design import LinerDesign


def _option(panel: str, flag: str, metavar: str, text: str) -> typer.models.OptionInfo:
    return typer.Option(flag, metavar=metavar, help=text, rich_help_panel=panel)


def _text(panel: str, flag: str, metavar: str, text: str) -> Any:
    return Annotated[str | None, _option(panel, flag, metavar, text)]


_PIPE, _LINER, _LOADS, _RULE, _MADE = "The pipe", "The liner", "Loads", "The rule", "What is made"

Diameter = _text(_PIPE, "--diameter", "LENGTH", "Mean inside diameter, such as 48in; from the scan when one is given.")
Ovality = _text(_PIPE, "--ovality", "PERCENT", "Ovality q, such as 2%; from the scan when one is given.")
DiameterSigma = _text(_PIPE, "--diameter-sigma", "LENGTH", "One-sigma of the diameter.")
OvalitySigma = _text(_PIPE, "--ovality-sigma", "PERCENT", "One-sigma of the ovality, such as 0.2%.")
Hole = _text(_PIPE, "--hole", "LENGTH", "Largest hole in the wall of a pressure pipe.")
Modulus = _text(_LINER, "--modulus", "PRESSURE", "Long-term flexural modulus E_L, such as 125000psi or 862MPa.")
Strength = _text(_LINER, "--strength", "PRESSURE", "Long-term flexural strength, such as 4500psi or 31MPa.")
ShortModulus = _text(_LINER, "--short-modulus", "PRESSURE", "Initial flexural modulus, for X1.4.")
Tensile = _text(_LINER, "--tensile-strength", "PRESSURE", "Long-term tensile strength, for pressure pipes.")
Pressure = _text(_LOADS, "--pressure", "PRESSURE", "Groundwater at the invert, such as 5.2psi, 36kPa or 12ftH2O.")
Internal = _text(_LOADS, "--internal-pressure", "PRESSURE", "Internal pressure of a pressure pipe.")
SoilModulus = _text(_LOADS, "--soil-modulus", "PRESSURE", "Modulus of soil reaction, fully deteriorated only.")
Cover = _text(_LOADS, "--cover", "LENGTH", "Soil above the crown, fully deteriorated only.")
Water = _text(_LOADS, "--water", "LENGTH", "Water above the crown, fully deteriorated only.")
UnitWeight = _text(_LOADS, "--unit-weight", "WEIGHT", "Unit weight of the soil, such as 120pcf or 19kN/m3.")
LiveLoad = _text(_LOADS, "--live-load", "PRESSURE", "Live load at the pipe, fully deteriorated only.")
Gap = _text(_RULE, "--gap", "LENGTH", "Annular gap, for --method glock.")
Condition = Annotated[str, _option(_RULE, "--condition", "partially|fully", "Deterioration of the host pipe.")]
Method = Annotated[str, _option(_RULE, "--method", "f1216|glock", "Buckling by F1216 X1.1 or, close-fit, after Glock.")]
Edition = Annotated[
    str, _option(_RULE, "--edition", "2007b|before-2007b", "Edition of F1216: C inside the root or out.")
]
Convention = Annotated[str, _option(_RULE, "--convention", "outer|mean", "Which liner diameter X1.1 takes.")]
Constants = Annotated[str, _option(_RULE, "--constants", "inch-pound|si", "Which printed pair of constants to use.")]
Mean = Annotated[
    str, _option(_RULE, "--mean", "axes|polar|area|caliper", "Mean diameter and ovality taken from the scan.")
]
Safety = Annotated[float, _option(_RULE, "--safety", "N", "Factor of safety.")]
Enhancement = Annotated[float, _option(_RULE, "--enhancement", "K", "Enhancement factor.")]
Poisson = Annotated[float, _option(_RULE, "--poisson", "NU", "Poisson's ratio of the liner.")]
RatioLimit = Annotated[float, _option(_RULE, "--ratio-limit", "DR", "Largest dimension ratio; 0 for none.")]
Step = Annotated[str, _option(_MADE, "--step", "LENGTH", "Liners are made in multiples of this thickness.")]
Sizes = _text(_MADE, "--sizes", "LENGTH,...", "Or the thicknesses that are made, such as 4.5mm,6mm,7.5mm.")

_KINDS = {
    "modulus": "pressure",
    "strength": "pressure",
    "short_modulus": "pressure",
    "tensile_strength": "pressure",
    "water_pressure": "pressure",
    "internal_pressure": "pressure",
    "soil_modulus": "pressure",
    "live_load": "pressure",
    "cover": "length",
    "water": "length",
    "hole": "length",
    "gap": "length",
    "unit_weight": "unit weight",
}
_MAY_BE_ZERO = ("water_pressure", "internal_pressure", "live_load", "cover", "water", "hole", "gap")
_FLAGS = {"water_pressure": "--pressure"}
_PLAIN = (
    "condition",
    "method",
    "edition",
    "convention",
    "constants",
    "ratio_limit",
    "mean",
    "safety",
    "enhancement",
    "poisson",
    "diameter",
    "ovality",
    "step",
)
_NAMES = rf"\b({'|'.join((*_KINDS, *_PLAIN))})\b"
_COMPARED, _LISTED = re.compile(rf"{_NAMES}(?= [=<>])"), re.compile(rf"{_NAMES}(?=.*not given)")


def flag_of(name: str) -> str:
    """Return the flag of a number of `LinerDesign`.

    >>> flag_of("soil_modulus"), flag_of("water_pressure")
    ('--soil-modulus', '--pressure')
    """
    return _FLAGS.get(name, "--" + name.replace("_", "-"))


def liner_design(texts: dict[str, str | None], *, ratio_limit: float, **plain: Any) -> LinerDesign:
    """Return the design that the options state.

    Args:
        texts: What was typed for each quantity of `LinerDesign`; None where nothing was.
        ratio_limit: Largest DR, 0 for none.
        plain: Words and numbers without a unit.

    Raises:
        InputError: Something is missing, has no unit or is out of range; the message names the option.
    """
    from ..design import LinerDesign

    for name in ("modulus", "strength", "water_pressure"):
        if texts[name] is None:
            raise InputError("not given", where=flag_of(name), mend=f"add {flag_of(name)} with its unit")
    given = {
        name: quantity(text, _KINDS[name], where=flag_of(name), zero=name in _MAY_BE_ZERO)
        for name, text in texts.items()
        if text is not None
    }
    try:
        return LinerDesign(**given, **plain, ratio_limit=ratio_limit or float("inf"))
    except ParameterError as error:
        raise in_flags(error) from None


def in_flags(error: ParameterError) -> InputError:
    """Return a refusal of the library in the words of the command line: people typed flags, not parameters.

    >>> print(in_flags(ParameterError("soil_modulus, cover not given", expected="ratio_limit > 2")))
    --soil-modulus, --cover not given; expected --ratio-limit > 2
    """

    def say(text: str | None) -> str | None:
        for names in (_COMPARED, _LISTED):
            text = text and names.sub(lambda found: flag_of(found[1]), text)
        return text

    return InputError(say(error.what), where=error.where, expected=say(error.expected), mend=error.mend)
