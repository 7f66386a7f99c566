"""Files that are cut short, damaged or no cloud, and libraries that are missing: refused by name, never a fault."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
import pytest

import springline as sl
from springline.errors import FormatError, InputError, MissingExtraError

from .cloud_files import file_points, write_pcd, write_ply
from .conftest import make_cloud, make_rings


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
