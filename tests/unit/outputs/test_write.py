import json
import re

import pytest

from springline.errors import OutputError
from springline.outputs import write as module
from springline.outputs.write import write_outputs
from springline.survey import open_survey

from .finished import finished_survey

FILES = {
    "config.toml",
    "features.csv",
    "pipe.glb",
    "report.html",
    "report.pdf",
    "stations.csv",
    "stations_sigma.csv",
    "summary.json",
    "survey.zarr.zip",
    "viewer.html",
}


@pytest.fixture(scope="module")
def small():
    return finished_survey(stations=120, bearings=72)


def test_all_files_are_there_and_open_again(small, tmp_path):
    seen = []
    paths = write_outputs(small, tmp_path / "run", config_toml="[rings]\nbearings = 72\n", progress=seen.append)
    assert {p.name for p in paths} == FILES == set(seen) == {p.name for p in (tmp_path / "run").iterdir()}
    assert json.loads((tmp_path / "run" / "summary.json").read_text())["stations"] == small.section.sizes["station"]
    assert open_survey(tmp_path / "run" / "survey.zarr.zip").groups == small.groups
    assert (tmp_path / "run" / "config.toml").read_text() == "[rings]\nbearings = 72\n"
    assert list(tmp_path.iterdir()) == [tmp_path / "run"]


def test_an_existing_folder_is_refused_and_replaced_only_when_it_is_ours(small, tmp_path):
    run = tmp_path / "run"
    write_outputs(small, run, config_toml="a = 1\n")
    (run / "old.txt").write_text("from before")
    with pytest.raises(OutputError, match="--force"):
        write_outputs(small, run, config_toml="a = 2\n")
    assert (run / "config.toml").read_text() == "a = 1\n"
    write_outputs(small, run, config_toml="a = 2\n", force=True)
    assert (run / "config.toml").read_text() == "a = 2\n" and not (run / "old.txt").exists()

    home = tmp_path / "home"
    home.mkdir()
    (home / "thesis.txt").write_text("years of work")
    with pytest.raises(OutputError, match="other files"):
        write_outputs(small, home, config_toml="", force=True)
    assert (home / "thesis.txt").read_text() == "years of work"


def test_a_failure_half_way_leaves_what_was_there(small, tmp_path, monkeypatch):
    run = tmp_path / "run"
    write_outputs(small, run, config_toml="a = 1\n")

    def full(*_args, **_kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(module, "save_survey", full)
    with pytest.raises(OutputError, match="No space left"):
        write_outputs(small, run, config_toml="a = 2\n", force=True)
    assert (run / "config.toml").read_text() == "a = 1\n" and list(tmp_path.iterdir()) == [run]
    with pytest.raises(OutputError, match="No space left"):
        write_outputs(small, tmp_path / "new", config_toml="a = 2\n")
    assert list(tmp_path.iterdir()) == [run]


def test_report_asks_nothing_of_any_network(small, tmp_path):
    write_outputs(small, tmp_path / "run", config_toml="")
    page = (tmp_path / "run" / "report.html").read_text()
    assert "://" not in page
    assert not re.search(r"""(?:src|href)=["']//|url\((?!data:)|@import""", page)
    assert len(page) < 5e6


def test_without_typst_the_pdf_alone_is_left_out(small, tmp_path, monkeypatch):
    monkeypatch.setattr(module, "find_spec", lambda name: None)
    paths = write_outputs(small, tmp_path / "run", config_toml="")
    assert {p.name for p in paths} == FILES - {"report.pdf"}


def test_a_name_with_slashes_stays_inside_the_folder(tmp_path):
    survey = finished_survey(stations=12, bearings=36, dense=True, name='../../etc/<b>"Straße" 日本.zip')
    paths = write_outputs(survey, tmp_path / "run", config_toml="")
    assert {p.name for p in paths} == FILES and list(tmp_path.iterdir()) == [tmp_path / "run"]
