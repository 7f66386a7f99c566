import numpy as np
import pytest

from springline.design import evaluate, load_rule, rule_names
from springline.design.acceptance import VERDICTS
from springline.errors import FormatError


@pytest.mark.parametrize("name", rule_names())
def test_every_rule_says_where_it_comes_from_and_what_is_sure(name):
    rule = load_rule(name)
    assert rule.name == name
    assert min(len(text) for text in (rule.title, rule.source, rule.edition, rule.sure)) > 0
    assert (rule.limit is not None) + (rule.classes is not None) + (rule.missing is not None) == 1
    assert rule.quantity == "deflection"


def test_the_interval_decides():
    values = [0.0400, 0.0490, 0.0510, 0.0600, np.nan, 0.04]
    found = evaluate("deflection-5", values, [0.001] * 5 + [np.nan], reference="nominal")
    assert found.stations.tolist() == ["pass", "uncertain", "uncertain", "fail", "not_assessed", "not_assessed"]
    edge = evaluate("deflection-5", [0.05 - 1.95997e-3, 0.05 + 1.95997e-3], [0.001] * 2, reference="nominal")
    assert edge.stations.tolist() == ["pass", "fail"]
    wide = evaluate("deflection-5", [0.048], [0.001], reference="nominal", confidence=0.99)
    assert wide.verdict == "uncertain"


@pytest.mark.parametrize(
    ("values", "sigma", "verdict", "where"),
    [
        ([0.01, 0.03, 0.02], 0.001, "pass", 7.5),
        ([0.01, 0.05, 0.02], 0.001, "uncertain", 7.5),
        ([0.01, 0.05, 0.08], 0.001, "fail", 10.0),
        ([0.09, 0.05, 0.08], 0.001, "fail", 5.0),
        ([np.nan] * 3, 0.001, "not_assessed", np.nan),
        ([np.nan, np.nan, 0.01], 0.001, "uncertain", 10.0),
    ],
)
def test_the_pipe_takes_the_worst_verdict_of_its_stations(values, sigma, verdict, where):
    found = evaluate("deflection-5", values, [sigma] * 3, chainage=[5.0, 7.5, 10.0], reference="base")
    assert found.verdict == verdict
    np.testing.assert_equal(found.where, where)
    assert found.verdict in VERDICTS


def test_the_reason_names_value_place_limit_and_counts():
    found = evaluate("deflection-7.5", [0.02, 0.081], [0.002, 0.002], chainage=[0.0, 12.4], reference="base")
    assert found.why == (
        "deflection 8.1 % +- 0.2 % at 12.40 m lies above 7.5 %; 1 of 2 stations fail, 0 uncertain, 0 not assessed"
    )
    few = evaluate("deflection-5", [0.01, np.nan], [0.001, 0.001], reference="base")
    assert few.why.endswith("too few to pass the pipe")
    assert evaluate("deflection-5", [0.01, np.nan], [0.001] * 2, reference="base", least_assessed=0.5).verdict == "pass"


def test_a_wide_sigma_is_written_out():
    why = evaluate("deflection-5", [0.143], [0.4004], chainage=[0.26], reference="base").why
    assert why.startswith("deflection 14.3 % +- 40 % at 0.26 m cannot be told from 5 %")


def test_without_its_reference_nothing_is_judged():
    unknown = evaluate("deflection-5", [0.08], [0.001])
    assert unknown.verdict == "not_assessed"
    assert unknown.why == "the reference diameter is not known; the rule refers to base or nominal"
    other = evaluate("fdot-430", [0.08], [0.001], reference="nominal")
    assert other.why.startswith("the values refer to the nominal diameter")
    assert other.stations.tolist() == ["not_assessed"]


def test_another_reference_than_the_preferred_is_said():
    nominal, base = (evaluate("deflection-7.5", [0.01], [0.001], reference=r).remarks for r in ("nominal", "base"))
    assert any("prefers the base" in remark for remark in nominal)
    assert not any("prefers" in remark for remark in base)


@pytest.mark.parametrize(
    ("material", "classes", "stations"),
    [
        ("rigid", [4, 3, 2, 1, 0, 4], ["pass", "pass", "fail", "fail", "fail", "pass"]),
        ("flexible", [4, 3, 3, 3, 2, 4], ["pass", "pass", "pass", "pass", "fail", "pass"]),
    ],
)
def test_dwa_classes_by_material(material, classes, stations):
    values = [0.005, 0.025, 0.032, 0.05, 0.08, -0.002]
    found = evaluate("dwa-m-149-3-stability", values, [1e-4] * 6, reference="nominal", material=material)
    assert found.classes.tolist() == classes
    assert found.stations.tolist() == stations


def test_a_class_begins_at_its_bound_and_a_limit_may_be_reached():
    of_class = evaluate("dwa-m-149-3-stability", [0.06], [0.0], reference="base", material="flexible")
    assert (of_class.classes[0], of_class.verdict) == (2, "fail")
    assert evaluate("deflection-5", [0.05], [0.0], reference="base").verdict == "pass"


def test_rules_by_material_need_the_material():
    found = evaluate("dwa-m-149-3-stability", [0.01], [0.001], reference="nominal")
    assert found.verdict == "not_assessed"
    assert "material, which is not known" in found.why
    assert evaluate("dwa-m-149-3-operation", [0.01], [0.001], reference="nominal").verdict == "pass"


def test_wrc_grades_count_upwards():
    found = evaluate("wrc-deformation", [0.02, 0.07, 0.12], [1e-3] * 3, reference="nominal")
    assert found.classes.tolist() == [3, 4, 5]
    assert found.stations.tolist() == ["pass", "fail", "fail"]


def test_unconfirmed_figures_are_not_judged_on():
    found = evaluate("pacp-deformation", [0.02], [0.001], reference="nominal")
    assert found.verdict == "not_assessed"
    assert "not public" in found.why


def test_the_accuracy_that_a_rule_asks_for_is_checked():
    found = evaluate("fdot-430", [0.02, 0.02], [0.001, 0.004], reference="representative")
    assert any("1 of 2 stations miss the accuracy of 0.5 %" in remark for remark in found.remarks)


RULE = """
title = "Ours"
quantity = "deflection"
references = ["nominal"]
source = "contract"
edition = "1"
sure = "all"
"""


def test_a_rule_of_the_users_own(tmp_path):
    path = tmp_path / "ours.toml"
    path.write_text(RULE + "limit = 0.03\n")
    assert evaluate(path, [0.04], [0.001], reference="nominal").verdict == "fail"
    assert load_rule(str(path)).name == "ours"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (RULE + "limt = 0.03\n", "ours.toml: unknown key 'limt', did you mean 'limit'"),
        (RULE, "either a limit, or classes"),
        (RULE.replace('edition = "1"', "") + "limit = 0.03\n", "key 'edition' is missing"),
        (RULE + "limit = \n", "not a TOML file"),
        (RULE + 'fail_at = 7\n[[classes]]\nscope = "any"\nlower = { 1 = 0.0 }\n', "fail_at = 7"),
    ],
)
def test_a_bad_rule_file_is_refused_by_its_place(tmp_path, text, message):
    path = tmp_path / "ours.toml"
    path.write_text(text)
    with pytest.raises(FormatError, match=message):
        load_rule(path)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: load_rule("deflection-6"), "'deflection-6' is not known, did you mean 'deflection-5'"),
        (lambda: load_rule("nowhere.toml"), "does not exist"),
        (lambda: evaluate("deflection-5", [0.1, 0.2], [0.1]), "one sigma and one chainage per station"),
        (lambda: evaluate("deflection-5", [0.1], [-0.1]), "sigmas = -0.1"),
        (lambda: evaluate("deflection-5", [0.1], [0.1], reference="inside"), "reference = 'inside'"),
        (lambda: evaluate("deflection-5", [0.1], [0.1], material="stiff"), "material = 'stiff'"),
        (lambda: evaluate("deflection-5", [0.1], [0.1], confidence=95), "confidence = 95"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
