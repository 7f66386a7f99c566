"""ISYBAU XML, condition data of pipes: edition 2013-02, or 2006-10.

The order of elements, their lengths and digits follow the published schemas of 2013-02 (as of 12/2015). These have no
branch for measured profiles, which came with a later edition; `RGrunddaten`, where the height and width stand, asks for
both nodes, so that it is written when they are known.
"""

from __future__ import annotations

import json
import xml.etree.ElementTree as ET
from datetime import date
from typing import TYPE_CHECKING

import numpy as np

from ... import __version__
from ...errors import InputError
from ...io.isybau import DIRECTIONS, HEADER, TEXTS
from ...io.trees import clean, document, to_element
from .coded import inspections, is_own

if TYPE_CHECKING:
    from pathlib import Path

    from ...io.observations import Inspection, Observed
    from ...survey import Survey

NAMESPACE = "http://www.ofd-hannover.la/Identifikation"
_EDITIONS = {"2006-10": {"rules": "2", "codes": "2"}, "2013-02": {"rules": "5", "codes": "10"}}
_LONGEST = 999.99
_KEY = "1"
# EN 13508-2 and M 150 say A at a joint, PACP and ISYBAU whether it is one.
_JOINT = {"a": "1", "1": "1", "true": "1", "0": "0", "false": "0"}
_LARGEST = 9999.99
_LATER = ("Parameter", "Gruppe", "Index")
_COLLECTIVE = "ZUS01"


def write_isybau(survey: Survey, path: Path) -> None:
    """Write observations, or the features of an inspection, as ISYBAU XML 2013-02.

    Stations have two decimals and lie under 1000 m, clock positions are whole hours, texts are cut where the schema
    limits them. Without a video its reference is an empty `Parameter`.

    Raises:
        InputError: There is nothing to write, it is coded by another system, or the pipe is too long for the format.
    """
    _write(survey, path, "2013-02")


def write_isybau_2006(survey: Survey, path: Path) -> None:
    """Write the same as ISYBAU XML 2006-10, where the reference into the video is `Timecode`, zero without one.

    Raises:
        InputError: As `write_isybau`.
    """
    _write(survey, path, "2006-10")


def _write(survey: Survey, path: Path, edition: str) -> None:
    found = inspections(survey, "isybau")
    _check(found, path)
    layout = json.loads(survey.observations.attrs["layout"]) if is_own(survey, "isybau") else {}
    # A later edition's file written as 2006-10 is made anew: what is carried may not stand in that edition.
    if layout and (edition != "2006-10" or ["Version", edition] in layout["tree"][1]):
        written = iter(found)
        root = to_element(layout["tree"], lambda _: _own_asset(one, edition) if (one := next(written, None)) else None)
        root.set("xmlns", layout["namespace"] or NAMESPACE)
    else:
        root = _document(found, edition)
    path.write_bytes(document(root))


def _check(found: list[Inspection], path: Path) -> None:
    for one in found:
        longest = max((seen.distance for seen in one.observed), default=0.0)
        if longest > _LONGEST:
            raise InputError(
                f"ISYBAU has no stations beyond {_LONGEST} m, and one lies at {longest:.2f} m",
                where=path,
                mend="write it as .m150.xml or .en13508.txt",
            )


def _own_asset(one: Inspection, edition: str) -> ET.Element:
    return to_element(one.own["tree"], lambda _: _states(one.observed, edition))


def _leaf(parent: ET.Element, name: str, value: str, longest: int | None = None) -> None:
    """Add a leaf when it has a value; white space as the schema's token has it."""
    value = " ".join(clean(value).split())[:longest]
    if value:
        ET.SubElement(parent, name).text = value


def _document(found: list[Inspection], edition: str) -> ET.Element:
    today = date.today().isoformat()
    name = found[0].common.get("name") or "pipe"
    root = ET.Element("Identifikation", {"xmlns": NAMESPACE})
    _leaf(root, "Version", edition)
    estate = ET.SubElement(ET.SubElement(root, "Admindaten"), "Liegenschaft")
    _leaf(estate, "Liegenschaftsnummer", "0", 20)
    _leaf(estate, "Liegenschaftsbezeichnung", name, 40)
    data = ET.SubElement(root, "Datenkollektive")
    _leaf(data, "Datenstatus", "1")
    _leaf(data, "Erstellungsdatum", today)
    collective = ET.SubElement(ET.SubElement(data, "Kennungen"), "Kollektiv")
    _leaf(collective, "Kennung", _COLLECTIVE)
    _leaf(collective, "Kollektivart", "2")
    holds = ET.SubElement(ET.SubElement(collective, "Kollektiveigenschaft"), "Zustandsdaten")
    for part, there in (("Inspektion", "1"), ("Dichtheit", "0"), ("Film", "0")):
        _leaf(holds, part, there)
    _leaf(collective, "Regelwerk", _EDITIONS[edition]["rules"])
    _leaf(collective, "Bearbeitungsstand", today)
    states = ET.SubElement(data, "Zustandsdatenkollektiv")
    _leaf(states, "Kennung", _COLLECTIVE)
    _leaf(states, "Beschreibung", name, 100)
    order = ET.SubElement(ET.SubElement(states, "Auftraege"), "Auftrag")
    _leaf(order, "Auftragsbezeichnung", name, 60)
    _leaf(order, "Auftragskennung", _KEY)
    _leaf(order, "Auftragsart", "1")
    _leaf(order, "Kodiersystem", _EDITIONS[edition]["codes"])
    _leaf(order, "Systemname", "Springline")
    _leaf(order, "Version", __version__, 10)
    states.extend(_asset(one, edition) for one in found)
    return root


def _asset(one: Inspection, edition: str) -> ET.Element:
    asset = ET.Element("InspizierteAbwassertechnischeAnlage")
    _leaf(asset, "Objektbezeichnung", one.common.get("name") or "pipe", 30)
    _leaf(asset, "Anlagentyp", "1")
    visual = ET.SubElement(asset, "OptischeInspektion")
    _leaf(visual, "Auftragskennung", _KEY)
    _leaf(visual, "Inspektionsdatum", one.common.get("date", ""))
    _leaf(visual, "NameUntersucher", one.common.get("operator", ""), 40)
    _leaf(visual, "Uhrzeit", _time(one.common.get("time", "")))
    pipe = ET.SubElement(visual, "Rohrleitung")
    _leaf(pipe, "Rohrleitungstyp", "0")
    codes = {said: letter for letter, said in DIRECTIONS.items()}
    _leaf(pipe, "Inspektionsrichtung", codes.get(one.common.get("direction", ""), "O"))
    length = float(one.common.get("length_m") or "nan")
    _leaf(pipe, "Inspektionslaenge", f"{length:.2f}" if 0 <= length <= _LONGEST else "")
    _ground(pipe, one)
    pipe.append(_states(one.observed, edition))
    return asset


def _ground(pipe: ET.Element, one: Inspection) -> None:
    """Add what is known of the pipe; the schema wants both nodes, so that without them there is no such element."""
    if not (one.common.get("node_from") and one.common.get("node_to")):
        return
    ground = ET.SubElement(pipe, "RGrunddaten")
    for word, kind in (("node_from", "KnotenZulaufTyp"), ("node_to", "KnotenAblaufTyp")):
        _leaf(ground, HEADER[word], one.common[word], 30)
        _leaf(ground, kind, "0")
    for word in ("height_mm", "width_mm"):
        size = float(one.common.get(word) or "nan")
        _leaf(ground, HEADER[word], f"{size:.0f}" if 0 < size < 10_000 else "")


def _time(value: str) -> str:
    return f"{value}:00" if value.count(":") == 1 else value


def _states(observed: list[Observed], edition: str) -> ET.Element:
    states = ET.Element("Inspektionsdaten")
    states.extend(_state(one, edition) for one in observed)
    return states


def _state(one: Observed, edition: str) -> ET.Element:
    state = ET.Element("RZustand")
    _leaf(state, "Station", f"{one.distance:.2f}" if np.isfinite(one.distance) else "0.00")
    _video(state, one, edition)
    texts = {element: one[name] for element, name in TEXTS.items()}
    _leaf(state, "InspektionsKode", texts["InspektionsKode"], 10)
    for element in ("Charakterisierung1", "Charakterisierung2"):
        _leaf(state, element, texts[element], 10)
    _leaf(state, "Verbindung", _JOINT.get(texts["Verbindung"].lower(), ""))
    for k in (1, 2):
        _quantity(state, k, one)
    continuous = one["continuous"]
    _leaf(state, "Streckenschaden", continuous[:1])
    _leaf(state, "StreckenschadenLfdNr", continuous[1:])
    for element, hours in (("PositionVon", one.clock), ("PositionBis", one.clock_to)):
        _leaf(state, element, f"{round(hours) or 12:02d}" if np.isfinite(hours) else "")
    more = [to_element(tree) for tree in one.fields.get("more", [])]
    more = [x for x in more if edition != "2006-10" or x.tag not in _LATER]
    before = [
        x for x in more if x.tag not in ("FotoSpeichermedium", "Fotonummer", "Klassifizierung", "Gruppe", "Index")
    ]
    state.extend(before)
    _leaf(state, "Fotodatei", texts["Fotodatei"], 255)
    state.extend(x for x in more if x.tag in ("FotoSpeichermedium", "Fotonummer"))
    _leaf(state, "Kommentar", texts["Kommentar"])
    state.extend(x for x in more if x.tag in ("Klassifizierung", "Gruppe", "Index"))
    return state


def _video(state: ET.Element, one: Observed, edition: str) -> None:
    """Add the reference into the video, which the schema wants of every state."""
    element = one.fields.get("video")
    if element and (edition != "2006-10" or element not in _LATER):
        ET.SubElement(state, element).text = one["video"] or None
    elif edition == "2006-10":
        ET.SubElement(state, "Timecode").text = "00000000"
    else:
        ET.SubElement(state, "Parameter").text = clean(one["video"]) or None


def _quantity(state: ET.Element, k: int, one: Observed) -> None:
    value = one[f"quantification_{k}"].strip()
    kind = one.fields.get(f"Quantifizierung{k}")
    if kind is None and value:
        try:
            size = float(value)
        except ValueError:
            size = np.inf
        kind, value = ("Numerisch", f"{size:.2f}") if abs(size) <= _LARGEST else ("Text", value)
    if kind:
        _leaf(state, f"Quantifizierung{k}{kind}", value, 30)
