from __future__ import annotations

import subprocess
import sys

import pytest

import springline.io
from springline.errors import InputError, ParameterError
from springline.io.options import ReadOptions, parse_intrinsics
from springline.io.registry import by_key
from springline.io.units import length


def test_the_package_and_its_table_load_without_heavy_libraries():
    code = (
        "import sys, springline.io, springline.io.registry, springline.cli.reading, springline.cli.convert; "
        "print([m for m in ('numpy', 'xarray', 'pandas', 'numba', 'laspy', 'zarr') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_names():
    for name in springline.io.__all__:
        assert getattr(springline.io, name) is not None
    with pytest.raises(AttributeError, match="reed"):
        springline.io.reed  # noqa: B018 -- the access is the test


@pytest.mark.parametrize(("key", "expected"), [("ply", "ply"), (".LAZ", "las"), ("stl", "mesh"), ("npz", "npy")])
def test_formats_by_key_or_extension(key, expected):
    assert by_key(key).key == expected


def test_an_extension_that_two_formats_share_is_no_key():
    with pytest.raises(InputError, match="'txt' is unknown"):
        by_key("txt")


def test_intrinsics():
    assert parse_intrinsics("421.1, 421.2,426,237") == (421.1, 421.2, 426.0, 237.0)
    for text in ("1,2,3", "a,b,c,d", "1,2,3,4,5"):
        with pytest.raises(InputError, match="not four numbers"):
            parse_intrinsics(text)


@pytest.mark.parametrize(
    ("text", "metres"),
    [("400mm", 0.4), (" 0.4 m ", 0.4), ("12in", 0.3048), ("1.5 ft", 0.4572), ("3e2mm", 0.3), ("30cm", 0.3)],
)
def test_lengths(text, metres):
    assert length(text, where="a") == pytest.approx(metres)


@pytest.mark.parametrize("text", ["400", "mm", "-400mm", "0mm", "400 furlongs", "4 00mm", ""])
def test_no_lengths(text):
    with pytest.raises(InputError, match="is not a length"):
        length(text, where="a")


@pytest.mark.parametrize("name", ["two\nlines", "bell\a", "null\0"])
def test_a_name_that_cannot_be_printed_is_refused(name):
    with pytest.raises(ParameterError, match=r"name: .* cannot stand in a report"):
        ReadOptions(name=name)
