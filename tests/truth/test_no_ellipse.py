"""Pipes that are no ellipse, inspected: their true diameters lie within what is stated, and no verdict is sure."""

import json

import numpy as np
import pytest

import springline as sl
from springline.config import make_config
from springline.simulate import parse, simulate

SCENARIO = """
name = "shape"
[pipe]
diameter = "{diameter}"
run = [{{ kind = "straight", length = 3.0 }}]
[[pipe.section]]
{section}
[robot]
length = 0.4
[rings]
spacing = "20mm"
bearings = 180
noise = "1mm"
dropout = 0.03
{more}
"""
SHAPES = {
    "egg": ("400mm", 'shape = "egg"\nwidth = "400mm"\nheight = "600mm"\ninvert_radius = "100mm"'),
    "box": ("600mm", 'shape = "box"\nwidth = "600mm"\nheight = "600mm"\nfillet = "60mm"'),
}
ROUND = {
    "circle": ("300mm", 'shape = "circle"\ndiameter = "300mm"'),
    "oval": ("600mm", 'shape = "ellipse"\nsemi_major = "330mm"\nsemi_minor = "270mm"'),
    "hinged": ("300mm", 'shape = "mode"\nmode = 1\ndiameter = "300mm"\ns1 = 0.9'),
}


def inspected(shape, more="", **config):
    diameter, section = shape
    scenario = parse(SCENARIO.format(diameter=diameter, section=section, more=more))
    return sl.inspect(simulate(scenario, seed=3), make_config(config), checks=["deflection-5"])


def says(result):
    return [one for one in result.warnings if "leaves its ellipse" in one]


@pytest.mark.parametrize("name", SHAPES)
def test_the_truth_lies_within_what_is_stated(name):
    result = inspected(SHAPES[name])
    assert says(result)[0].startswith("At 130 of 130 stations the wall leaves its ellipse")
    for quantity in ("diameter_area", "diameter_max", "diameter_min", "diameter_x", "diameter_y", "area"):
        truth = np.interp(result.metrics["chainage"], result.truth["chainage"], result.truth[quantity])
        error = np.abs(result.metrics[quantity].values - truth) / result.metrics[f"{quantity}_sigma"].values
        assert (error < 1.96).mean() > 0.9, quantity
    attrs, truth = result.metrics.attrs, float(result.truth["diameter_area"][0])
    assert abs(attrs["diameter_mean"] - truth) < 1.96 * attrs["diameter_sigma"]
    assert json.loads(result.attrs["rules"])[0]["verdict"] == "uncertain"


@pytest.mark.parametrize("name", ROUND)
def test_ellipses_and_hinged_pipes_are_left_as_they_are(name):
    result = inspected(ROUND[name])
    assert not says(result)
    assert result.metrics.attrs["diameter_sigma"] < 0.004 * result.metrics.attrs["diameter_mean"]


def test_neither_a_lateral_nor_a_dent_nor_noise_makes_another_shape():
    more = 'outliers = 0.02\n[[pipe.lateral]]\nchainage = 1.5\nclock_h = 3.0\ndiameter = "150mm"'
    assert not says(inspected(ROUND["circle"], more))
    rough = ROUND["circle"]
    noisy = SCENARIO.replace('noise = "1mm"', 'noise = "8mm"').format(diameter=rough[0], section=rough[1], more="")
    survey = simulate(parse(noisy), seed=5)
    assert not says(sl.inspect(survey))
    one = sl.Survey({"rings": survey.rings.isel(ring=slice(0, 1))}, {"name": "one ring", "nominal_diameter": 0.3})
    assert not says(sl.inspect(one))
