"""Frames of a rendered survey add to what its rings show."""

import re

import numpy as np
import pytest

from springline.config import Config
from springline.errors import InputError, MissingExtraError
from springline.pipeline import inspect
from springline.simulate import Footage, parse, simulate
from springline.stages.images import images

SCENARIO = """
name = "filmed"
[pipe]
diameter = "300mm"
wall_thickness = "25mm"
seed = 5
run = [{ kind = "straight", length = 2.4 }]
lateral = [{ chainage = 1.2, clock_h = 2.0, diameter = "120mm" }]
decoys = { stains = 0.8 }
[robot]
length = 0.8
[rings]
spacing = "10mm"
bearings = 180
[camera]
spacing = "100mm"
width = 640
height = 480
position = [0.2, 0.0, 0.0]
lens = { model = "equidistant", field_of_view_deg = 110.0 }
"""


@pytest.fixture(scope="module")
def filmed():
    made = parse(SCENARIO)
    return simulate(made, seed=5), Footage(made, seed=5)


@pytest.fixture
def looked_at(filmed, monkeypatch):
    """Frames rendered when they are asked for; which ones, and one of them broken."""
    footage, asked = filmed[1], []

    def each_frame(names, folder="."):
        for index, name in enumerate(names):
            asked.append(str(name))
            number = int(str(name).split("/")[-1].split(".")[0]) - 1
            broken = len(asked) == 1
            yield index, InputError("it is cut short") if broken else footage.image(number)[..., ::-1].copy()

    monkeypatch.setattr("springline.imaging.moving.each_frame", each_frame)
    return asked


def test_a_lateral_that_both_show_is_one_feature_and_few_frames_are_looked_at(filmed, looked_at):
    survey = filmed[0]
    result = inspect(survey, Config())
    (told,) = (re.match(r"(\d+) of 16 frames were looked at", one) for one in result.assumptions if "looked at" in one)
    assert 1 <= int(told[1]) <= 0.35 * survey.frames.sizes["frame"]
    assert any("cut short" in sentence for sentence in result.warnings)
    lateral = result.features.isel(feature=result.features["kind"].values.astype(str) == "lateral")
    assert list(lateral["source"].values.astype(str)) == ["both"]
    assert str(lateral["image"].values[0]) in looked_at
    shown = result.candidates.isel(candidate=result.candidates["source"].values.astype(str) == "images")
    best = int(np.argmax(shown["probability"].values))
    assert abs(np.degrees(shown["bearing"].values[best]) - 30.0) < 3.0
    assert abs(shown["size"].values[best] - 0.12) < 0.012


def test_without_opencv_the_inspection_goes_on_and_says_so(filmed, monkeypatch):
    def missing(names, folder="."):
        raise MissingExtraError.of("vision", "working on images")

    monkeypatch.setattr("springline.imaging.moving.each_frame", missing)
    result = inspect(filmed[0], Config())
    assert any("springline[vision]" in sentence for sentence in result.warnings)
    assert set(result.features["source"].values.astype(str)) == {"rings"}


def test_surveys_without_frames_pass_through():
    from springline import builtin_survey, read

    result = inspect(read(builtin_survey()), Config())
    assert images(result, Config()) is result
