"""No stage reads `/truth`: a survey stripped of it gives the same results; and those results are near it."""

from __future__ import annotations

import numpy as np

from springline.config import Config
from springline.data import builtin_survey
from springline.stages.clean import clean
from springline.stages.estimate import estimate
from springline.stages.metrics import metrics
from springline.survey import Survey, open_survey


def chain(survey: Survey) -> Survey:
    config = Config()
    return metrics(estimate(clean(survey, config), config), config)


def test_results_do_not_depend_on_the_truth_and_agree_with_it():
    whole = open_survey(builtin_survey())
    with_truth, without = chain(whole), chain(Survey({"rings": whole.rings}, whole.attrs))
    for group in ("mask", "pose", "section", "metrics"):
        assert with_truth.group(group).identical(without.group(group))
    truth, pose = whole.truth, without.pose
    for axis in ("offset_y", "offset_z"):
        seen = np.isfinite(pose[axis].values)
        found, true = pose[axis].values[seen], truth[axis].values[seen]
        assert seen.mean() > 0.95
        # Same axes, same signs: what is left is noise, a hundredth of the weaving.
        assert np.median(np.abs(found - true)) < 3e-4
        assert np.corrcoef(found, true)[0, 1] > 0.99
    true = np.interp(truth["ring_chainage"], truth["chainage"], truth["diameter_area"])
    assert abs(np.nanmedian(without.metrics["diameter_area"].values - true)) < 1e-4
