"""`springline calibrate lens` from tables; what is no lens is refused, and nothing is left behind."""

import tomllib
from functools import partial

import numpy as np
import pytest

from . import command_line

run = partial(command_line.run, "calibrate", "lens")


@pytest.fixture
def pairs(tmp_path):
    """Pairs of an equisolid lens of k = 700 px with 0.5 px of noise."""
    zenith = np.arange(1.0, 80.0)
    radius = 700.0 * np.sin(np.radians(zenith) / 2) + np.random.default_rng(1).normal(0, 0.5, len(zenith))
    path = tmp_path / "pairs.csv"
    path.write_text("zenith_deg,radius_px\n" + "".join(f"{z},{r:.3f}\n" for z, r in zip(zenith, radius, strict=True)))
    return path


def test_pairs_become_a_lens_that_a_survey_can_hold(pairs, tmp_path):
    code, out, _ = run(pairs, "--size", "1280x960", "-o", tmp_path / "lens.toml", "--name", "front")
    assert code == 0 and "equisolid" in out
    lens = tomllib.loads((tmp_path / "lens.toml").read_text())["lens"]["front"]
    assert lens["model"] == "equisolid"
    assert abs(lens["k_px"] - 700.0) < 4.0 * lens["sigma"]["k_px"] < 2.0
    assert (lens["width_px"], lens["height_px"]) == (1280, 960)


def test_joints_become_a_lens(tmp_path):
    path, rng = tmp_path / "joints.csv", np.random.default_rng(2)
    rows = [
        f"{name},{s:.3f},{400.0 * np.arctan(0.15 / (at - s)) + rng.normal(0, 0.3):.3f}\n"
        for name, at in (("A", 1.0), ("B", 2.0), ("C", 3.0))
        for s in np.arange(at - 0.8, at - 0.08, 0.02)
    ]
    path.write_text("joint,distance_m,radius_px\n" + "".join(rows))
    code, out, _ = run(path, "--diameter", "300mm", "--size", "640x480", "-o", tmp_path / "lens.toml")
    assert code == 0 and "equidistant" in out
    assert tomllib.loads((tmp_path / "lens.toml").read_text())["lens"]["camera"]["k_px"] == pytest.approx(
        400.0, rel=0.01
    )


@pytest.mark.parametrize(
    ("text", "words", "said"),
    [
        ("zenith_deg,radius_px\n1,2\n", ("--size", "640x480"), "too few pairs: 1 usable"),
        ("zenith_deg,radius\n1,2\n", ("--size", "640x480"), "the column 'radius_px' is missing"),
        ("zenith_deg,radius_px,x\n1,2,3\n", ("--size", "640x480"), "unknown column 'x'"),
        ("zenith_deg,radius_px\n1,two\n", ("--size", "640x480"), "row 2, column radius_px: the cell 'two'"),
        ("zenith_deg,radius_px\n1,2\n", (), "the pictures' size is missing"),
        ("zenith_deg,radius_px\n1,2\n", ("--size", "640"), "--size: '640' cannot be used"),
        ("zenith_deg,radius_px\n1,2\n", ("--board", "9x6", "--diameter", "300mm"), "do not go together"),
        ("zenith_deg,radius_px\n1,2\n", ("--board", "9x6"), "the side of a square is missing"),
    ],
)
def test_what_cannot_be_used_is_refused_and_leaves_nothing(tmp_path, text, words, said):
    path = tmp_path / "table.csv"
    path.write_text(text)
    code, _, err = run(path, *words, "-o", tmp_path / "lens.toml")
    assert code == 2 and said in " ".join(err.split())
    assert not (tmp_path / "lens.toml").exists()
