"""`springline formats`: what is listed is what can be done."""

from __future__ import annotations

import json
from importlib import import_module

import pytest

from springline.io.registry import FORMATS
from springline.outputs.exchange import EXPORTS

from .command_line import run


def formats(*words: str) -> str:
    done = run("formats", *words)
    assert done.returncode == 0
    return done.stdout


def test_table(monkeypatch):
    monkeypatch.setenv("COLUMNS", "160")
    out = formats()
    for name in (*FORMATS, *EXPORTS):
        assert f" {name} " in out


def test_json_and_a_missing_extra(monkeypatch):
    records = {r["format"]: r for r in json.loads(formats("--json"))}
    assert list(records) == [*FORMATS, *(name for name in EXPORTS if name not in FORMATS)]
    own = {"ply", "las", "csv", "parquet", "folder", "zarr"}
    assert {name for name, r in records.items() if r["writes"]} == own | set(EXPORTS)
    assert {name for name, r in records.items() if r["reads"]} == set(FORMATS)
    monkeypatch.setattr("springline.cli.formats.find_spec", lambda name: None if name == "laspy" else object())
    missing = {r["format"]: r for r in json.loads(formats("--json"))}
    assert [name for name, r in missing.items() if not r["installed"]] == ["las"]
    monkeypatch.setenv("COLUMNS", "200")
    assert "pip install 'springline[las]'" in formats()


@pytest.mark.parametrize("name", FORMATS)
def test_every_reader_and_writer_is_there(name):
    form = FORMATS[name]
    for place in (form.reader, form.writer):
        if place:
            module, function = place.split(":")
            assert callable(getattr(import_module(f"springline.io.{module}"), function))


@pytest.mark.parametrize("name", EXPORTS)
def test_every_export_is_there(name):
    assert callable(EXPORTS[name].write_function())
