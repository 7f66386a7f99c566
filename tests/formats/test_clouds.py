"""Clouds in every format, made here by other means than the readers: axes, units, and damage."""

from __future__ import annotations

import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest

import springline as sl
from springline.errors import FormatError, InputError, MissingExtraError, ParameterError

from .conftest import make_cloud, make_rings

N = 300
ORIGIN = np.array([500000, 200000, 40])


def file_points() -> np.ndarray:
    """Return points in file axes on the wall of a 0.3 m pipe that lies along the file's z."""
    rng = np.random.default_rng(3)
    theta = rng.uniform(0, 2 * np.pi, N)
    return np.column_stack([0.15 * np.cos(theta), 0.15 * np.sin(theta), -rng.uniform(0.1, 0.9, N)])


def write_ply(path: Path, xyz: np.ndarray, *, form: str = "binary_little_endian", kind: str = "double") -> None:
    header = f"ply\nformat {form} 1.0\ncomment made by hand\nelement vertex {len(xyz)}\n"
    header += "".join(f"property {kind} {axis}\n" for axis in "xyz") + "property uchar red\nend_header\n"
    if form == "ascii":
        body = "".join(f"{x!r} {y!r} {z!r} 7 \n" for x, y, z in xyz.tolist()).encode()
    else:
        code = ("<" if "little" in form else ">") + ("dddB" if kind == "double" else "fffB")
        body = b"".join(struct.pack(code, *row, 7) for row in xyz.tolist())
    path.write_bytes(header.encode() + body)


def lzf(data: bytes) -> bytes:
    """Pack bytes as LZF: literals, and one reference where a run of zeros repeats."""
    out, i = b"", 0
    while i < len(data):
        if i and data[i : i + 8] == data[i - 1 : i] * 8:
            out += bytes([6 << 5, 0])  # 8 bytes from 1 back
            i += 8
        else:
            run = min(32, len(data) - i)
            zero = next((k for k in range(1, run) if data[i + k : i + k + 8] == data[i + k - 1 : i + k] * 8), run)
            out += bytes([zero - 1]) + data[i : i + zero]
            i += zero
    return out


def write_pcd(path: Path, xyz: np.ndarray, form: str) -> None:
    header = (
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity _\nSIZE 4 4 4 4 1\n"
        f"TYPE F F F F U\nCOUNT 1 1 1 1 4\nWIDTH {len(xyz)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {len(xyz)}\nDATA {form}\n"
    )
    rows = [(*(float(v) for v in p), 0.5, 0, 0, 0, 0) for p in xyz]
    if form == "ascii":
        body = "".join(" ".join(map(str, row)) + "\n" for row in rows).encode()
    elif form == "binary":
        body = b"".join(struct.pack("<ffffBBBB", *row) for row in rows)
    else:
        columns = [xyz[:, i].astype("<f4").tobytes() for i in range(3)]
        raw = b"".join([*columns, np.full(len(xyz), 0.5, "<f4").tobytes(), bytes(4 * len(xyz))])
        packed = lzf(raw)
        body = struct.pack("<II", len(packed), len(raw)) + packed
    path.write_bytes(header.encode() + body)


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


def truncated(tmp_path: Path, name: str, keep: float = 2 / 3) -> Path:
    """Return a file of the format of which only the first part is kept."""
    whole = tmp_path / f"whole-{name}"
    if name.endswith(".ply"):
        write_ply(whole, file_points(), form="ascii" if "ascii" in name else "binary_little_endian")
    elif name.endswith(".pcd"):
        write_pcd(whole, file_points(), name.removesuffix(".pcd"))
    elif name.endswith((".las", ".laz", ".zip")):
        pytest.importorskip("laspy")
        sl.write(make_cloud(30000), whole)
    elif name.endswith(".parquet"):
        pytest.importorskip("pyarrow")
        sl.write(make_rings(), whole)
    elif name.endswith(".stl"):
        import trimesh

        trimesh.creation.cylinder(0.15, 1.0).export(whole)
    elif name.endswith(".png"):
        image = pytest.importorskip("PIL.Image")
        image.fromarray(np.random.default_rng(0).integers(300, 500, (60, 80)).astype(np.uint16)).save(whole)
    else:
        np.savez(whole, points=file_points()) if name.endswith("npz") else np.save(whole, file_points())
    data = whole.read_bytes()
    whole.unlink()
    (tmp_path / name).write_bytes(data[: int(keep * len(data))])
    return tmp_path / name


@pytest.mark.parametrize(
    "name",
    ["a.ply", "ascii.ply", "ascii.pcd", "binary.pcd", "binary_compressed.pcd", "a.las", "a.laz", "a.zarr.zip",
     "a.parquet", "a.stl", "a.png", "a.npy", "a.npz"],
)  # fmt: skip
def test_truncated_files_are_refused(name, tmp_path):
    path = truncated(tmp_path, name)
    options = {"intrinsics": (80, 80, 40, 30)} if name.endswith("png") else {}
    with pytest.raises(InputError, match=r"cut short|damaged|cannot be opened") as caught:
        sl.read(path, **options)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["a.ply", "ascii.ply", "binary_compressed.pcd", "a.laz", "a.zarr.zip", "a.parquet",
                                  "a.stl", "a.png", "a.npy", "a.npz"])  # fmt: skip
def test_damage_is_read_or_refused_but_never_a_fault_of_ours(name, tmp_path):
    """Bytes that changed on the way may go unseen where a format has no check sum; nothing else may come of them."""
    path = truncated(tmp_path, name, keep=1.0)
    data, rng = path.read_bytes(), np.random.default_rng(11)
    options = {"intrinsics": (80, 80, 40, 30)} if name.endswith("png") else {}
    refused = 0
    for trial in range(24):
        damaged = np.frombuffer(data, np.uint8).copy()
        reach = damaged.size if trial % 2 else min(damaged.size, 400)
        damaged[rng.integers(0, reach, 4)] = rng.integers(0, 256, 4)
        path.write_bytes(damaged[: rng.integers(1, damaged.size) if trial % 3 == 0 else None].tobytes())
        try:
            sl.read(path, **options)
        except InputError:
            refused += 1
    assert refused >= 8


def test_a_truncated_ply_names_both_counts(tmp_path):
    path = truncated(tmp_path, "a.ply")
    with pytest.raises(FormatError, match=r"19\d of 300 vertices"):
        sl.read(path)


def test_a_zarr_folder_that_lost_a_block(tmp_path):
    sl.write(make_rings(5000, 8), tmp_path / "a.zarr")
    (tmp_path / "a.zarr/rings/range/c/1/0").unlink()
    with pytest.raises(FormatError, match="1 of 3 chunks"):
        sl.read(tmp_path / "a.zarr")


def test_a_zarr_folder_with_a_cut_block(tmp_path):
    sl.write(make_cloud(), tmp_path / "a.zarr")
    block = tmp_path / "a.zarr/points/y/c/0"
    block.write_bytes(block.read_bytes()[:100])
    with pytest.raises(FormatError):
        sl.read(tmp_path / "a.zarr")


XYZ = b"property float x\nproperty float y\nproperty float z\nend_header\n"
HEADERS = {
    "no end": b"ply\nformat ascii 1.0\nelement vertex 3\n",
    "no format": b"ply\nelement vertex 3\n" + XYZ,
    "no vertex": b"ply\nformat ascii 1.0\nelement face 3\nproperty list uchar int i\nend_header\n",
    "no z": b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n",
    "unknown type": b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n",
    "none": b"ply\nformat ascii 1.0\nelement vertex 0\n" + XYZ,
    "surplus": b"ply\nformat ascii 1.0\nelement vertex 1\n" + XYZ + b"1 2 3\n1 2 3\n",
    "not a number": b"ply\nformat ascii 1.0\nelement vertex 1\n" + XYZ + b"1 b 3\n",
}


@pytest.mark.parametrize("fault", HEADERS)
def test_ply_headers_that_are_wrong(fault, tmp_path):
    (tmp_path / "a.ply").write_bytes(HEADERS[fault])
    with pytest.raises(InputError, match=r"row 8, column y" if fault == "not a number" else "a.ply"):
        sl.read(tmp_path / "a.ply")


@pytest.mark.parametrize(
    ("name", "modules", "extra"),
    [("a.laz", ["laspy"], "las"), ("a.las", ["lazrs"], "las"), ("a.parquet", ["pyarrow.parquet"], "parquet")],
)
def test_a_missing_extra_names_its_install_command(name, modules, extra, tmp_path, without):
    source = make_rings() if extra == "parquet" else make_cloud()
    sl.write(source, tmp_path / name)
    without(*modules)
    for act in (lambda: sl.read(tmp_path / name), lambda: sl.write(source, tmp_path / f"b-{name}")):
        with pytest.raises(MissingExtraError, match=rf"pip install 'springline\[{extra}\]'"):
            act()
    assert [p.name for p in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(
    ("head", "module", "extra"), [(b"ASTM-E57", "pye57", "e57"), (b"\x89PNG\r\n\x1a\n", "PIL", "depth")]
)
def test_a_missing_extra_of_what_is_only_read(head, module, extra, tmp_path, without):
    (tmp_path / "a.bin").write_bytes(head + bytes(100))
    without(module)
    options = {"intrinsics": (1, 1, 0, 0)} if extra == "depth" else {}
    with pytest.raises(MissingExtraError, match=rf"pip install 'springline\[{extra}\]'"):
        sl.read(tmp_path / "a.bin", **options)


def test_a_zip_of_something_else(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as bundle:
        bundle.writestr("readme.txt", "no scan")
    with pytest.raises(FormatError, match="the format is not known"):
        sl.read(tmp_path / "a.zip")
