"""Run the cases of a vector file: |got - expected| <= abs + rel |expected| for every number."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from tests.authority.adapter import FUNCTIONS


def run(path):
    """Return how many cases passed, and one line about each that failed."""
    failures = []
    cases = json.loads(Path(path).read_text())["cases"]
    for case in cases:
        fault = judge(case)
        if fault:
            failures.append(f"{case['id']}: {fault}")
    return len(cases) - len(failures), failures


def judge(case):
    """Return what is wrong with a case, or an empty string."""
    call = FUNCTIONS.get(case["function"])
    if call is None:
        return f"no adapter for {case['function']}"
    must_refuse = case["expected"] == {"raises": True}
    try:
        got = call(**case["inputs"])
    except ValueError as refusal:
        return "" if must_refuse else f"refused: {refusal}"
    except Exception as fault:  # noqa: BLE001 - whatever a case raises is that case's failure, and the next still runs
        return f"{type(fault).__name__}: {fault}"
    if must_refuse:
        return f"not refused, but {got}"
    return difference(got, case["expected"], case["tolerance"])


def difference(got, expected, tolerance, place=""):
    """Return where and how a result departs from what is expected, or an empty string."""
    if isinstance(expected, dict):
        if not isinstance(got, dict):
            return f"{place}: a dict is expected, not {got!r}"
        for key, value in expected.items():
            if key not in got:
                return f"{place}.{key} is missing"
            fault = difference(got[key], value, tolerance, f"{place}.{key}")
            if fault:
                return fault
        return ""
    if isinstance(expected, list):
        values = list(got) if np.iterable(got) else None
        if values is None or len(values) != len(expected):
            return f"{place}: {len(expected)} values are expected, not {got!r}"
        faults = (difference(g, e, tolerance, f"{place}[{i}]") for i, (g, e) in enumerate(zip(values, expected)))  # noqa: B905
        return next((fault for fault in faults if fault), "")
    if isinstance(expected, bool | str):
        return "" if got == expected else f"{place} = {got!r}, expected {expected!r}"
    number = np.nan if got is None else float(got)
    if expected is None:  # no value: nothing finite may stand there
        return f"{place} = {number!r}, expected no value" if np.isfinite(number) else ""
    if number == expected or abs(number - expected) <= tolerance["abs"] + tolerance["rel"] * abs(expected):
        return ""
    return f"{place} = {number!r}, expected {expected!r}"
