"""`overrides.toml`: every key checked, nothing guessed."""

import json

import pytest
import xarray as xr

from springline.errors import FormatError, InputError
from springline.survey import Survey
from springline.survey.overrides import (
    ACTIONS,
    datum_shift,
    dump_overrides,
    read_overrides,
    with_effects,
    with_overrides,
)

SIGNED = 'author = "A. Surveyor"\ndate = 2026-05-04\nreason = "why"\n'


def file(folder, text):
    path = folder / "overrides.toml"
    path.write_text(text, "utf-8")
    return path


def test_records_say_what_who_when_and_why(tmp_path):
    text = (
        f'[[add]]\nkind = "lateral"\nchainage_m = 3\nclock_h = 9\n{SIGNED}'
        f"[[mask]]\nfrom_m = 1.5\nto_m = 2\nfrom_clock = 4\nto_clock = 8\n{SIGNED}"
    )
    mask, add = read_overrides(file(tmp_path, text))
    assert mask["what"] == "leave out readings from 1.5 m to 2 m, 4 to 8 o'clock"
    assert add["what"] == "add the lateral at 3 m, 9 o'clock"
    assert (mask["author"], mask["date"], mask["reason"]) == ("A. Surveyor", "2026-05-04", "why")
    assert mask["change"] == {"from_m": 1.5, "to_m": 2.0, "from_clock": 4.0, "to_clock": 8.0}


def test_survey_shows_them_without_the_machinery(tmp_path):
    survey = with_overrides(Survey({}), file(tmp_path, f"[[datum]]\nat_m = 2\nchainage_m = 100\n{SIGNED}"))
    (shown,) = survey.overrides
    assert set(shown) == {"action", "what", "author", "date", "reason"}
    assert datum_shift(survey) == 98.0
    assert "change" in json.loads(survey.attrs["overrides"])[0]


def test_an_empty_file_changes_nothing(tmp_path):
    assert with_overrides(Survey({}), file(tmp_path, "")).overrides == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[maks]]\n", "maks: unknown key, did you mean 'mask'"),
        (f"[[mask]]\nfrom = 1\nto_m = 2\n{SIGNED}", "unknown key 'from', did you mean 'from_m'"),
        (f"[[mask]]\nfrom_m = 1\n{SIGNED}", "mask 1: the key 'to_m' is missing"),
        ('[[remove]]\nkind = "joint"\nchainage_m = 1\nauthor = "A"\ndate = 2026-05-04\n', "'reason' is missing"),
        (f"[[mask]]\nfrom_m = 3\nto_m = 2\n{SIGNED}", "to_m is not beyond from_m"),
        (f"[[mask]]\nfrom_m = 1\nto_m = 2\nfrom_clock = 4\n{SIGNED}", "an arc has one end"),
        (f"[[mask]]\nfrom_m = 1\nto_m = 2\nfrom_clock = 4\nto_clock = 13\n{SIGNED}", "13 is no clock position"),
        (f'[[mask]]\nfrom_m = "1 m"\nto_m = 2\n{SIGNED}', "'1 m' is not a number"),
        (f"[[mask]]\nfrom_m = nan\nto_m = 2\n{SIGNED}", "nan is not a number"),
        (f"[[add]]\nkind = 3\nchainage_m = 1\n{SIGNED}", "3 is not a text"),
        (f"[[datum]]\nat_m = 1\n{SIGNED}", "the datum sets nothing"),
        (f"[[datum]]\nat_m = 1\nchainage_m = 0\n{SIGNED}" * 2, "two datums"),
        (f'[[remove]]\nkind = "x"\nchainage_m = 1\nwithin_m = 0\n{SIGNED}', "within_m is not positive"),
        (f'[[mask]]\nfrom_m = 1\nto_m = 2\nalong = "distanc"\n{SIGNED}', "did you mean 'distance'"),
        ("[mask]\nfrom_m = 1\n", r"not a list of tables.*\[\[mask\]\]"),
        (f"[[mask]]\nfrom_m = 1\nto_m = 2\n{SIGNED.replace('2026-05-04', '4711')}", "4711 is not a date"),
    ],
)
def test_faults_are_named_with_their_place(text, said, tmp_path):
    with pytest.raises(InputError, match=said) as found:
        read_overrides(file(tmp_path, text))
    assert str(tmp_path) in str(found.value)


def test_broken_toml_and_missing_file(tmp_path):
    with pytest.raises(FormatError, match="not a TOML file"):
        read_overrides(file(tmp_path, "[[mask]\n"))
    with pytest.raises(InputError, match="no such file"):
        read_overrides(tmp_path / "nowhere.toml")


def test_every_action_has_its_sentence(tmp_path):
    values = {"along": '"distance"', "kind": '"joint"', "to": '"lateral"', "image": '"a.png"'}
    for action, (must, may) in ACTIONS.items():
        keys = dict.fromkeys((*must, *may), "2") | {k: v for k, v in values.items() if k in (*must, *may)}
        if action == "mask":
            keys["to_m"] = "3"
        body = "\n".join(f"{k} = {v}" for k, v in keys.items())
        (record,) = read_overrides(file(tmp_path, f"[[{action}]]\n{body}\n{SIGNED}"))
        assert "2 m" in record["what"], action


def test_corrections_come_back_from_the_file_they_are_written_to(tmp_path):
    text = (
        f"[[mask]]\nfrom_m = 1\nto_m = 2\n{SIGNED}"
        f'[[relabel]]\nkind = "joint"\nchainage_m = 3\nto = "Ж \\"x\\""\n{SIGNED}'
        f"[[datum]]\nat_m = 1\nelevation_m = -2.5\n{SIGNED}"
    )
    first = with_overrides(Survey({}), file(tmp_path, text))
    again = with_overrides(Survey({}), file(tmp_path, dump_overrides(first)))
    assert again.attrs["overrides"] == first.attrs["overrides"]


def test_a_finished_survey_keeps_what_was_applied_until_it_is_inspected_again(tmp_path):
    first = with_overrides(Survey({}), file(tmp_path, f"[[mask]]\nfrom_m = 1\nto_m = 2\n{SIGNED}"))
    finished = with_effects(first, ["12 readings left out"], "mask").with_group("section", xr.Dataset())
    waiting = with_overrides(finished, file(tmp_path, f"[[mask]]\nfrom_m = 5\nto_m = 6\n{SIGNED}"))
    assert waiting.overrides == finished.overrides
    assert "from 5 m to 6 m" in waiting.source().overrides[0]["what"]
