"""Names with quotes, brackets, formulas, other letters, path separators: escaped in every format, kept where it can."""

import csv
import json
import struct
import xml.etree.ElementTree as ET

import numpy as np
import pytest

import springline as sl
from springline.outputs.exchange import EXPORTS

from ..finished import finished_survey
from .conftest import with_layout

NAMES = [
    "\"quoted\" & 'single' <script>alert(1)</script>",
    '=HYPERLINK("http://x","y")',
    "Канал №7 – 下水道 ß",
    "../../etc/passwd\\..\\x",
    "two\nlines\r\nand\ttab\x00\x07\x1b",
    "]]><x/>&amp;%s{0}${y}",
    "x" * 400,
]


def named(name):
    survey = finished_survey(stations=24, bearings=36, name=name)
    features = survey.features
    count = features.sizes["feature"]
    features = features.assign(
        kind=("feature", np.array([name.replace("\x00", "")] * count)),
        image=("feature", np.array([name.replace("\x00", "")] * count)),
    )
    return with_layout(survey.corrected("features", features).with_attrs(operator=name, material=name))


def cleaned(name):
    """Return the words of a name without control characters."""
    return "".join(c for c in name if c >= " " or c in "\n\t\r").split()


@pytest.fixture(
    scope="module", params=NAMES, ids=["markup", "formula", "letters", "path", "lines", "templates", "long"]
)
def case(request):
    return request.param, named(request.param)


def test_every_format_is_written_and_nothing_lands_elsewhere(case, tmp_path):
    _, survey = case
    folder = tmp_path / "out"
    folder.mkdir()
    for export in EXPORTS.values():
        sl.write(survey, folder / f"pipe{export.extensions[0]}", format=export.key)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["out"]
    assert sorted(p.name for p in folder.iterdir()) == sorted(f"pipe{e.extensions[0]}" for e in EXPORTS.values())


def test_xml_holds_the_name_as_text(case, tmp_path):
    name, survey = case
    words = " ".join(cleaned(name))
    for key in ("isybau", "isybau-2006", "m150", "landxml"):
        root = ET.parse(sl.write(survey, tmp_path / key, format=key)).getroot()
        assert not [e for e in root.iter() if e.tag.rpartition("}")[2] in ("script", "x")]
        texts = [" ".join((e.text or "").split()) for e in root.iter()] + [
            " ".join(v.split()) for e in root.iter() for v in e.attrib.values()
        ]
        assert any(text and words.startswith(text[:30]) for text in texts if len(text) > 5), key


def test_tables_hold_no_formula(case, tmp_path):
    _, survey = case
    files = [sl.write(survey, tmp_path / "a.reach.csv"), sl.write(survey, tmp_path / "a.fdot-430.csv")]
    files += list(sl.write(survey, tmp_path / "a.pacp").iterdir())
    for path in files:
        with path.open(encoding="utf-8", newline="") as stream:
            rows = list(csv.reader(stream))
        assert len({len(row) for row in rows}) == 1, path
        assert not [cell for row in rows for cell in row if cell[:1] in ("=", "@", "\t", "\r")], path


def test_workbook_holds_text_and_no_formula(case, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    name, survey = case
    book = openpyxl.load_workbook(sl.write(survey, tmp_path / "a.xlsx"))
    kinds = {cell.data_type for sheet in book for row in sheet.iter_rows() for cell in row}
    assert "f" not in kinds
    value = dict(row for row in book["Summary"].iter_rows(values_only=True))["name"]
    assert value.replace("_x000D_", "").split() == cleaned(name)


def test_geopackage_holds_the_name(case, tmp_path):
    pyogrio = pytest.importorskip("pyogrio")
    name, survey = case
    meta, _, _, fields = pyogrio.raw.read(sl.write(survey, tmp_path / "a.gpkg"), layer="centreline")
    assert fields[list(meta["fields"]).index("name")][0].split() == cleaned(name)


def test_gltf_holds_the_name(case, tmp_path):
    name, survey = case
    raw = sl.write(survey, tmp_path / "a.glb").read_bytes()
    (length,) = struct.unpack("<I", raw[12:16])
    assert json.loads(raw[20 : 20 + length])["nodes"][0]["name"] == name


def test_en13508_comes_back_with_its_name(case, tmp_path):
    name, survey = case
    read = sl.read(sl.write(survey, tmp_path / "a.en13508.txt"))
    assert read.attrs["name"].split() == cleaned(name)
    assert read.observations.sizes["observation"] == survey.features.sizes["feature"] + 2
