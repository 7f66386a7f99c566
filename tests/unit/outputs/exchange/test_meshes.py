"""Meshes and grids, opened by trimesh and meshio."""

import numpy as np
import pytest
import trimesh

import springline as sl

RADIUS = 0.15


def check_dimensions(bounds, survey):
    x = survey.section["chainage"].values
    spacing = np.median(np.diff(x))
    np.testing.assert_allclose(bounds[:, 0], (x[0], x[-1]), atol=spacing)
    # Ovality swells to 4 % and the axis turns: the extents lie between the minor and the major semi-axis.
    for k in (1, 2):
        assert RADIUS * 0.94 < -bounds[0, k] < RADIUS * 1.06
        assert RADIUS * 0.94 < bounds[1, k] < RADIUS * 1.06


@pytest.mark.parametrize("name", ["a.glb", "a.obj", "a.mesh.ply"])
def test_trimesh_reads_the_right_dimensions(small, tmp_path, name):
    path = sl.write(small, tmp_path / name)
    kind = "ply" if name.endswith("ply") else name.rsplit(".", 1)[1]
    mesh = trimesh.load(path, file_type=kind, force="mesh", process=False)
    check_dimensions(mesh.bounds, small)
    assert len(mesh.faces) > 0.5 * 2 * 36 * len(small.section["station"])
    # Faces look outward.
    middle = mesh.triangles_center
    out = np.einsum("ij,ij->i", mesh.face_normals[:, 1:], middle[:, 1:])
    assert (out > 0).mean() > 0.99


def test_colours_travel(small, tmp_path):
    mesh = trimesh.load(sl.write(small, tmp_path / "a.mesh.ply"), force="mesh", process=False)
    assert len(np.unique(np.asarray(mesh.visual.vertex_colors)[:, :3], axis=0)) > 10
    lines = sl.write(small, tmp_path / "a.obj").read_text().splitlines()
    vertices = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
    assert vertices.shape[1] == 6 and len(np.unique(vertices[:, 3:], axis=0)) > 10


def test_meshio_reads_the_grid_with_its_data(small, tmp_path):
    meshio = pytest.importorskip("meshio")
    grid = meshio.read(sl.write(small, tmp_path / "a.vtu"))
    check_dimensions(np.stack([grid.points.min(axis=0), grid.points.max(axis=0)]), small)
    assert [block.type for block in grid.cells] == ["triangle"]
    radius = np.hypot(grid.points[:, 1], grid.points[:, 2])
    departure = grid.point_data["departure_mm"]
    mean = small.metrics.attrs["diameter_mean"] / 2
    np.testing.assert_allclose(radius, mean + departure / 1e3, atol=1e-6)
    np.testing.assert_allclose(grid.point_data["chainage_m"], grid.points[:, 0], atol=1e-5)
    assert np.nanmin(grid.point_data["residual_mm"]) < -2.0  # the dent
