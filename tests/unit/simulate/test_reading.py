"""Scenarios: what is refused says which key, on which line, with which value, and what would do."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from springline.errors import FormatError, InputError, ParameterError
from springline.simulate import Scenario, load, parse, scenarios
from springline.simulate.checks import longest_robot

GOOD = """name = "test"

[pipe]
diameter = "300mm"
run = [
    { kind = "straight", length = 5.0 },
]

[[pipe.lateral]]
chainage = 2.0
clock_h = 2
diameter = 0.1

[robot]
length = 0.4
wheelbase = 0.3

[rings]
noise = 0.001
"""


def refused(old: str, new: str, *needles: str, error: type[Exception] = ParameterError) -> None:
    assert old in GOOD
    text = GOOD.replace(old, new)
    with pytest.raises(error) as caught:
        parse(text, where="my.toml")
    for needle in ("my.toml", *needles):
        assert needle in str(caught.value)


def test_the_good_scenario_is_good():
    scenario = parse(GOOD)
    assert scenario.pipe.diameter == 0.3
    assert load(scenario) == scenario


def test_ready_scenarios_are_sound():
    assert len(scenarios()) >= 8
    for name, description in scenarios().items():
        assert description
        assert isinstance(load(name), Scenario)


def test_an_unknown_key_names_its_nearest_neighbour():
    refused("noise =", "noice =", "line 19", "rings.noice", "0.001", "did you mean 'noise'?")
    refused("clock_h = 2", "clock = 2", "line 11", "pipe.lateral[1].clock", "did you mean 'clock_h'?")
    refused("[robot]", "[robott]", "line 14", "robott", "did you mean 'robot'?")


def test_single_values_out_of_range():
    refused("noise = 0.001", "noise = -0.001", "line 19", "rings.noise", "-0.001", "at least 0")
    refused("length = 5.0", "length = 0", "line 6", "pipe.run[1].length", "above 0")
    refused("clock_h = 2", "clock_h = 13", "line 11", "at most 12")
    refused('diameter = "300mm"', 'diameter = "300 furlongs"', "line 4", "pipe.diameter", "furlongs")
    refused("noise = 0.001", "noise = nan", "line 19", "rings.noise")
    refused("noise = 0.001", "bearings = 3.5", "line 19", "rings.bearings")
    refused("[rings]\nnoise = 0.001\n", "", "rings", "at least one of rings, rings_rear, depth_camera")
    refused('name = "test"\n', "", "name", "missing")


@pytest.mark.parametrize(
    ("line", "needles"),
    [
        ("offset_y = [[1.0, 0.0], [0.5, 0.0]]", ("robot.offset_y", "increase")),
        ("offset_y = [1, 2]", ("robot.offset_y[1] = 1",)),
        ("offset_y = [[0.0, nan]]", ("robot.offset_y[1][2] = nan", "finite")),
        ("offset_y = {amplitude = 0.01, period = 0}", ("robot.offset_y.period = 0", "above 0")),
        ("roll_deg = nan", ("robot.roll_deg = nan", "finite")),
        ("yaw_deg = {amplitud = 1.0}", ("unknown key 'robot.yaw_deg.amplitud'", "did you mean 'amplitude'?")),
        ("offset_y = true", ("robot.offset_y = True", "a number")),
        ("standstill = [{chainage = 2.0, duration = inf}]", ("standstill[1].duration = inf", "at most 1000000")),
    ],
)
def test_what_varies_is_complained_of_in_the_form_that_it_has(line, needles):
    refused("wheelbase = 0.3", f"wheelbase = 0.3\n{line}", "line 17", *needles)


def test_a_wave_may_have_a_unit():
    text = GOOD.replace("wheelbase = 0.3", 'wheelbase = 0.3\noffset_z = {waves = [{amplitude = "5mm", period = 2.0}]}')
    assert parse(text).robot.offset_z.waves[0].amplitude == 0.005


def test_values_of_the_wrong_number_and_keys_of_another_kind():
    refused("noise = 0.001", "position = [0.1, 0.0]", "line 19", "rings.position = [0.1, 0.0]", "at least 3 values")
    refused("length = 5.0", "length = 5.0, radius = 1.0", "line 6", "pipe.run[1].radius", "one of kind, length")


@pytest.mark.parametrize(
    ("old", "new", "needles"),
    [
        ("noise = 0.001", "spacing = 1e-12", ("line 19", "rings.spacing = 1e-12", "at least")),
        ("noise = 0.001", "[camera]\nspacing = 1e-12", ("line 20", "camera.spacing = 1e-12", "at least")),
        (
            "wheelbase = 0.3",
            "wheelbase = 0.3\nspeed = 1e-6\n[inertial]\nrate = 2000.0",
            ("line 19", "inertial.rate = 2000"),
        ),
        ("length = 5.0", "length = 1e9", ("line 6", "pipe.run[1].length", "at most 1e+06 m")),
        ('kind = "straight", length = 5.0', 'kind = "bend", radius = 1e300, angle_deg = 1.0', ("pipe.run[1].radius",)),
        ("noise = 0.001", "position = [100.0, 0.0, 0.0]", ("rings.position", "outside the pipe's ends")),
    ],
)
def test_what_no_machine_could_hold_is_refused_at_once(old, new, needles):
    refused(old, new, *needles)


def test_a_run_of_no_known_kind():
    refused('kind = "straight"', 'kind = "curve"', "line 6", "pipe.run[1].kind = 'curve'", "'straight' or 'bend'")
    refused('kind = "straight", ', "", "pipe.run[1].kind", "'straight' or 'bend'")


def test_a_bend_tighter_than_the_pipe_radius():
    tight = '{ kind = "bend", radius = 0.14, angle_deg = 90.0 }'
    refused('{ kind = "straight", length = 5.0 }', tight, "line 6", "pipe.run[1].radius = 0.14", "above 0.15 m",
            "tighter than the pipe radius")  # fmt: skip


def test_a_lateral_larger_than_the_pipe():
    refused("diameter = 0.1", "diameter = 0.31", "line 12", "pipe.lateral[1].diameter = 0.31", "below", "0.3 m")


def test_a_robot_longer_than_the_bend_allows():
    bend = '{ kind = "straight", length = 5.0 },\n    { kind = "bend", radius = 0.2, angle_deg = 90.0 }'
    most = longest_robot(0.2, 0.15, 0.05)
    text = GOOD.replace('{ kind = "straight", length = 5.0 }', bend).replace("length = 0.4", "length = 0.7")
    with pytest.raises(ParameterError, match=r"line 16: robot.length = 0.7 is longer than the bend") as caught:
        parse(text)
    assert f"at most {most:.3f} m" in str(caught.value)
    # The box of that length, its inner side on the inner wall, has its outer corners on the outer wall.
    assert (0.05 + 0.1) ** 2 + (0.5 * most) ** 2 == pytest.approx(0.35**2)


@pytest.mark.parametrize(
    ("table", "needles"),
    [
        ("sag = [{chainage = 4.9, length = 1.0, depth = 0.01}]", ("sag[1].chainage", "0 to 5 m")),
        ("sag = [{chainage = 2.0, length = 1.0, depth = 0.2}]", ("sag[1].depth", "0.125 m")),
        ("dent = [{chainage = 6.0, clock_h = 1, depth = 0.01, length = 0.1, width_deg = 10}]", ("dent[1]", "5 m")),
        ("dent = [{chainage = 2.0, clock_h = 1, depth = 0.2, length = 0.1, width_deg = 10}]", ("depth", "0.15 m")),
        ("water = [{depth = 0.16}]", ("water[1].depth = 0.16", "0.15 m")),
        ("section = [{shape = 'mode', mode = 4, s1 = 0.99, s02 = 0.9}]", ("section[1].s1", "0.99")),
        ("section = [{shape = 'egg', width = 0.3}]", ("section[1].height", "invert_radius")),
        ("section = [{shape = 'egg', width = 0.3, height = 0.2, invert_radius = 0.05}]", ("section[1].shape",)),
        ("section = [{shape = 'eg'}]", ("section[1].shape", "'egg'")),
        ("section = [{shape = 'circle', end = 3}, {shape = 'circle', start = 2}]", ("section[2].start", "3 m")),
        ("joint = [{chainage = 2.0}, {chainage = 2.003}]", ("joint[2].chainage", "2.003")),
        ("joints = {spacing = 0.001}", ("joints.spacing", "0.001")),
        ("joints = {spacing = 1e-9, gap = 0}", ("joints.spacing = 1e-09", "at least")),
        ("joints = {spacing = 1.0, spacing_sigma = 100.0}", ("joints.spacing", "smaller spacing_sigma")),
        ("joints = {spacing = 1.0, offset_sigma = 10.0}", ("joints.offset_sigma = 10", "0.15 m")),
        ("joints = {spacing = 1.0, kink_sigma_deg = 100.0}", ("joints.kink_sigma_deg", "at most 4")),
        ("laterals = {spacing = 1e-9}", ("laterals.spacing = 1e-09", "at least")),
        ("decoys = {cracks = 1e9}", ("decoys.cracks", "at most 20000 per metre")),
        ("harmonic = [{order = 2, amplitude = 0.1}, {order = 3, amplitude = 0.06}]",
         ("harmonic[2].amplitude", "0.05 m")),
        ("water = [{start = 7.0, depth = 0.1}]", ("water[1].start = 7", "5 m")),
        ("roughness = {rms = 0.001, along = 1e-300}", ("roughness.along", "at least")),
        ("section = [{shape = 'circle', diameter = [[0, 0.3], [1, -0.3]]}]", ("section[1].diameter = -0.3", "above 0")),
        ("section = [{shape = 'ellipse', semi_major = 0.15, semi_minor = 0}]", ("section[1].semi_minor", "above 0")),
        ("lobe = [{start = 1, end = 2, depth = 0.02, width_deg = 60, form = 'varying', clock_h = 3}]\n"
         "section = [{shape = 'mode', mode = 1, s1 = 0.9}]", None),
        ("lobe = [{start = 1, end = 2, depth = 0.02, width_deg = 60, form = 'varying', clock_h = 2}]\n"
         "section = [{shape = 'mode', mode = 1, s1 = 0.9}]", ("lobe[1].clock_h", "radii")),
    ],
)  # fmt: skip
def test_impossible_pipes(table, needles):
    text = GOOD.replace("[[pipe.lateral]]", f"{table}\n\n[[pipe.lateral]]")
    if needles is None:
        parse(text)
        return
    with pytest.raises(ParameterError) as caught:
        parse(text)
    for needle in ("line ", *needles):
        assert needle in str(caught.value)


@pytest.mark.parametrize(
    ("table", "needles"),
    [
        ("[robot]\nlength = 6.0", ("robot.length", "5 m")),
        ("[robot]\nlength = 0.4\nhalf_span = 0.15", ("robot.half_span", "0.15 m")),
        ("[robot]\nlength = 0.4\noffset_z = {amplitude = 0.2, period = 2}", ("robot.offset_z", "0.2")),
        ("[robot]\nlength = 0.4\nstandstill = [{chainage = 4.9, duration = 5}]", ("standstill[1].chainage", "4.8 m")),
        ("[odometer]\nslip = [{chainage = 2, length = 0.1, extra = -0.2}]\n[robot]\nlength = 0.4", ("slip[1].extra",)),
        ("[odometer]\nslip = [{chainage = 2, extra = 1e300}]\n[robot]\nlength = 0.4", ("slip[1].extra", "5 m")),
        ("[odometer]\nnoise = 1e9\n[robot]\nlength = 0.4", ("odometer.noise", "at most 1")),
        ("[odometer]\nslip = [{chainage = 9, extra = 0.1}]\n[robot]\nlength = 0.4", ("slip[1].chainage", "5 m")),
        ("[camera]\nlens = {k_px = 90, field_of_view_deg = 90}\n[robot]\nlength = 0.4", ("lens.k_px", "not both")),
        ("[camera]\nlens = {k_px = inf}\n[robot]\nlength = 0.4", ("lens.k_px = inf", "finite")),
        ("[camera]\ndust = {specks = 1e12}\n[robot]\nlength = 0.4", ("dust.specks", "at most 10000")),
        ("[camera]\nlamp = [{half_angle_deg = 1e-9}]\n[robot]\nlength = 0.4", ("half_angle_deg", "at least 1")),
        ("[ties]\nchainages = [0.0, 7.0]\n[robot]\nlength = 0.4", ("ties.chainages = 7", "5 m")),
        ("[camera]\nlense = 3\n[robot]\nlength = 0.4", ("camera.lense", "did you mean 'lens'?")),
    ],
)
def test_impossible_equipment(table, needles):
    text = GOOD.replace("[robot]\nlength = 0.4\nwheelbase = 0.3", table + "\nwheelbase = 0.3")
    with pytest.raises(ParameterError) as caught:
        parse(text)
    for needle in ("line ", *needles):
        assert needle in str(caught.value)


def test_an_upright_pipe_has_no_crown():
    bends = '{ kind = "bend", radius = 1.0, angle_deg = 80.0, towards = "up" }'
    refused('{ kind = "straight", length = 5.0 }', bends, "pipe.run[1].angle_deg", "75 degrees")


def test_files_that_are_not_there_or_not_toml(tmp_path):
    with pytest.raises(InputError, match="did you mean 'weaving'"):
        load("weavin")
    path = tmp_path / "bad.toml"
    path.write_text("name = [", encoding="utf-8")
    with pytest.raises(FormatError, match=r"bad\.toml"):
        load(path)
    path.write_bytes("name = 'Stra\xdfe'".encode("latin-1"))
    with pytest.raises(FormatError, match=r"bad\.toml: not a text in UTF-8"):
        load(path)
    path.write_bytes(b"\xef\xbb\xbf" + GOOD.encode())  # as some editors begin a file
    assert load(path) == parse(GOOD)


def test_the_manual_is_made_from_the_models():
    root = Path(__file__).parents[3]
    spec = importlib.util.spec_from_file_location("make_scenarios", root / "docs" / "make_scenarios.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    assert (root / "docs" / "scenarios.md").read_text(encoding="utf-8") == module.page()
