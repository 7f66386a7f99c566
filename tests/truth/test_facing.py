"""A robot that is pulled back is told as one that was turned round: one pipe, robot and path, simulated as both."""

import numpy as np
import pytest

import springline as sl
from springline.errors import InputError
from springline.io import write
from springline.simulate import parse, simulate
from springline.stages.facing import facing

SCENARIO = """
name = "two ways to face"
[pipe]
diameter = "300mm"
heading_deg = 30.0
gradient = -0.01
run = [{{ kind = "straight", length = 3.0 }}]
[[pipe.section]]
shape = "ellipse"
semi_major = 0.154
semi_minor = 0.147
axis_deg = 25.0
[robot]
length = 0.5
offset_z = {{ amplitude = 0.02, period = 2.0 }}
offset_y = {{ amplitude = 0.004, period = 1.3 }}
roll_deg = {{ amplitude = 3.0, period = 1.7 }}
from_end = true
backwards = {backwards}
[rings]
spacing = "20mm"
bearings = 180
noise = "0.001mm"
position = [{x}, 0.02, {z}]
[inertial]
rate = 50.0
output = "{output}"
[ties]
chainages = [0.25, 2.7]
sigma = "1mm"
"""


def both(output="rates"):
    forwards = SCENARIO.format(backwards="false", x=0.1, z=0.01, output=output)
    backwards = SCENARIO.format(backwards="true", x=-0.1, z=-0.01, output=output)
    return simulate(parse(forwards), seed=3), simulate(parse(backwards), seed=3)


@pytest.mark.parametrize("output", ["rates", "attitude"])
def test_it_measures_what_a_robot_turned_round_measures(output):
    forwards, backwards = both(output)
    told = facing(backwards)
    np.testing.assert_allclose(told.rings["bearing"], forwards.rings["bearing"], atol=1e-12)
    np.testing.assert_allclose(told.rings["range"], forwards.rings["range"], atol=2e-5)
    for name in ("gyro", "accel") if output == "rates" else ("heading", "inclination", "bank"):
        np.testing.assert_allclose(told.inertial[name], forwards.inertial[name], atol=1e-9)
    assert [told.rings.attrs[f"position_{k}"] for k in "xyz"] == [0.1, 0.02, 0.01]
    assert told.attrs["facing"] == "forwards"
    # Told once, not twice.
    np.testing.assert_array_equal(facing(told).rings["range"], told.rings["range"])


def test_a_counter_that_runs_back_counts_on(tmp_path):
    _, backwards = both()
    ends = {name: backwards.group(name)["distance"] for name in ("rings", "ties")}
    groups = {name: backwards.group(name) for name in backwards.groups if name != "truth"}
    groups |= {name: groups[name].assign(distance=(d.dims, 7.0 - d.values)) for name, d in ends.items()}
    write(sl.Survey(groups, backwards.attrs), tmp_path / "back.zarr.zip")
    result, same = sl.inspect(sl.read(tmp_path / "back.zarr.zip")), sl.inspect(backwards)
    np.testing.assert_allclose(result.pose["yaw"], same.pose["yaw"], atol=2e-4)
    np.testing.assert_allclose(result.layout["elevation"], same.layout["elevation"], atol=1e-4)
    truth = backwards.truth
    assert np.sqrt(np.mean((same.pose["offset_z"].values - truth["offset_z"].values) ** 2)) < 0.05e-3
    with pytest.raises(InputError, match="distances decrease"):
        sl.inspect(sl.Survey(groups, {**backwards.attrs, "facing": "forwards"}))


def test_a_survey_folder_says_which_way_it_faced(tmp_path):
    _, backwards = both()
    write(backwards, tmp_path / "folder")
    assert sl.read(tmp_path / "folder").attrs["facing"] == "backwards"
    text = (tmp_path / "folder" / "survey.toml").read_text()
    (tmp_path / "folder" / "survey.toml").write_text(text.replace('"backwards"', '"sideways"'))
    with pytest.raises(InputError, match="facing: 'sideways' is unknown"):
        sl.read(tmp_path / "folder")
    with pytest.raises(InputError, match="'sideways' is no way to face"):
        facing(sl.Survey({}, {"facing": "sideways"}))
