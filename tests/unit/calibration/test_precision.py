"""The precision study against analysis of variance done elsewhere, uneven cells, and what is not known."""

import numpy as np
import pytest
from scipy import stats

from springline.calibration import study_precision
from springline.calibration.verdicts import judge_precision
from springline.errors import InputError

RING = {"ring": [300.0, 300.1, 299.9, 300.0]}


def uneven(seed, sizes=(3, 5, 4, 3, 6, 2, 4)):
    rng = np.random.default_rng(seed)
    labs = [f"lab {k}" for k, n in enumerate(sizes) for _ in range(n)]
    shift = np.repeat(rng.standard_normal(len(sizes)), sizes)
    return labs, 100.0 + shift + 0.4 * rng.standard_normal(len(labs))


def test_uneven_cells_agree_with_analysis_of_variance():
    labs, values = uneven(4)
    found = study_precision(labs, ["m"] * len(labs), values)
    groups = [values[np.array(labs) == lab] for lab in found.laboratories]
    # Mean square within, and F of the between, by SciPy.
    within = sum(np.var(g, ddof=1) * (len(g) - 1) for g in groups) / sum(len(g) - 1 for g in groups)
    assert found.repeatability[0] ** 2 == pytest.approx(within, rel=1e-12)
    even_labs, even = uneven(5, (4,) * 7)
    balanced = study_precision(even_labs, ["m"] * 28, even)
    ratio = stats.f_oneway(*even.reshape(7, 4)).statistic
    assert 4.0 * balanced.mean_deviation[0] ** 2 / balanced.repeatability[0] ** 2 == pytest.approx(ratio, rel=1e-10)
    # s_R^2 = s_L^2 + s_r^2 with the between-laboratory component of the random-effects model.
    component = (ratio - 1.0) * balanced.repeatability[0] ** 2 / 4.0
    assert balanced.reproducibility[0] ** 2 == pytest.approx(component + balanced.repeatability[0] ** 2, rel=1e-10)


def test_variances_come_out_right_on_average():
    found = [study_precision(labs, ["m"] * len(labs), values) for labs, values in (uneven(seed) for seed in range(400))]
    assert np.sqrt(np.mean([one.repeatability[0] ** 2 for one in found])) == pytest.approx(0.4, rel=0.02)
    assert np.sqrt(np.mean([one.reproducibility[0] ** 2 for one in found])) == pytest.approx(
        np.hypot(1.0, 0.4), rel=0.05
    )


def test_intervals_of_bias_and_repeatability_hold_the_truth():
    rng, hits, trials = np.random.default_rng(6), np.zeros(2), 600
    labs = [f"lab {k // 3}" for k in range(18)]
    for _ in range(trials):
        values = 300.2 + np.repeat(0.3 * rng.standard_normal(6), 3) + 0.1 * rng.standard_normal(18)
        # A reference measured much better than the laboratories scatter, as it should be.
        measures = 300.0 + 0.02 * rng.standard_normal(4)
        found = study_precision(labs, ["m"] * 18, values, reference={"m": measures})
        low, high = found.repeatability_interval()
        hits += abs(found.bias[0] - 0.2) < found.bias_half_width[0], low[0] < 0.1 < high[0]
    assert np.all((hits / trials > 0.92) & (hits / trials < 0.98)), hits / trials


def test_one_laboratory_tells_repeatability_and_bias_alone():
    found = study_precision(["a"] * 5, ["ring"] * 5, [300.1, 300.2, 300.0, 300.1, 300.1], reference=RING)
    assert found.repeatability[0] == pytest.approx(np.std([1, 2, 0, 1, 1], ddof=1) / 10)
    assert found.bias[0] == pytest.approx(0.1)
    for value in (found.reproducibility, found.mean_deviation, found.h, found.h_critical):
        assert np.isnan(value).all()


def test_single_results_tell_no_repeatability_and_missing_cells_stay_missing():
    found = study_precision(["a", "b", "c", "a", "b"], ["m", "m", "m", "n", "n"], [1.0, 2.0, 3.0, 5.0, 5.5])
    assert np.isnan(found.repeatability).all() and np.isnan(found.k).all()
    assert found.mean.tolist() == [2.0, 5.25] and found.mean_deviation[0] == pytest.approx(1.0)
    assert np.isnan(found.cell_mean[2, 1]) and found.count[2, 1] == 0
    assert not found.flagged.any()
    assert {one.verdict for one in judge_precision(found)} == {"not_assessed"}


def test_verdicts_say_pass_fail_and_uncertain():
    def verdicts(values):
        study = study_precision(["a"] * len(values), ["ring"] * len(values), values, reference=RING)
        return tuple(one.verdict for one in judge_precision(study))

    scatter = np.array([0.1, -0.1, 0.05, -0.05, 0.1, -0.1, 0.0, 0.0])
    assert verdicts(300.3 + scatter) == ("pass", "pass")
    assert verdicts(302.5 + scatter) == ("fail", "pass")
    assert verdicts(301.5 + scatter) == ("uncertain", "pass")
    assert verdicts(300.0 + 4.0 * scatter) == ("pass", "uncertain")
    assert verdicts(300.0 + 10.0 * scatter)[1] == "fail"


def test_what_cannot_be_studied_is_refused():
    with pytest.raises(InputError, match="at least one result"):
        study_precision([], [], [])
    with pytest.raises(InputError, match="the result 2 is nan"):
        study_precision(["a", "a"], ["m", "m"], [1.0, np.nan])
    with pytest.raises(InputError, match="3 measures"):
        study_precision(["a"], ["ring"], [300.0], reference={"ring": [300.0, 300.1, 299.9]})
    with pytest.raises(InputError, match="of which there is no result"):
        study_precision(["a"], ["m"], [300.0], reference=RING)
