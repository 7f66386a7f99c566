"""Every case of pose.json, an independent program's results, through the pose adapter."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from tests.authority.adapter_pose import FUNCTIONS

VECTORS = Path(__file__).parents[2] / ".." / "shared" / "vectors" / "pose.json"


def agrees(got, expected, tolerance) -> bool:
    if isinstance(expected, dict):
        return all(agrees(got[key], value, tolerance) for key, value in expected.items())
    got, expected = np.asarray(got, dtype=float), np.asarray(expected, dtype=float)
    if got.shape != expected.shape:
        return False
    allowed = tolerance["abs"] + tolerance["rel"] * np.abs(expected)
    missing = np.isnan(expected)
    return bool(np.all(np.where(missing, np.isnan(got), np.abs(got - expected) <= allowed)))


@pytest.mark.shared
@pytest.mark.skipif(not VECTORS.exists(), reason="the reference folder ../shared is absent")
def test_every_case_of_the_independent_program_agrees():
    cases = json.loads(VECTORS.read_text())["cases"]
    failed = []
    for case in cases:
        call = FUNCTIONS[case["function"]]
        expected = case["expected"]
        if isinstance(expected, dict) and expected.get("raises"):
            with pytest.raises(ValueError, match=r"."):
                call(**case["inputs"])
        elif not agrees(call(**case["inputs"]), expected, case["tolerance"]):
            failed.append(case["id"])
    assert failed == []
    assert {case["function"] for case in cases} == set(FUNCTIONS)


def test_a_wrong_value_is_noticed():
    assert not agrees([1.0, 2.0], [1.0, 2.1], {"abs": 1e-9, "rel": 0.0})
    assert not agrees([1.0, np.nan], [1.0, 2.0], {"abs": 1e-9, "rel": 0.0})
    assert agrees({"beta": np.nan}, {"beta": None}, {"abs": 1e-9, "rel": 0.0})
