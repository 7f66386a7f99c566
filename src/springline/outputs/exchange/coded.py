"""What a survey has to say in codes: the features that an inspection found, or the observations that were read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...conventions import clock_from_bearing
from ...errors import InputError
from ...io.codes import EN_CODES, EN_REMARK, PACP_REMARK, REMARK
from ...io.observations import Inspection, Observed, inspections_of, plain
from ..results import Results, text

if TYPE_CHECKING:
    from ...survey import Survey

_SYSTEMS = {"pacp": "pacp", "en13508": "en", "isybau": "en", "m150": "en"}


def inspections(survey: Survey, format: str) -> list[Inspection]:  # noqa: A002
    """Return the inspections to write: the survey's own features where it has been inspected, else what was read.

    Args:
        survey: With results, or with `/observations`.
        format: Key of the format to write: pacp, en13508, isybau or m150.

    Raises:
        InputError: It holds neither, or observations in codes of another system, which have no agreed counterpart.
    """
    if survey.has("section"):
        return [_found(survey, _SYSTEMS[format])]
    if not survey.has("observations"):
        raise InputError(
            "the survey has neither results nor observations",
            where=str(survey.attrs.get("name", "survey")),
            mend="run springline.inspect on it first",
        )
    source = str(survey.observations.attrs.get("format", ""))
    if _SYSTEMS.get(source) != _SYSTEMS[format]:
        raise InputError(
            f"the observations are coded as {source} has them, which {format} has no agreed counterparts for",
            where=str(survey.attrs.get("name", "survey")),
            expected=" or ".join(k for k, v in _SYSTEMS.items() if v == _SYSTEMS.get(source)),
        )
    found = inspections_of(survey)
    if source != format:
        # Formats have lists of materials of their own, without agreed counterparts.
        for one in found:
            one.common.pop("material", None)
    return found


def is_own(survey: Survey, format: str) -> bool:  # noqa: A002
    """Whether what is written was read from the same format, so that its own header and layout can be used."""
    return not survey.has("section") and survey.observations.attrs.get("format") == format


def _found(survey: Survey, system: str) -> Inspection:
    """Return the inspection that a laser survey was, from its start to its end, with its features."""
    results = Results(survey)
    attrs = survey.attrs
    height, width = (1e3 * results.judged(name) for name in ("diameter_y", "diameter_x"))
    common = {
        "name": str(attrs.get("name") or ""),
        "date": str(attrs.get("date") or "")[:10],
        "operator": str(attrs.get("operator") or ""),
        "direction": str(attrs.get("direction") or ""),
        "height_mm": _mean(height),
        "width_mm": _mean(width),
        "length_m": f"{results.length:.2f}",
    }
    start, end = results.chainage[0], results.chainage[-1]
    first, last = ("BCD", "BCE") if system == "en" else ("AMH", "AMH")
    observed = [Observed(round(float(start), 3), texts={"code": first}), *_features(survey, system)]
    observed.append(Observed(round(float(end), 3), texts={"code": last}))
    return Inspection({word: value for word, value in common.items() if value}, {}, observed)


def _mean(values: np.ndarray) -> str:
    return f"{np.nanmean(values):.0f}" if np.isfinite(values).any() else ""


def _features(survey: Survey, system: str) -> list[Observed]:
    if not survey.has("features"):
        return []
    data = survey.features
    count = data.sizes["feature"]

    def column(name: str) -> np.ndarray:
        return data[name].values.astype(float) if name in data else np.full(count, np.nan)

    reference = Results(survey).circle_diameter
    clock = clock_from_bearing(column("bearing"))
    sizes = {name: column(name) for name in ("size", "length", "depth", "confidence")}
    kinds, images = text(data, "kind", count), text(data, "image", count)
    found = []
    for k in np.argsort(column("chainage"), kind="stable").tolist():
        numbers = {name: float(values[k]) for name, values in sizes.items()}
        texts = {"kind": kinds[k], "photo": images[k], "remarks": _remark(kinds[k], numbers)}
        texts |= _coded(kinds[k], numbers, reference, system)
        found.append(Observed(round(float(column("chainage")[k]), 3), _whole(float(clock[k])), texts=texts))
    return found


def _whole(hours: float) -> float:
    """Return a clock position in whole hours, as every coded format has it."""
    return float(round(hours) or 12) if np.isfinite(hours) else hours


def _coded(kind: str, numbers: dict[str, float], diameter: float, system: str) -> dict[str, str]:
    """Return code and quantification; a kind without a code of its own becomes a general remark."""
    if system == "pacp":
        return {"code": PACP_REMARK}
    code = EN_CODES.get(kind, EN_REMARK)
    quantity = np.nan
    if code == "BCA":
        quantity = round(1e3 * numbers["size"]) if np.isfinite(numbers["size"]) else np.nan
    elif code in ("BBC", "BAA"):
        quantity = round(1e2 * abs(numbers["depth"]) / diameter, 1)
    return {"code": code, "quantification_1": plain(quantity, 2)}


def _remark(kind: str, numbers: dict[str, Any]) -> str:
    said = [
        f"{name} {1e3 * numbers[name]:.1f} mm" for name in ("size", "length", "depth") if np.isfinite(numbers[name])
    ]
    if np.isfinite(numbers["confidence"]):
        said.append(f"confidence {numbers['confidence']:.2f}")
    return ", ".join([f"{REMARK}{kind}", *said])
