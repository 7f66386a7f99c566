"""Codes of CCTV inspections and the kinds of feature that they name; a code that is not here is carried, never guessed.

Sources: EN 13508-2:2003+A1:2011, main codes of drains and sewers (DWA-M 149-2 and ISYBAU use the same), PACP 6.
"""

from __future__ import annotations

EN_KINDS = {
    "BAA": "deformation",
    "BAB": "crack",
    "BAC": "break",
    "BAG": "intruding lateral",
    "BAH": "defective lateral",
    "BAI": "intruding seal",
    "BAJ": "displaced joint",
    "BAK": "lining defect",
    "BBA": "roots",
    "BBB": "attached deposit",
    "BBC": "deposit",
    "BBE": "obstacle",
    "BBF": "infiltration",
    "BCA": "lateral",
    "BCC": "bend",
    "BCD": "start",
    "BCE": "end",
    "BDD": "water level",
}
"""Main code of EN 13508-2 to kind."""

_PACP_EXACT = {"AMH": "manhole", "MWL": "water level", "D": "deformation"}
_PACP_STARTS = {
    "TF": "lateral",
    "TB": "lateral",
    "TR": "lateral",
    "TS": "lateral",
    "JO": "displaced joint",
    "JS": "displaced joint",
    "JA": "displaced joint",
    "DA": "attached deposit",
    "DS": "deposit",
    "RF": "roots",
    "RT": "roots",
    "RM": "roots",
    "RB": "roots",
    "OB": "obstacle",
    "ID": "infiltration",
    "IR": "infiltration",
    "IG": "infiltration",
    "IW": "infiltration",
    "IS": "infiltration",
}

EN_CODES = {"lateral": "BCA", "deposit": "BBC", "dent": "BAA", "crack": "BAB"}
"""Kind of feature to main code of EN 13508-2, where its meaning needs no characterisation that nobody has seen."""

EN_REMARK, PACP_REMARK = "BDB", "MGO"
"""Codes of a general remark, which carry a kind that has no code, in words."""

REMARK = "Springline: "
"""How a remark begins that names such a kind."""


def en_kind(code: str, remarks: str = "") -> str:
    """Return the kind that a code of EN 13508-2 names, empty when none.

    >>> en_kind("BCA"), en_kind("BDB", "Springline: joint, 12 mm long"), en_kind("XYZ")
    ('lateral', 'joint', '')
    """
    return _remarked(remarks) if code == EN_REMARK else EN_KINDS.get(code[:3], "")


def pacp_kind(code: str, remarks: str = "") -> str:
    """Return the kind that a PACP code names, empty when none.

    >>> pacp_kind("TFA"), pacp_kind("RFJ"), pacp_kind("ZZZ")
    ('lateral', 'roots', '')
    """
    if code == PACP_REMARK:
        return _remarked(remarks)
    return _PACP_EXACT.get(code) or _PACP_STARTS.get(code[:2], "")


def _remarked(remarks: str) -> str:
    return remarks.removeprefix(REMARK).split(",")[0].strip() if remarks.startswith(REMARK) else ""
