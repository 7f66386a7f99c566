"""ISYBAU XML, condition data (Zustandsdaten) of pipes: 2006-10, 2013-02 and later editions.

Source: ISYBAU-Austauschformate Abwasser (XML), the published schemas of edition 2013-02 (as of 12/2015).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import FormatError
from ..survey import add_assumption
from .codes import en_kind
from .observations import Inspection, Observed, clock_hours, number, observations_survey
from .trees import child, children, parse, tag, text, to_tree

if TYPE_CHECKING:
    import xml.etree.ElementTree as ET
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

VIDEO = ("Timecode", "Frame", "Videozaehler", "Parameter")
"""Elements of which one refers into the video."""

TEXTS = {
    "InspektionsKode": "code",
    "Charakterisierung1": "characterisation_1",
    "Charakterisierung2": "characterisation_2",
    "Verbindung": "joint",
    "Fotodatei": "photo",
    "Kommentar": "remarks",
}
"""Elements of RZustand whose content is text, with their names in `/observations`."""

DIRECTIONS = {"O": "downstream", "U": "upstream"}
HEADER = {
    "node_from": "KnotenZulauf",
    "node_to": "KnotenAblauf",
    "height_mm": "Profilhoehe",
    "width_mm": "Profilbreite",
    "material": "Material",
}
"""Elements of RGrunddaten by common word."""

_QUANTITIES = ("Quantifizierung1", "Quantifizierung2")
_PLACED = ("Station", "PositionVon", "PositionBis", "Streckenschaden", "StreckenschadenLfdNr")


def read_isybau(path: Path, options: ReadOptions) -> Survey:
    """Read the inspections of pipes in an ISYBAU file into `/observations`; all else is carried.

    Raises:
        FormatError: It is not ISYBAU, holds no inspected pipe, or a number cannot be read.
    """
    root = parse(path)
    if tag(root) != "Identifikation":
        raise FormatError(f"the root is '{tag(root)}'", where=path, expected="Identifikation")
    found: list[Inspection] = []
    others = 0
    for collective in children(child(root, "Datenkollektive"), "Zustandsdatenkollektiv"):
        for asset in children(collective, "InspizierteAbwassertechnischeAnlage"):
            if _pipe(asset) is None:
                others += 1
            else:
                found.append(_inspection(asset, path, len(found) + 1))
    layout = {"namespace": root.tag[1:].partition("}")[0] if "}" in root.tag else "", "tree": to_tree(root, _is_pipe)}
    survey = observations_survey(found, path, format="isybau", layout=layout)
    if others:
        survey = add_assumption(survey, f"{others} inspected manholes or structures in the file are carried unread.")
    return survey


def _pipe(asset: ET.Element) -> ET.Element | None:
    visual = child(asset, "OptischeInspektion")
    return None if visual is None else child(visual, "Rohrleitung")


def _is_pipe(element: ET.Element) -> bool:
    return tag(element) == "InspizierteAbwassertechnischeAnlage" and _pipe(element) is not None


def _inspection(asset: ET.Element, path: Path, row: int) -> Inspection:
    visual = child(asset, "OptischeInspektion")
    pipe = _pipe(asset)
    ground = child(pipe, "RGrunddaten")
    common = {
        "name": text(asset, "Objektbezeichnung"),
        "date": text(visual, "Inspektionsdatum"),
        "time": text(visual, "Uhrzeit"),
        "operator": text(visual, "NameUntersucher"),
        "direction": DIRECTIONS.get(text(pipe, "Inspektionsrichtung"), ""),
        "length_m": text(pipe, "Inspektionslaenge"),
        **{word: text(ground, element) for word, element in HEADER.items()},
    }
    states = children(child(pipe, "Inspektionsdaten"), "RZustand")
    return Inspection(
        {word: value for word, value in common.items() if value},
        {"tree": to_tree(asset, lambda one: tag(one) == "Inspektionsdaten")},
        [_observed(one, f"{path}, inspection {row}, RZustand {k}") for k, one in enumerate(states, 1)],
    )


def _observed(state: ET.Element, place: str) -> Observed:
    texts = {name: text(state, element) for element, name in TEXTS.items()}
    fields: dict[str, Any] = {}
    for element in VIDEO:
        if child(state, element) is not None:
            texts["video"], fields["video"] = text(state, element), element
    for k, element in enumerate(_QUANTITIES, 1):
        kind = next((form for form in ("Numerisch", "Text") if child(state, element + form) is not None), None)
        if kind:
            texts[f"quantification_{k}"], fields[element] = text(state, element + kind), kind
    texts["continuous"] = text(state, "Streckenschaden") + text(state, "StreckenschadenLfdNr")
    texts["kind"] = en_kind(texts["code"], texts["remarks"])
    known = {*TEXTS, *VIDEO, *_PLACED, *(q + form for q in _QUANTITIES for form in ("Numerisch", "Text"))}
    fields["more"] = [to_tree(one) for one in state if tag(one) not in known]
    return Observed(
        number(text(state, "Station"), f"{place}, Station"),
        clock_hours(text(state, "PositionVon"), f"{place}, PositionVon"),
        clock_hours(text(state, "PositionBis"), f"{place}, PositionBis"),
        texts,
        fields,
    )
