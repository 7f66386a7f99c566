"""Frames: repeatable, spoiled as stated, with what is hidden told from what is seen; bad cameras are refused."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from springline.errors import InputError, ParameterError
from springline.simulate import Footage, load, parse, simulate, simulate_to
from springline.simulate.camera.picture import develop, dimming
from springline.simulate.optics import Camera, Dust
from springline.simulate.strewn import cracks, deposits, joints, laterals, stains
from springline.simulate.wall import CRACK, DEPOSIT, JOINT, LATERAL, STAIN
from springline.survey import open_survey

PIPE = """name = "test"
[pipe]
diameter = 0.3
run = [{{kind = "straight", length = 3.0}}]
{pipe}
{more}
[camera]
spacing = 0.25
{size}
{camera}
"""

SMALL = "width = 160\nheight = 120"


def make(camera: str = "", pipe: str = "", more: str = "", size: str = SMALL):
    return parse(PIPE.format(camera=camera, pipe=pipe, more=more, size=size))


def test_a_frame_does_not_depend_on_the_others():
    scenario = make(pipe='material = "clay"\ndecoys = {cracks = 1.0, stains = 1.0, deposits = 1.0}')
    first, again = Footage(scenario, 3), Footage(scenario, 3)
    first.image(0)
    assert np.array_equal(first.image(2), again.image(2))
    assert np.array_equal(first.image(-1), again.image(len(again) - 1))
    assert not np.array_equal(first.image(2), Footage(scenario, 4).image(2))
    assert np.array_equal(first.light(2), Footage(scenario, 4).light(2))
    with pytest.raises(IndexError):
        first.image(len(first))


def test_a_camera_leaves_the_rings_alone():
    alone = simulate(parse(PIPE.format(camera="", pipe="", more="[rings]", size="").split("[camera]")[0]), 5)
    beside = simulate(make(more="[rings]"), 5)
    assert np.array_equal(alone.rings["range"], beside.rings["range"])


def test_frames_are_listed_with_lens_and_truth():
    survey = simulate(make("position = [0.1, 0.02, 0.0]\nerror_pitch_deg = 1.0\nerror_position = [0.0, 0.0, 0.01]"), 1)
    assert survey.frames["path"].values[0] == "frames/000001.jpg"
    assert np.allclose(survey.frames["distance"], 0.25 * np.arange(1, 11))
    assert np.allclose(survey.truth["frame_chainage"], 0.2 + 0.1 + survey.frames["distance"])
    assert np.allclose(survey.truth["frame_offset_y"], 0.02)
    assert np.allclose(survey.truth["frame_offset_z"], 0.01)
    assert np.allclose(survey.truth["frame_pitch"], np.radians(1.0))
    assert '"position_m": [0.1, 0.02, 0.0]' in survey.calibration.attrs["lens"]


def test_noise_exposure_and_gamma_are_as_stated():
    grey = np.full((200, 200, 3), 0.25, np.float32)
    rng = np.random.default_rng(0)
    flat = Camera(width=200, height=200, blur_px=0.0, vignetting=0.0, gamma=1.0, noise=0.02, shot_noise=0.04)
    bright = np.ones((200, 200), np.float32)
    seen = develop(grey, flat, bright, rng) / 255.0
    assert seen.mean() == pytest.approx(0.25, abs=1e-3)
    assert seen.std() == pytest.approx(np.hypot(0.02, 0.04 * 0.5), rel=0.02)
    quiet = flat.model_copy(update={"noise": 0.0, "shot_noise": 0.0, "exposure": 2.0, "gamma": 2.2})
    assert np.all(develop(grey, quiet, bright, rng) == round(255 * 0.5 ** (1 / 2.2)))


def test_blur_and_vignetting_are_as_stated():
    point = np.zeros((61, 61, 3), np.float32)
    point[30, 30] = 1.0
    camera = Camera(width=61, height=61, blur_px=2.0, vignetting=0.4, gamma=1.0, noise=0.0, shot_noise=0.0, exposure=20)
    spread = develop(point, camera, np.ones((61, 61), np.float32), np.random.default_rng(0))[..., 0].astype(float)
    rows = np.arange(61) - 30.0
    assert np.sqrt((spread.sum(axis=1) * rows**2).sum() / spread.sum()) == pytest.approx(2.0, abs=0.1)
    left = dimming(camera, (30.0, 30.0))
    assert left[30, 30] == 1.0
    assert left[0, 0] == pytest.approx(0.6)


def test_motes_and_haze_add_light():
    scenario = make("noise = 0.0\nshot_noise = 0.0")
    dusty = scenario.model_copy(update={"camera": scenario.camera.model_copy(update={"dust": Dust(specks=30.0)})})
    hazy = scenario.model_copy(update={"camera": scenario.camera.model_copy(update={"dust": Dust(haze=0.5)})})
    clear = Footage(scenario).image(3).astype(float)
    more = Footage(dusty).image(3) - clear
    assert more.min() >= 0.0
    assert more.max() > 10.0
    middle = (slice(55, 65), slice(75, 85))
    assert Footage(hazy).image(3)[middle].mean() > clear[middle].mean() + 20.0


def test_beyond_the_view_angle_all_is_black():
    film = Footage(make("lens = {view_angle_deg = 60.0}\nambient = 0.5"))
    light = film.light(2).sum(axis=2)
    column, row = np.meshgrid(np.arange(160) - 79.5, np.arange(120) - 59.5)
    edge = film.lens.k * np.radians(30.0)
    assert np.all(light[np.hypot(column, row) > edge + 1.0] == 0.0)
    assert np.all(light[(np.hypot(column, row) < edge - 1.0) & (np.hypot(column, row) > 30.0)] > 0.0)


def test_water_hides_the_foot_of_a_joint():
    dry = Footage(make(pipe="joint = [{chainage = 1.5, gap = 0.01}]"))
    wet = Footage(make(pipe="joint = [{chainage = 1.5, gap = 0.01}]\nwater = [{depth = 0.04}]"))
    k = int(np.argmin(np.abs(1.5 - dry.chainage - 0.4)))
    for one, other in zip(dry.outlines(k), wet.outlines(k), strict=True):
        assert one.kind == other.kind == "joint"
        assert np.allclose(one.points, other.points, equal_nan=True)
        assert one.seen.all()
        theta = np.degrees(2.0 * np.pi * np.arange(96) / 96)
        # The surface of 40 mm of water stands from 227.2 to 312.8 degrees.
        assert not other.seen[(theta > 231.0) & (theta < 309.0)].any()
        assert other.seen[(theta < 224.0) | (theta > 316.0)].all()


def test_what_stands_in_the_way_hides():
    pipe = "lateral = [{chainage = 1.2, clock_h = 6.0, diameter = 0.12, protrusion = 0.12}]"
    film = Footage(make(pipe=pipe + "\njoint = [{chainage = 1.6}]"))
    k = int(np.argmin(np.abs(1.2 - film.chainage - 0.3)))
    near = [one for one in film.outlines(k) if one.kind == "joint"]
    theta = np.degrees(2.0 * np.pi * np.arange(96) / 96)
    for one in near:
        assert not one.seen[np.abs(theta - 270.0) < 15.0].any()
        assert one.seen[np.abs(theta - 90.0) < 60.0].all()


@pytest.mark.parametrize("from_end", [False, True])
def test_a_lateral_is_dark_within_its_outline_from_either_end(from_end):
    pipe = 'material = "PVC"\nsurface = {dirt = 0.0}\nlateral = [{chainage = 1.4, clock_h = 2.0, diameter = 0.12}]'
    film = Footage(make("ambient = 0.3", pipe, f"[robot]\nfrom_end = {str(from_end).lower()}"))
    survey = simulate(film.world.scenario)
    at = float(survey.truth["feature_chainage"][0])
    k = int(np.argmin(np.abs(at - film.chainage - 0.25)))
    (outline,) = film.outlines(k)
    middle = outline.points.mean(axis=0)
    right = middle[0] > film.centre[0]
    assert right != from_end  # two o'clock lies to the left of one who comes from the end
    light = film.light(k).sum(axis=2)
    inside = light[int(middle[1]), int(middle[0])]
    mirrored = light[int(middle[1]), int(2.0 * film.centre[0] - middle[0])]
    assert inside < 0.5 * mirrored


def test_outlines_of_all_frames_stand_in_the_truth():
    scenario = make(pipe="joints = {spacing = 0.7}\nlateral = [{chainage = 1.4, clock_h = 3.0, diameter = 0.1}]")
    film, truth = Footage(scenario), simulate(scenario).truth
    told = 0
    for k in range(len(film)):
        mine = np.flatnonzero(truth["outline_frame"].values == k)
        for n, one in zip(mine, film.outlines(k), strict=True):
            first, count = int(truth["outline_first"][n]), int(truth["outline_count"][n])
            points = np.stack([truth[f"outline_{axis}"].values[first : first + count] for axis in ("column", "row")], 1)
            assert np.allclose(points, one.points, atol=1e-3, equal_nan=True)
            assert np.array_equal(truth["outline_seen"].values[first : first + count].astype(bool), one.seen)
            kind = int(truth["feature_kind"][int(truth["outline_feature"][n])])
            assert kind == (LATERAL if one.kind == "lateral" else JOINT)
            told += 1
    assert told == truth.sizes["outline"]


def test_streamed_frames_and_outlines_equal_those_made_at_once(tmp_path):
    pytest.importorskip("PIL")
    text = PIPE.format(camera="", more="", size="width = 32\nheight = 24", pipe="joints = {spacing = 0.5}")
    scenario = parse("truth_spacing = 0.002\n" + text.replace("spacing = 0.25", "spacing = 0.05"))
    streamed, made = open_survey(simulate_to(tmp_path / "a.zarr", scenario, 3)), simulate(scenario, 3)
    assert made.truth.sizes["station"] > 1024  # more than one block
    assert len(set(made.truth["outline_frame"].values.tolist())) > 32
    for group, leave in (("truth", ()), ("frames", ("path",)), ("calibration", ())):
        one, two = streamed.group(group).drop_vars(leave), made.group(group).drop_vars(leave)
        assert set(one.variables) == set(two.variables)
        for name in one.variables:
            assert np.array_equal(one[name], two[name], equal_nan=one[name].dtype.kind == "f"), name
    assert streamed.frames["path"].values[0] == "a-frames/000001.jpg"


def test_the_long_sewer_has_what_it_says():
    scenario = load("sewer")
    whole = laterals(scenario.pipe)
    assert len(whole) == 60
    assert len(joints(scenario.pipe)) == 200
    at = np.array([joint.chainage for joint in joints(scenario.pipe)])
    for one in whole:
        reach = 0.5 * one.diameter / np.cos(np.radians(one.inclination_deg))
        assert np.abs(at - one.chainage).min() > reach


def test_what_is_strewn_has_its_density_and_stands_in_the_truth():
    pipe = "decoys = {cracks = 3.0, stains = 2.0, deposits = 1.0}\nseed = 4"
    text = PIPE.format(camera="", pipe=pipe, more="", size="")
    text = text.replace("spacing = 0.25", "spacing = 50.0").replace("length = 3.0", "length = 200.0")
    scenario = parse("truth_spacing = 10.0\n" + text)
    kinds = simulate(scenario).truth["feature_kind"].values
    for kind, strewn, density in ((CRACK, cracks, 3.0), (STAIN, stains, 2.0), (DEPOSIT, deposits, 1.0)):
        count = len(strewn(scenario.pipe))
        assert (kinds == kind).sum() == count
        assert abs(count - 200.0 * density) < 4.0 * np.sqrt(200.0 * density)


def test_a_camera_outside_the_pipe_is_refused():
    with pytest.raises(ParameterError, match=r"camera: it stands outside the pipe, at chainage"):
        Footage(make(more="[robot]\noffset_y = 0.1", camera="position = [0.0, 0.08, 0.0]"))
    with pytest.raises(ParameterError, match=r"camera\.laser: it stands outside the pipe"):
        Footage(make(camera="laser = {ahead = 0.5}"))
    with pytest.raises(ParameterError, match="no camera"):
        Footage("reference-ring")


def test_without_pillow_the_extra_is_named(monkeypatch, tmp_path):
    from springline.simulate.camera.writing import write_frames

    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(InputError, match=r"springline\[depth\]"):
        write_frames(Footage(make()), tmp_path / "frames")


def test_bends_and_eggs_are_filmed_too():
    text = PIPE.format(camera="", pipe="", more="[robot]\nlength = 0.2\nwheelbase = 0.1", size=SMALL)
    bent = parse(text.replace('{kind = "straight", length = 3.0}', '{kind = "bend", radius = 1.0, angle_deg = 90.0}'))
    egg = make(pipe='section = [{shape = "egg", width = 0.3, height = 0.45, invert_radius = 0.075}]')
    for scenario in (bent, egg):
        light = Footage(scenario).light(1)
        assert np.isfinite(light).all()
        assert (light.sum(axis=2) > 0.0).mean() > 0.9


def test_interpolated_wall_equals_rays_cast_one_by_one():
    from springline.simulate.camera import render

    film = Footage(make(size=""))
    wall, sight = film.in_sight(2), film.camera.sight
    at = (wall, film.origin[2], film.cell[2], film.axes[2], film._rays)
    exact = render._cast(*at, 1, sight)[0][:-1, :-1]
    reach = render._cast(*at, render.BLOCK, sight)[0]
    # Half-way between nodes, where interpolation is worst.
    between = 4.0 / (1 / reach[:-1, :-1] + 1 / reach[1:, :-1] + 1 / reach[:-1, 1:] + 1 / reach[1:, 1:])
    # The last nodes stand closer, at the picture's edge.
    true, between = exact[2::4, 2::4][:-1, :-1], between[:-1, :-1]
    error = np.abs(between[: true.shape[0], : true.shape[1]] / true - 1.0)
    assert np.nanmax(error[true < 0.5]) < 5e-4
    assert np.nanmax(error[true < 0.2]) < 1e-4


REFUSED = [
    ("sight = -1", ("camera.sight", "-1", "above 0")),
    ("lense = 3", ("camera.lense", "did you mean 'lens'?")),
    ("lens = {model = 'fish'}", ("camera.lens.model", "'fish'", "'equidistant', 'sine'")),
    ("lens = {model = 'perspective', field_of_view_deg = 180}", ("field_of_view_deg", "180", "below 180")),
    ("lens = {model = 'sine', field_of_view_deg = 200}", ("field_of_view_deg", "200", "at most 180")),
    ("lens = {coefficients = [0.1]}", ("camera.lens.coefficients", "only model = 'polynomial'")),
    ("lens = {model = 'polynomial', coefficients = [-0.5]}", ("field_of_view_deg", "at most 93.5636")),
    ("lens = {centre_px = [900, 1]}", ("camera.lens.centre_px", "900", "0 to 159")),
    ("position = [0.0, 0.2, 0.0]", ("camera.position", "0.2", "radius, 0.15 m")),
    ("lamp = []", ("camera.lamp", "nothing gives light")),
    ("lamp = [{position = [0.0, 0.0, 1.0]}]", ("camera.lamp[1].position", "radius, 0.15 m")),
    ("laser = {ahead = 10.0}", ("camera.laser.ahead", "10", "below the camera's sight, 6 m")),
    ("laser = {power = -1}", ("camera.laser.power", "-1", "at least 0")),
    ("lens = 5", ("camera.lens", "5", "a table")),
    ("noise = -0.1", ("camera.noise", "-0.1", "at least 0")),
]


@pytest.mark.parametrize(("line", "needles"), REFUSED)
def test_a_bad_camera_is_refused_with_key_line_value_and_range(line, needles):
    with pytest.raises(ParameterError) as caught:
        make(line)
    for needle in ("line ", *needles):
        assert needle in str(caught.value)


def test_bad_things_on_the_wall_are_refused():
    for pipe, needles in (
        ("laterals = {spacing = 0.5, diameters = [0.4]}", ("laterals", "larger than the pipe", "0.3 m")),
        ("crack = [{chainage = 9.0, clock_h = 3.0, length = 0.2}]", ("pipe.crack[1].chainage", "9", "3 m")),
        ("stain = [{chainage = 1.0, clock_h = 3.0, length = 0.2, width_deg = 0}]", ("width_deg", "above 0")),
        ("surface = {look = 'wood'}", ("pipe.surface.look", "'wood'", "'clay', 'concrete' or 'pvc'")),
        ("decoys = {cracks = -1}", ("pipe.decoys.cracks", "-1", "at least 0")),
    ):
        with pytest.raises(ParameterError) as caught:
            make(pipe=pipe)
        for needle in ("line ", *needles):
            assert needle in str(caught.value)
