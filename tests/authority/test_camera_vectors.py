"""Every case of camera.json, an independent program's results, through the camera adapter."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.authority.adapter_camera import FUNCTIONS
from tests.authority.runner import judge, run

VECTORS = Path(__file__).parents[2] / ".." / "shared" / "vectors"
needs_vectors = pytest.mark.skipif(not VECTORS.exists(), reason="the reference folder ../shared is absent")


@pytest.mark.shared
@needs_vectors
def test_every_case_of_the_independent_program_agrees():
    passed, failures = run(VECTORS / "camera.json")
    assert failures == []
    assert passed > 200


@pytest.mark.shared
@needs_vectors
def test_every_function_of_the_list_is_offered():
    listed = (VECTORS / "README.md").read_text().split("## camera")[1]
    names = {line.split("`")[1].split("(")[0] for line in listed.splitlines() if line.startswith("- `")}
    assert names == set(FUNCTIONS)


def test_a_wrong_value_is_noticed():
    case = {"function": "lens", "inputs": {"name": "sine", "zenith": 30, "k": 2}, "tolerance": {"rel": 0, "abs": 1e-9}}
    assert judge({**case, "expected": 1.0}) == ""
    assert judge({**case, "expected": 1.1}) != ""
    assert judge({**case, "inputs": {"name": "sinus", "zenith": 30}, "expected": {"raises": True}}) == ""
