"""Whatever was coded comes back from every coded format, to its precision."""

import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import springline as sl
from springline.io.observations import Inspection, Observed, inspections_of, observations_survey

# Line breaks and runs of white space are one space in these formats; control characters have no place in them.
WORDS = st.text(st.characters(exclude_categories=("C", "Z")) | st.just(" "), max_size=30).map(
    lambda s: " ".join(s.split())
)
CODES = st.text("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789", min_size=1, max_size=8)
LETTERS = st.text("ABCXYZ", max_size=2)
HOURS = st.sampled_from([np.nan, *map(float, range(1, 13))])


@st.composite
def observed(draw):
    texts = {
        "code": draw(CODES),
        "kind": "",
        "characterisation_1": draw(LETTERS),
        "characterisation_2": draw(LETTERS),
        "quantification_1": draw(st.sampled_from(["", "12.00", "0.50"])),
        "continuous": draw(st.sampled_from(["", "A1", "B12"])),
        "remarks": draw(WORDS),
        "photo": draw(WORDS),
    }
    return Observed(draw(st.integers(0, 99_999)) / 100, draw(HOURS), draw(HOURS), texts)


INSPECTIONS = st.lists(st.lists(observed(), min_size=1, max_size=4), min_size=1, max_size=3)


@pytest.mark.parametrize("wanted", ["en13508", "isybau", "isybau-2006", "m150", "pacp"])
@settings(max_examples=40, deadline=None)
@given(rows=INSPECTIONS)
def test_what_was_coded_comes_back(wanted, rows):
    pacp = wanted == "pacp"
    own = {"inspection": {}, "media": []}
    made = [
        Inspection(
            {"name": f"R{k}", "date": "2026-05-04", "direction": "upstream"}, {"InspectionID": str(k), **own}, one
        )
        for k, one in enumerate(rows)
    ]
    source = "pacp" if pacp else "m150" if wanted.startswith("isybau") else "isybau"
    survey = observations_survey(made, Path("made"), format=source, layout={"columns": _columns()} if pacp else {})
    with tempfile.TemporaryDirectory() as folder:
        back = inspections_of(sl.read(sl.write(survey, Path(folder) / "x", format=wanted)))
    assert len(back) == len(rows)
    names = ("code", "remarks", "continuous", "quantification_1")
    names += () if pacp else ("characterisation_1", "characterisation_2", "photo")
    for before, after in zip(made, back, strict=True):
        for one, other in zip(before.observed, after.observed, strict=True):
            assert {n: other[n] for n in names} == {n: one[n] for n in names}
            assert other.distance == pytest.approx(one.distance, abs=2e-4 if pacp else 1e-9)
            np.testing.assert_equal([other.clock, other.clock_to], [one.clock, one.clock_to])
        if not pacp:
            assert {k: after.common[k] for k in before.common} == before.common


def _columns():
    from springline.io.pacp import CONDITIONS

    return list(CONDITIONS)
