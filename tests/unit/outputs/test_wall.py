"""The unrolled wall and the mesh made of it, against the formulas that the survey was made from."""

import numpy as np
import pytest
import trimesh

from springline.conventions import bearing_from_clock
from springline.outputs.colours import levels, nice_limit
from springline.outputs.mesh import write_glb
from springline.outputs.results import Results
from springline.outputs.unroll import NO_SECTION, unroll

from .finished import NOISE, finished_survey


@pytest.fixture(scope="module")
def wall(survey):
    return unroll(Results(survey))


def at(wall, chainage):
    return int(np.argmin(np.abs((wall.start + wall.end) / 2 - chainage)))


def test_shape_is_the_departure_from_the_circle_about_the_sections_centre(wall):
    row = wall.shape[at(wall, 20.0)]
    turn = 0.2 + 0.4 * np.sin(20.0 / 9.0)
    expected = 0.006 * np.cos(2 * (wall.bearing - turn))
    water = wall.reason[at(wall, 20.0)] != 0
    np.testing.assert_allclose(row[~water], expected[~water], atol=6 * NOISE)


def test_surface_shows_the_dent_where_it_is_and_little_else(wall):
    deepest = np.unravel_index(np.nanargmin(wall.surface), wall.surface.shape)
    assert (wall.start + wall.end)[deepest[0]] / 2 == pytest.approx(18.0, abs=0.1)
    # The dent was made 2 o'clock of the sensor, which stands off the axis.
    theta, x = bearing_from_clock(2.0), 18.0
    seen_from_axis = np.arctan2(
        0.15 * np.sin(theta) - (0.012 + 0.004 * np.sin(x / 3)), 0.15 * np.cos(theta) - (-0.006 + 0.003 * np.cos(x / 4))
    )
    assert wall.bearing[deepest[1]] == pytest.approx(seen_from_axis, abs=0.1)
    assert wall.surface[deepest] == pytest.approx(-0.009, abs=4 * NOISE)
    assert np.nanmax(np.abs(wall.surface[: at(wall, 16.0)])) < 6.5 * NOISE


def test_nothing_is_filled_in_and_each_empty_cell_has_its_reason(wall):
    assert np.isnan(wall.shape[wall.reason != 0]).all() and np.isfinite(wall.shape[wall.reason == 0]).all()
    invert = int(np.argmin(np.abs(wall.bearing - 1.5 * np.pi)))
    left = int(np.argmin(np.abs(wall.bearing - np.pi)))
    assert wall.reason[at(wall, 23.0), invert] == 3
    assert wall.reason[at(wall, 7.3), left] == 1
    assert wall.reason[at(wall, 12.2), 5] == NO_SECTION
    gap = wall.columns(np.linspace(26.9, 27.6, 8))
    assert (gap.reason[2:5] == 255).all() and np.isnan(gap.shape[2:5]).all()


def test_joining_stations_keeps_the_worst(survey, wall):
    few = unroll(Results(survey), cells=wall.bearing.size * 60)
    assert len(few.start) <= 64
    assert np.nanmin(few.surface) == np.nanmin(wall.surface) and np.nanmax(few.shape) == np.nanmax(wall.shape)
    pixels = wall.columns(np.linspace(0.0, 30.0, 31))
    assert np.nanmin(pixels.surface) == np.nanmin(wall.surface)
    # A joined group never reaches across a gap.
    assert not ((few.start < 27.1) & (few.end > 27.4)).any()


def test_a_sensor_far_off_the_axis_leaves_no_false_hole():
    survey = finished_survey(stations=4, bearings=360, dense=True)
    rings = survey.rings
    theta, centre = rings["bearing"].values, 0.06
    exact = centre * np.sin(theta) + np.sqrt(0.15**2 - (centre * np.cos(theta)) ** 2)
    # /section says where the centre is; shape and size follow from the readings alone.
    section = survey.section.assign(centre_y=("station", np.full(4, centre)), centre_z=("station", np.zeros(4)))
    rings = rings.assign(range=(("ring", "bearing"), np.tile(exact, (4, 1)).astype(np.float32)))
    mask = survey.mask.assign(reason=(("ring", "bearing"), np.zeros((4, 360), np.uint8)))
    from springline.survey import Survey

    groups = {n: survey.group(n) for n in survey.groups} | {"rings": rings, "mask": mask, "section": section}
    wall = unroll(Results(Survey(groups)))
    assert (wall.reason == 0).all()
    np.testing.assert_allclose(wall.shape + wall.circle_diameter / 2, 0.15, atol=1e-6)


def test_mesh_opens_elsewhere_with_the_right_size_axes_and_holes(wall, tmp_path):
    write_glb(wall, tmp_path / "pipe.glb", name='a "quoted" <name>')
    scene = trimesh.load(tmp_path / "pipe.glb")
    (mesh,) = scene.geometry.values()
    low, high = mesh.bounds
    assert (low[0], high[0]) == (pytest.approx(0.0125, abs=0.02), pytest.approx(29.9875, abs=0.02))
    assert high[1] - low[1] == pytest.approx(0.302, abs=0.004) and high[2] - low[2] == pytest.approx(0.309, abs=0.004)
    # Nothing spans the stretch without stations, nor the water at the invert.
    x, y = mesh.triangles[:, :, 0], mesh.triangles[:, :, 1]
    assert not ((x.min(axis=1) < 27.05) & (x.max(axis=1) > 27.45)).any()
    assert not ((x.min(axis=1) > 21.1) & (x.max(axis=1) < 24.9) & (y.max(axis=1) < -0.147)).any()
    # Faces look outward, and blue (outward) stands where the radius is larger.
    normals, middle = mesh.face_normals, mesh.triangles_center
    assert (np.sum(normals[:, 1:] * middle[:, 1:], axis=1) > 0).mean() > 0.99
    colour = mesh.visual.vertex_attributes["color"].astype(int)
    radius = np.hypot(mesh.vertices[:, 1], mesh.vertices[:, 2])
    blue = colour[:, 2] > colour[:, 0] + 20
    assert radius[blue].min() > wall.circle_diameter / 2 > radius[colour[:, 0] > colour[:, 2] + 20].max()


def test_mesh_stays_small_and_keeps_the_dent(wall, tmp_path):
    write_glb(wall, tmp_path / "small.glb", name="pipe", vertices=5000)
    assert (tmp_path / "small.glb").stat().st_size < 5000 * 48
    mesh = trimesh.load(tmp_path / "small.glb").to_geometry()
    x, y, z = mesh.vertices.T
    near = (np.abs(x - 18.0) < 0.6) & (np.abs(np.arctan2(y, z) - 0.4) < 0.2)
    # 150 mm and 4.8 mm of ovality there, less the dent's 9 mm.
    assert np.hypot(y, z)[near].min() < 0.147 < np.hypot(y, z)[(np.abs(x - 16.5) < 0.5)].min() + 0.003


def test_scale_is_symmetric_round_and_clipped():
    assert nice_limit(np.array([np.nan])) == pytest.approx(1e-4)
    assert nice_limit(np.full(100, -0.0071)) == pytest.approx(0.008)
    assert levels(np.array([-1.0, -0.01, 0.0, 0.01, 1.0]), 0.01).tolist() == [0, 0, 100, 200, 200]
