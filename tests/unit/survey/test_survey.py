"""The survey: groups, validation, saving and opening, atomic writing."""

import errno
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import springline as sl
from springline.errors import ContractError, FormatError, InputError, MissingGroupError, OutputError
from springline.survey import add_warning, fingerprint, open_survey, save_survey, validate


def ring_survey(ranges, distance=None, **attrs):
    ranges = np.asarray(ranges, "float32")
    distance = np.arange(len(ranges)) * 0.01 if distance is None else np.asarray(distance, float)
    rings = xr.Dataset(
        {"range": (("ring", "bearing"), ranges), "distance": ("ring", distance)},
        coords={"bearing": np.linspace(0, 2 * np.pi, ranges.shape[1], endpoint=False)},
        attrs={"referred_to": "sensor", "sensor_kind": "ring-laser", **attrs},
    )
    return sl.Survey({"rings": rings}, {"name": "A to B"})


@pytest.fixture
def survey():
    ranges = np.random.default_rng(1).normal(0.15, 0.002, (50, 90))
    ranges[3, 10:20] = np.nan
    return ring_survey(ranges, range_noise=1e-3)


@pytest.mark.parametrize("name", ["s.zarr", "s.zarr.zip"])
def test_saved_survey_comes_back_to_a_tenth_of_the_noise(survey, tmp_path, name):
    save_survey(survey, tmp_path / name)
    back = open_survey(tmp_path / name)
    before, after = survey.rings["range"].values, back.rings["range"].values
    assert after.dtype == np.float32
    assert np.array_equal(np.isnan(before), np.isnan(after))
    assert np.nanmax(np.abs(before - after)) <= 0.5 * 1e-5 * 1.01
    assert np.array_equal(back.rings["distance"], survey.rings["distance"])
    assert back.attrs["name"] == "A to B"
    assert back.rings["range"].attrs["units"] == "m"


def test_the_page_says_how_others_open_it(survey, tmp_path, monkeypatch):
    page = (Path(__file__).parents[3] / "docs" / "contract.md").read_text()
    code = page.split("```python")[1].split("```")[0]
    save_survey(
        survey.with_group("metrics", xr.Dataset({"diameter_max": ("station", [0.3])})), tmp_path / "survey.zarr"
    )
    save_survey(survey, tmp_path / "survey.zarr.zip")
    monkeypatch.chdir(tmp_path)
    *lines, last = [line for line in code.splitlines() if line]
    for line in (lines[0] + "\n" + lines[1], lines[0] + "\n" + lines[2]):
        held = {}
        exec(line, held)
        assert held["tree"]["rings"].sizes["bearing"] == 90
    assert last.startswith('tree["metrics"]["diameter_max"]')


def test_text_comes_back(survey, tmp_path):
    kinds = xr.Dataset({"kind": ("feature", ["joint", "latéral"]), "chainage": ("feature", [1.0, 2.0])})
    save_survey(survey.with_group("features", kinds), tmp_path / "s.zarr.zip")
    back = open_survey(tmp_path / "s.zarr.zip").features["kind"]
    assert back.dtype.kind == "U"
    assert list(back.values) == ["joint", "latéral"]


def test_long_ranges_keep_their_precision(tmp_path):
    survey = ring_survey(np.full((3, 30), 12.345678), range_noise=1e-5)
    save_survey(survey, tmp_path / "s.zarr.zip")
    back = open_survey(tmp_path / "s.zarr.zip").rings["range"].values
    assert np.abs(back - 12.345678).max() < 2e-6


def test_people_without_springline_can_open_it(survey, tmp_path):
    save_survey(survey, tmp_path / "s.zarr")
    tree = xr.open_datatree(tmp_path / "s.zarr", engine="zarr")
    assert tree["rings/range"].shape == (50, 90)


def test_stages_never_overwrite(survey):
    with pytest.raises(ContractError, match="never overwritten"):
        survey.with_group("rings", survey.rings)
    assert survey.with_group("truth", xr.Dataset()).groups == ("rings", "truth")
    assert survey.groups == ("rings",)


def test_a_missing_group_names_its_maker(survey):
    with pytest.raises(MissingGroupError, match=r"'/metrics' is not there.*stages\.metrics"):
        _ = survey.metrics
    with pytest.raises(MissingGroupError, match="did you mean 'rings'"):
        survey.group("ring")
    with pytest.raises(ContractError, match="unknown group"):
        sl.Survey({"ringss": xr.Dataset()})


@pytest.mark.parametrize(
    ("distance", "message"),
    [
        ([0.0, 0.1, 0.1, 0.2], "repeats: 0.1 m, then 0.1 m"),
        ([0.0, 0.2, 0.1, 0.3], "goes back: 0.2 m, then 0.1 m"),
        ([0.3, 0.2, 0.1, 0.0], "distances decrease from 0.3 to 0 m"),
        ([0.0, np.nan, 0.1, 0.2], "ring 1: the distance is not a number"),
    ],
)
def test_distances_that_repeat_or_go_back_are_refused(distance, message):
    with pytest.raises(InputError, match=message):
        validate(ring_survey(np.ones((4, 8)), distance))


def test_a_survey_without_returns_is_refused():
    with pytest.raises(InputError, match="every reading is missing"):
        validate(ring_survey(np.full((4, 8), np.nan)))


def test_structure_is_checked(survey):
    with pytest.raises(ContractError, match="'distance' is missing"):
        validate(sl.Survey({"rings": survey.rings.drop_vars("distance")}))
    with pytest.raises(ContractError, match="unknown variable 'rnge', did you mean 'range'"):
        validate(sl.Survey({"rings": survey.rings.assign(rnge=survey.rings["range"])}))
    with pytest.raises(ContractError, match="has dims"):
        validate(sl.Survey({"rings": survey.rings.transpose("bearing", "ring")}))
    with pytest.raises(ContractError, match="has type"):
        validate(sl.Survey({"rings": survey.rings.assign(time=("ring", np.full(50, "now")))}))


def test_existing_output_is_refused_without_force(survey, tmp_path):
    path = tmp_path / "s.zarr"
    save_survey(survey, path)
    with pytest.raises(OutputError, match="--force"):
        save_survey(survey, path)
    save_survey(survey.with_attrs(name="B to C"), path, force=True)
    assert open_survey(path).attrs["name"] == "B to C"
    assert [p.name for p in tmp_path.iterdir()] == ["s.zarr"]


@pytest.mark.parametrize("name", ["home", "home.zarr", "home.pacp", "home.zarr.zip", "home.csv"])
def test_a_folder_that_is_not_ours_is_never_replaced(survey, tmp_path, name):
    home = tmp_path / name
    home.mkdir()
    (home / "thesis.txt").write_text("years of work")
    with pytest.raises(OutputError, match=r"other files than those of|a folder, not a file"):
        sl.write(survey, home, force=True)
    assert (home / "thesis.txt").read_text() == "years of work"
    assert [p.name for p in tmp_path.iterdir()] == [name]


def test_a_full_disk_leaves_nothing_behind_and_the_old_result_in_place(survey, tmp_path, monkeypatch):
    path = tmp_path / "s.zarr.zip"
    save_survey(survey, path)
    old = path.read_bytes()

    def refuse(*_args, **_kwargs):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(xr.Dataset, "to_zarr", refuse)
    with pytest.raises(OutputError, match="No space left on device"):
        save_survey(survey, path, force=True)
    assert path.read_bytes() == old
    assert [p.name for p in tmp_path.iterdir()] == ["s.zarr.zip"]


@pytest.mark.parametrize("keep", [0, 40, 0.5, 0.95])
def test_truncated_zips_are_refused(survey, tmp_path, keep):
    path = tmp_path / "s.zarr.zip"
    save_survey(survey, path)
    whole = path.read_bytes()
    path.write_bytes(whole[: int(keep * len(whole)) if isinstance(keep, float) else keep])
    with pytest.raises(FormatError, match=r"s\.zarr\.zip"):
        open_survey(path)


@pytest.mark.parametrize(
    "damage", [lambda chunk: chunk.unlink(), lambda chunk: chunk.write_bytes(chunk.read_bytes()[:20])]
)
def test_a_zarr_folder_with_a_damaged_chunk_is_refused(survey, tmp_path, damage):
    save_survey(survey, tmp_path / "s.zarr")
    damage(next(p for p in (tmp_path / "s.zarr" / "rings" / "range" / "c").rglob("*") if p.is_file()))
    with pytest.raises(FormatError, match=r"s\.zarr: cannot be opened"):
        open_survey(tmp_path / "s.zarr")


def test_missing_file():
    with pytest.raises(InputError, match="no such file"):
        open_survey(Path("nowhere.zarr"))


def test_fingerprint_is_the_sha256_of_the_bytes(tmp_path):
    (tmp_path / "a.bin").write_bytes(b"abc")
    found = fingerprint(tmp_path / "a.bin")
    assert found.bytes == 3
    assert found.sha256 == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"


def test_warnings_are_kept_once_and_source_drops_them(survey):
    warned = add_warning(add_warning(survey, "mind the gap"), "mind the gap", "and the step")
    assert warned.warnings == ["mind the gap", "and the step"]
    assert json.loads(warned.attrs["warnings"]) == warned.warnings
    assert warned.source().warnings == []


def test_texts_without_an_element_come_back_as_texts(survey, tmp_path):
    none = xr.Dataset({"kind": ("feature", np.empty(0, "<U3")), "chainage": ("feature", np.empty(0))})
    save_survey(survey.with_group("features", none), tmp_path / "s.zarr.zip")
    found = validate(open_survey(tmp_path / "s.zarr.zip"))
    assert found.features["kind"].dtype.kind == "U" and found.features.sizes == {"feature": 0}
