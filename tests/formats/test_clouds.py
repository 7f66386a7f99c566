"""Clouds in every format, made here by other means than the readers: axes and units."""

from __future__ import annotations

import struct
import time

import numpy as np
import pytest

import springline as sl
from springline.errors import FormatError, InputError, ParameterError

from .cloud_files import N, file_points, write_pcd, write_ply
from .conftest import make_cloud

ORIGIN = np.array([500000, 200000, 40])


def check_camera(survey, xyz: np.ndarray, tolerance: float = 0.0) -> None:
    """The camera habit: forward = -z of the file, up = y, right = x."""
    np.testing.assert_allclose(survey.points["x"], -xyz[:, 2], atol=tolerance, rtol=0)
    np.testing.assert_allclose(survey.points["y"], xyz[:, 1], atol=tolerance, rtol=0)
    np.testing.assert_allclose(survey.points["z"], xyz[:, 0], atol=tolerance, rtol=0)


def check_survey(survey, xyz: np.ndarray, tolerance: float = 0.0) -> None:
    """The scanner's habit: forward = x of the file, up = z, right = -y."""
    np.testing.assert_allclose(survey.points["x"], xyz[:, 0], atol=tolerance, rtol=0)
    np.testing.assert_allclose(survey.points["y"], xyz[:, 2], atol=tolerance, rtol=0)
    np.testing.assert_allclose(survey.points["z"], -xyz[:, 1], atol=tolerance, rtol=0)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("kind", ["float", "double"])
def test_ply(form, kind, tmp_path):
    write_ply(tmp_path / "a.ply", file_points(), form=form, kind=kind)
    survey = sl.read(tmp_path / "a.ply", unit="m")
    check_camera(survey, file_points(), 1e-7 if kind == "float" and form != "ascii" else 0.0)
    assert "x forward = file -z, y up = file y, z right = file x" in survey.assumptions[0]
    assert survey.points.attrs["source_axes"] == "-z,y,x"
    assert survey.points.attrs["sensor_kind"] == "unknown"


@pytest.mark.parametrize("form", ["ascii", "binary", "binary_compressed"])
def test_pcd(form, tmp_path):
    write_pcd(tmp_path / "a.pcd", file_points(), form)
    survey = sl.read(tmp_path / "a.pcd", unit="m")
    check_camera(survey, file_points(), 1e-7)
    np.testing.assert_array_equal(survey.points["intensity"], np.full(N, 0.5, np.float32))


@pytest.mark.parametrize(
    "text",
    ["{x} {y} {z}", "{x}, {y}, {z}", "{x}\t{y}\t{z}", "  {x}   {y} {z} "],
)
@pytest.mark.parametrize("header", ["", "x{d}y{d}z\n", "# made by hand\n//X{d}Y{d}Z\n"])
def test_xyz(text, header, tmp_path):
    d = "," if "," in text else "\t" if "\t" in text else " "
    rows = "\n".join(text.format(x=x, y=y, z=z) for x, y, z in file_points().tolist())
    (tmp_path / "a.txt").write_text(header.format(d=d) + rows)
    check_survey(sl.read(tmp_path / "a.txt", unit="m"), file_points(), 1e-15)


def test_xyz_with_units_intensity_and_other_columns(tmp_path):
    rows = "\n".join(f"{i},{1000 * z},{1000 * x},{1000 * y}" for i, (x, y, z) in enumerate(file_points().tolist()))
    (tmp_path / "a.csv").write_text("intensity,z [mm],x [mm],y [mm]\n" + rows)
    survey = sl.read(tmp_path / "a.csv")
    check_survey(survey, file_points(), 1e-12)
    np.testing.assert_array_equal(survey.points["intensity"], np.arange(N))


@pytest.mark.parametrize("save", ["npy", "records", "npz", "axes"])
def test_numpy(save, tmp_path):
    xyz, path = file_points(), tmp_path / ("a.npz" if save in ("npz", "axes") else "a.npy")
    if save == "npy":
        np.save(path, np.column_stack([xyz, np.ones(N)]))
    elif save == "records":
        np.save(path, np.rec.fromarrays(xyz.T, names="x,y,z"))
    elif save == "npz":
        np.savez(path, points=xyz, colour=np.ones(N))
    else:
        np.savez_compressed(path, x=xyz[:, 0], y=xyz[:, 1], z=xyz[:, 2])
    check_camera(sl.read(path, unit="m"), xyz)


def test_numpy_files_that_hold_something_else(tmp_path):
    np.save(tmp_path / "a.npy", np.ones((5, 40)))
    np.savez(tmp_path / "b.npz", weights=np.ones(3))
    np.save(tmp_path / "c.npy", np.array([{"a": 1}], dtype=object), allow_pickle=True)
    for name in ("a.npy", "b.npz", "c.npy"):
        with pytest.raises(FormatError):
            sl.read(tmp_path / name)


@pytest.mark.parametrize("name", ["a.obj", "a.stl", "ascii.stl"])
def test_meshes(name, tmp_path):
    import trimesh

    mesh = trimesh.creation.cylinder(0.15, 1.0, sections=32)
    if name == "ascii.stl":
        (tmp_path / name).write_text(trimesh.exchange.stl.export_stl_ascii(mesh))
    else:
        mesh.export(tmp_path / name)
    points = sl.read(tmp_path / name, unit="m").points
    found = np.unique(np.round(np.column_stack([points["z"], points["y"], -points["x"]]), 5) + 0.0, axis=0)
    np.testing.assert_allclose(found, np.unique(np.round(mesh.vertices, 5) + 0.0, axis=0), atol=2e-5)


def test_las_as_others_write_it(tmp_path):
    laspy = pytest.importorskip("laspy")
    las = laspy.create(point_format=6, file_version="1.4")
    las.header.offsets, las.header.scales = ORIGIN, [1e-4] * 3
    las.x, las.y, las.z = (file_points() + ORIGIN).T
    las.gps_time = np.arange(N) * 0.5
    las.write(tmp_path / "a.laz")
    survey = sl.read(tmp_path / "a.laz", nominal_diameter=0.3)
    check_survey(survey, file_points() + ORIGIN, 6e-5)
    np.testing.assert_array_equal(survey.points["time"], np.arange(N) * 0.5)
    assert "intensity" not in survey.points
    assert "z right = file -y" in survey.assumptions[0]


@pytest.mark.parametrize(("code", "metres"), [(9001, 1.0), (9002, 0.3048), (9003, 1200 / 3937)])
def test_las_whose_coordinate_system_states_its_unit(code, metres, tmp_path):
    laspy = pytest.importorskip("laspy")
    las = laspy.create(point_format=0, file_version="1.2")
    las.header.offsets, las.header.scales = [0, 0, 0], [1e-6] * 3
    las.x, las.y, las.z = (file_points() / metres).T
    keys = struct.pack("<8H", 1, 1, 0, 1, 3076, 0, 1, code)
    las.vlrs.append(laspy.VLR("LASF_Projection", 34735, "", keys))
    las.write(tmp_path / "a.las")
    check_survey(sl.read(tmp_path / "a.las"), file_points(), 1e-6)


def test_las_in_some_kind_of_feet(tmp_path):
    laspy = pytest.importorskip("laspy")
    las = laspy.create(point_format=6, file_version="1.4")
    las.x, las.y, las.z = file_points().T
    las.vlrs.append(laspy.VLR("LASF_Projection", 2112, "", b'PROJCS["a",UNIT["US survey foot",0.3048006]]'))
    las.write(tmp_path / "a.las")
    with pytest.raises(InputError, match=r"speaks of feet.*--unit ft"):
        sl.read(tmp_path / "a.las")
    assert sl.read(tmp_path / "a.las", unit="ft").points.sizes["point"] > 0


def test_e57(tmp_path):
    pye57 = pytest.importorskip("pye57")
    xyz = file_points()
    with pye57.E57(str(tmp_path / "a.e57"), mode="w") as file:
        for shift in (0.0, -1.0):
            fields = {f"cartesian{axis}": xyz[:, i] for i, axis in enumerate("XYZ")}
            file.write_scan_raw({**fields, "intensity": np.full(N, 0.25)}, translation=np.array([0, 0, shift]))
    survey = sl.read(tmp_path / "a.e57", nominal_diameter=0.3)
    check_survey(survey, np.concatenate([xyz, xyz - np.array([0, 0, 1])]), 1e-7)
    np.testing.assert_array_equal(survey.points["intensity"], np.full(2 * N, 0.25))
    assert any("2 scans were joined" in sentence for sentence in survey.assumptions)
    (tmp_path / "cut.e57").write_bytes((tmp_path / "a.e57").read_bytes()[:3000])
    with pytest.raises(FormatError, match="cut short or damaged"):
        sl.read(tmp_path / "cut.e57")


@pytest.mark.parametrize(("unit", "factor"), [("m", 1.0), ("mm", 1000.0), ("in", 1 / 0.0254), ("ft", 1 / 0.3048)])
def test_units_stated_or_guessed_from_the_nominal_diameter(unit, factor, tmp_path):
    np.save(tmp_path / "a.npy", file_points() * factor)
    stated = sl.read(tmp_path / "a.npy", unit=unit)
    assert len(stated.assumptions) == 1
    guessed = sl.read(tmp_path / "a.npy", nominal_diameter=0.3)
    assert f"taken as {unit}, because" in guessed.assumptions[1]
    for survey in (stated, guessed):
        check_camera(survey, file_points(), 1e-12)


def test_unstated_units_are_metres_and_told_or_refused(tmp_path):
    np.save(tmp_path / "a.npy", file_points())
    assert "taken as metres" in sl.read(tmp_path / "a.npy").assumptions[1]
    np.save(tmp_path / "mm.npy", file_points() * 1000)
    with pytest.raises(InputError, match=r"in metres the points would lie about \d+ m across.*--unit"):
        sl.read(tmp_path / "mm.npy")


@pytest.mark.parametrize("nominal", [3.0, 0.03])
@pytest.mark.parametrize("factor", [1, 1000])
@pytest.mark.parametrize("stated", [False, True])
def test_a_cloud_ten_times_off_nominal(nominal, factor, stated, tmp_path):
    np.save(tmp_path / "a.npy", file_points() * factor)
    unit = {1: "m", 1000: "mm"}[factor] if stated else None
    with pytest.raises(InputError, match="far from the nominal"):
        sl.read(tmp_path / "a.npy", nominal_diameter=nominal, unit=unit)


def test_a_curved_run_far_from_the_origin_is_as_wide_as_its_pipe(tmp_path):
    rng = np.random.default_rng(2)
    turn, theta = rng.uniform(0, 1.5, 50_000), rng.uniform(0, 2 * np.pi, 50_000)
    reach = 20 + 0.15 * np.cos(theta)
    xyz = np.column_stack([reach * np.cos(turn), reach * np.sin(turn), 0.15 * np.sin(theta) + turn]) + ORIGIN
    np.save(tmp_path / "a.npy", xyz)
    assert "taken as m," in sl.read(tmp_path / "a.npy", nominal_diameter=0.3).assumptions[1]


def test_axes_can_be_stated_and_mirrors_are_refused(tmp_path):
    xyz = file_points()
    np.save(tmp_path / "a.npy", xyz)
    survey = sl.read(tmp_path / "a.npy", unit="m", axes="z, -y, x")
    np.testing.assert_array_equal(survey.points["x"], xyz[:, 2])
    np.testing.assert_array_equal(survey.points["y"], -xyz[:, 1])
    assert survey.assumptions == []
    with pytest.raises(ParameterError, match="mirrors the pipe"):
        sl.read(tmp_path / "a.npy", unit="m", axes="-z,y,-x")


def test_missing_points_are_left_out_and_counted(tmp_path):
    xyz = file_points()
    xyz[5] = np.nan
    xyz[7] = 0.0
    write_ply(tmp_path / "a.ply", xyz, form="ascii")
    survey = sl.read(tmp_path / "a.ply", unit="m")
    assert survey.points.sizes["point"] == N - 2
    assert any("2 points without coordinates" in sentence for sentence in survey.assumptions)
    np.save(tmp_path / "nan.npy", np.full((20, 3), np.nan))
    with pytest.raises(InputError, match="no point has coordinates"):
        sl.read(tmp_path / "nan.npy")


@pytest.mark.parametrize("name", ["a.las", "a.laz"])
@pytest.mark.parametrize(("place", "value"), [(100, 4_000_000_000), (96, 4_000_000_000)])
def test_a_las_header_that_promises_too_much_is_refused_at_once(name, place, value, tmp_path):
    pytest.importorskip("laspy")
    whole = tmp_path / name
    sl.write(make_cloud(), whole)
    damaged = bytearray(whole.read_bytes())
    damaged[place : place + 4] = value.to_bytes(4, "little")
    (tmp_path / f"b{name}").write_bytes(bytes(damaged))
    begun = time.process_time()
    with pytest.raises(InputError, match=r"the header speaks of .* bytes, the file has"):
        sl.read(tmp_path / f"b{name}")
    assert time.process_time() - begun < 5.0
