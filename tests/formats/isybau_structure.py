"""The structure of ISYBAU XML 2013-02, condition data of pipes, as its published schemas have it (as of 12/2015).

Each branch lists its children in their order: name, least and most often, and what a leaf may hold.
"""

import re

ANY = r"(?s).*"
DATE, BOOL = r"\d{4}-\d\d-\d\d", r"true|false|0|1"


def text(most, least=0):
    return rf"(?s).{{{least},{most}}}"


def decimal(whole, places):
    return rf"-?\d{{1,{whole}}}(\.\d{{1,{places}}})?"


def integer(digits):
    return rf"-?\d{{1,{digits}}}"


BRANCHES = {
    "Identifikation": [("Version", 1, 1, r"\d{4}-\d\d"), ("Admindaten", 1, 1, None), ("Datenkollektive", 1, 1, None)],
    "Admindaten": [("Liegenschaft", 1, 1, None), ("Verwaltung", 0, 1, ANY), ("Geometrie", 0, 1, ANY)],
    "Liegenschaft": [("Liegenschaftsnummer", 1, 1, text(20)), ("Objektnummer", 0, 1, text(4)),
                     ("Liegenschaftsbezeichnung", 1, 1, text(255))],
    "Datenkollektive": [("Datenstatus", 1, 1, integer(1)), ("Erstellungsdatum", 1, 1, DATE), ("Kommentar", 0, 1, ANY),
                        ("Kennungen", 1, 1, None), ("Stammdatenkollektiv", 0, 99, ANY),
                        ("Zustandsdatenkollektiv", 0, 99, None)],
    "Kennungen": [("Kollektiv", 1, 99, None)],
    "Kollektiv": [("Kennung", 1, 1, text(5, 5)), ("Kollektivart", 1, 1, integer(1)),
                  ("Kollektiveigenschaft", 1, 1, None), ("Regelwerk", 1, 1, integer(2)),
                  ("Bearbeitungsstand", 1, 1, DATE), ("Kommentar", 0, 1, ANY)],
    "Kollektiveigenschaft": [("Zustandsdaten", 1, 1, None)],
    "Zustandsdaten": [("Inspektion", 1, 1, BOOL), ("Dichtheit", 1, 1, BOOL), ("Film", 1, 1, BOOL)],
    "Zustandsdatenkollektiv": [("Kennung", 1, 1, text(5, 5)), ("Beschreibung", 0, 1, text(100)),
                               ("Auftraege", 1, 1, None), ("InspizierteAbwassertechnischeAnlage", 0, 9999, None)],
    "Auftraege": [("Auftrag", 1, 99, None)],
    "Auftrag": [("Auftragsbezeichnung", 1, 1, text(60)), ("Auftragsnummer", 0, 1, text(40)),
                ("Auftragskennung", 1, 1, integer(6)), ("Auftragsdatum", 0, 1, DATE),
                ("Auftragsart", 1, 1, integer(1)), ("Inspektionsort", 0, 1, text(40)),
                ("Inspektionszweck", 0, 1, integer(2)), ("Kodiersystem", 0, 1, integer(2)),
                ("Auftragnehmer", 0, 1, text(60)), ("Systemname", 0, 1, text(40)), ("Version", 0, 1, text(10)),
                ("InspektionsdatumEnde", 0, 1, DATE)],
    "InspizierteAbwassertechnischeAnlage": [("Objektbezeichnung", 1, 1, text(30)), ("Anlagentyp", 1, 1, integer(1)),
                                            ("Lage", 0, 1, ANY), ("OptischeInspektion", 0, 1, None),
                                            ("Dichtheitspruefungen", 0, 1, ANY)],
    "OptischeInspektion": [("Auftragskennung", 1, 1, integer(6)), ("Inspektionsdatum", 0, 1, DATE),
                           ("Inspektionsverfahren", 0, 1, integer(1)), ("NameUntersucher", 0, 1, text(40)),
                           ("Uhrzeit", 0, 1, r"\d\d:\d\d:\d\d"), ("Rohrleitung", 1, 1, None)],
    "Rohrleitung": [("Rohrleitungstyp", 1, 1, integer(1)), ("Inspektionsrichtung", 1, 1, "[OU]"),
                    ("BezugspunktLage", 0, 1, integer(1)), ("Inspektionslaenge", 0, 1, decimal(3, 2)),
                    ("RGrunddaten", 0, 1, None), ("Inspektionsdaten", 0, 1, None)],
    "RGrunddaten": [("KnotenZulauf", 1, 1, text(30)), ("KnotenZulaufTyp", 1, 1, integer(1)),
                    ("KnotenAblauf", 1, 1, text(30)), ("KnotenAblaufTyp", 1, 1, integer(1)),
                    ("HerkunftProfilmasse", 0, 1, integer(1)), ("Profilhoehe", 0, 1, integer(4)),
                    ("Profilbreite", 0, 1, integer(4))],
    "Inspektionsdaten": [("RZustand", 1, 99999, None)],
    "RZustand": [("Station", 1, 1, decimal(3, 2)), ("Timecode|Frame|Videozaehler|Parameter", 1, 1, ANY),
                 ("InspektionsKode", 1, 1, text(10)), ("Charakterisierung1", 0, 1, text(10)),
                 ("Charakterisierung2", 0, 1, text(10)), ("Verbindung", 0, 1, BOOL),
                 ("Quantifizierung1Numerisch", 0, 1, decimal(4, 2)), ("Quantifizierung1Text", 0, 1, text(30)),
                 ("Quantifizierung2Numerisch", 0, 1, decimal(4, 2)), ("Quantifizierung2Text", 0, 1, text(30)),
                 ("Streckenschaden", 0, 1, text(1)), ("StreckenschadenLfdNr", 0, 1, r"[1-9]\d?"),
                 ("PositionVon", 0, 1, integer(2)), ("PositionBis", 0, 1, integer(2)),
                 ("Fotodatei", 0, 1, text(255)), ("FotoSpeichermedium", 0, 1, integer(1)),
                 ("Fotonummer", 0, 1, text(20)), ("Kommentar", 0, 1, r"|\S+( \S+)*"),
                 ("Klassifizierung", 0, 1, ANY), ("Gruppe", 0, 1, r"[1-9]\d?")],
}  # fmt: skip


def name(element):
    return element.tag.rpartition("}")[2]


def faults(element, place=""):
    """Return what in an element does not follow the structure."""
    place = f"{place}/{name(element)}"
    found = []
    left = list(element)
    for names, least, most, holds in BRANCHES[name(element)]:
        count = 0
        while left and name(left[0]) in names.split("|"):
            child = left.pop(0)
            count += 1
            if holds is None:
                found += faults(child, place)
            elif len(child) == 0 and not re.fullmatch(holds, child.text or ""):
                found.append(f"{place}/{name(child)}: {child.text!r}")
        if not least <= count <= most:
            found.append(f"{place}: {count} of {names}")
    return found + [f"{place}: {name(one)} is not expected here" for one in left]
