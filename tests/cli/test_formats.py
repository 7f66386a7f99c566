"""`springline formats`: what is listed is what can be done."""

from __future__ import annotations

import json
import sys
from importlib import import_module

import pytest

from springline.cli import main
from springline.io.registry import FORMATS


@pytest.fixture
def formats(monkeypatch, capsys):
    def call(*words: str) -> str:
        monkeypatch.setattr(sys, "argv", ["springline", "formats", *words])
        with pytest.raises(SystemExit) as stop:
            main()
        assert not stop.value.code
        return capsys.readouterr().out

    return call


def test_table(formats, monkeypatch):
    monkeypatch.setenv("COLUMNS", "160")
    out = formats()
    for name in FORMATS:
        assert f" {name} " in out


def test_json_and_a_missing_extra(formats, monkeypatch):
    records = {r["format"]: r for r in json.loads(formats("--json"))}
    assert list(records) == list(FORMATS)
    assert {name for name, r in records.items() if r["writes"]} == {"ply", "las", "csv", "parquet", "folder", "zarr"}
    assert all(r["reads"] for r in records.values())
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
