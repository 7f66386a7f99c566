"""Every case of sections.json, an independent program's results to 40 digits, through the adapter; and the runner."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.authority import adapter
from tests.authority.runner import difference, judge, run

ROOT = Path(__file__).parents[2]
VECTORS = ROOT / ".." / "shared" / "vectors"
TIGHT = {"rel": 1e-9, "abs": 1e-12}


@pytest.mark.shared
@pytest.mark.skipif(not VECTORS.exists(), reason="the reference folder ../shared is absent")
def test_every_case_of_the_independent_program_agrees():
    passed, failures = run(VECTORS / "sections.json")
    assert failures == []
    assert passed > 400


@pytest.mark.shared
@pytest.mark.skipif(not VECTORS.exists(), reason="the reference folder ../shared is absent")
def test_every_function_of_the_list_is_offered():
    listed = (VECTORS / "README.md").read_text().split("## sections")[1].split("## pose")[0]
    names = [line.split("`")[1].split("(")[0] for line in listed.splitlines() if line.startswith("- `")]
    assert len(names) > 60
    assert [name for name in names if not callable(getattr(adapter, name, None))] == []


@pytest.mark.parametrize(
    ("got", "expected", "agrees"),
    [
        (1.0, 1.0 + 1e-10, True),
        (1.0, 1.0 + 1e-8, False),
        ([1.0, 2.0], [1.0, 2.1], False),
        ([1.0], [1.0, 2.0], False),
        (np.array([1.0, np.nan]), [1.0, None], True),
        ({"a": 1.0, "more": 5.0}, {"a": 1.0}, True),
        ({"a": 1.0}, {"a": 1.0, "b": 2.0}, False),
        (1.0, {"a": 1.0}, False),
        (None, None, True),
        (3.0, None, False),
        (np.nan, 1.0, False),
        (np.inf, float("inf"), True),
        (np.inf, 1e300, False),
    ],
)
def test_results_are_compared_number_by_number(got, expected, agrees):
    assert (difference(got, expected, TIGHT) == "") == agrees


def test_refusals_count_only_where_they_are_expected():
    refused = {"function": "ellipse_major", "inputs": {"s": 0.0}, "tolerance": TIGHT}
    assert judge({**refused, "expected": {"raises": True}}) == ""
    assert judge({**refused, "expected": 1.0}).startswith("refused: s = 0 is out of range")
    assert judge({**refused, "inputs": {"s": 0.9}, "expected": {"raises": True}}).startswith("not refused")
    assert judge({**refused, "function": "nothing", "expected": 1.0}) == "no adapter for nothing"
    assert judge({**refused, "inputs": {"t": 1.0}, "expected": 1.0}).startswith("TypeError")


def test_the_command_lists_failures_and_counts_last(tmp_path):
    good = {"id": "a/1", "function": "ellipse_major", "inputs": {"s": 1.0}, "expected": 1.0, "tolerance": TIGHT}
    (tmp_path / "good.json").write_text(json.dumps({"cases": [good]}))
    (tmp_path / "both.json").write_text(json.dumps({"cases": [good, {**good, "id": "a/2", "expected": 2.0}]}))

    def command(name):
        return subprocess.run(
            [sys.executable, "-m", "tests.authority", str(tmp_path / name)],
            cwd=ROOT,
            capture_output=True,
            text=True,
            check=False,
        )

    done = command("good.json")
    assert (done.returncode, done.stdout) == (0, "1 passed, 0 failed\n")
    failed = command("both.json")
    assert failed.returncode == 1
    assert failed.stdout.splitlines() == ["a/2:  = 1.0, expected 2.0", "1 passed, 1 failed"]
