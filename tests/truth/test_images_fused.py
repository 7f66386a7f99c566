"""Frames and rings of a rendered sewer, as it would be inspected; and its frames alone, by the command line."""

import csv
import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

pytest.importorskip("cv2", reason="needs the extra 'vision'")

from springline.cli.detect import app
from springline.config import Config, TextureConfig
from springline.imaging.frames import write_picture
from springline.pipeline import inspect
from springline.simulate import Footage, load, simulate
from springline.simulate.truth import feature_table

LENGTH = 16.0
CODES = {"joint": 5, "lateral": 6}


@pytest.fixture(scope="module")
def sewer():
    scenario = load("sewer")
    pipe = scenario.pipe.model_copy(
        update={"seed": 401, "run": (scenario.pipe.run[0].model_copy(update={"length": LENGTH}),)}
    )
    scenario = scenario.model_copy(update={"pipe": pipe})
    return simulate(scenario, 3), Footage(scenario, 3)


@pytest.fixture
def rendered(sewer, monkeypatch):
    """Frames are rendered when they are asked for."""
    asked = []

    def each_frame(names, folder="."):
        for index, name in enumerate(names):
            asked.append(str(name))
            number = int(str(name).split("/")[-1].split(".")[0]) - 1
            yield index, sewer[1].image(number)[..., ::-1].copy()

    monkeypatch.setattr("springline.imaging.moving.each_frame", each_frame)
    return asked


def _truth(footage, kind):
    """What the counter reads where each joint or lateral is, with its bearing and size."""
    table = feature_table(footage.world)
    ahead = footage.camera.position[0]
    chosen = table["kind"] == CODES[kind]
    x = footage.world.counter.reading(table["chainage"][chosen] - ahead) + ahead
    return x, table["bearing"][chosen], table["size"][chosen]


def test_rings_and_few_frames_find_what_is_there(sewer, rendered):
    survey, footage = sewer
    result = inspect(survey, Config(texture=TextureConfig(lay=False)))
    (told,) = (re.match(r"(\d+) of (\d+) frames were looked at", one) for one in result.assumptions if "looked" in one)
    assert int(told[1]) == len(rendered) <= 0.2 * int(told[2])
    found, kinds = result.features, result.features["kind"].values.astype(str)
    for kind in CODES:
        x, bearing, size = _truth(footage, kind)
        rows = np.flatnonzero((kinds == kind) & (found["chainage"].values < LENGTH - 0.1))
        apart = np.abs(found["chainage"].values[rows][:, None] - x)
        assert (apart.min(axis=1) < 0.02).all()
        assert (apart.min(axis=0) < 0.02).mean() >= 0.9
        if kind == "lateral":
            nearest = apart.argmin(axis=1)
            assert len(set(nearest)) == len(x) == len(rows)
            turn = (found["bearing"].values[rows] - bearing[nearest] + np.pi) % (2.0 * np.pi) - np.pi
            assert np.abs(np.degrees(turn)).max() < 1.5
            assert np.abs(found["size"].values[rows] / size[nearest] - 1.0).max() < 0.05
            # the roll is not seen by rings; its sigma is that of the water's level, no longer that of a robot
            assert found["bearing_sigma"].values[rows].max() < np.radians(1.5)
    assert "both" in set(found["source"].values.astype(str))


def test_frames_alone_are_placed_on_the_pipe(sewer, tmp_path):
    footage = sewer[1]
    folder = tmp_path / "filmed"
    (folder / "frames").mkdir(parents=True)
    numbers = range(2, 18)
    for k in numbers:
        write_picture(folder / "frames" / f"{k}.png", footage.image(k)[..., ::-1].copy())
    rows = "".join(f"{footage.distance[k]:.3f},frames/{k}.png,camera\n" for k in numbers)
    (folder / "frames.csv").write_text("distance_m,file,lens\n" + rows)
    lens = "".join(f"{key} = {json.dumps(value)}\n" for key, value in footage.lens_table().items())
    (folder / "survey.toml").write_text(f'name = "filmed"\n[parts]\nframes = "frames.csv"\n[lens.camera]\n{lens}')
    done = CliRunner().invoke(app, [str(folder), "--nominal", "300mm", "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    with (tmp_path / "out" / "features.csv").open() as table:
        found = [(row["kind"], float(row["chainage_m"])) for row in csv.DictReader(table)]
    seen = (footage.distance[numbers[0]] + 0.55, footage.distance[numbers[-1]] + 0.45)
    for kind, near in (("joint", 0.02), ("lateral", 0.06)):
        there = _truth(footage, kind)[0]
        got = np.array([x for name, x in found if name == kind])
        inside = there[(there > seen[0]) & (there < seen[1])]
        assert len(inside)
        assert (np.abs(got[:, None] - there).min(axis=1) < near).all()
        assert (np.abs(inside[:, None] - got).min(axis=1) < near).mean() >= 0.7
    refused = CliRunner().invoke(app, [str(folder), "-o", str(tmp_path / "other")])
    assert refused.exit_code == 0
    assert "diameter is not known" in refused.stderr
    assert not (tmp_path / "other" / "features.csv").exists()
