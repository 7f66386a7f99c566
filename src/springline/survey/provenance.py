"""Where a survey came from, and the sentences that travel with it."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from .model import Survey

_BLOCK = 1 << 20


@dataclass(frozen=True)
class InputFile:
    """One file that a survey was read from."""

    name: str
    bytes: int
    sha256: str


def fingerprint(path: Path) -> InputFile:
    """Return the name, size and sha256 of a file, read in blocks; of a folder, over its files in order of name.

    Args:
        path: A file, or a folder such as a zarr store or a survey folder.
    """
    digest, size = hashlib.sha256(), 0
    files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
    for file in files:
        if path.is_dir():
            digest.update(file.relative_to(path).as_posix().encode())
        with file.open("rb") as stream:
            while block := stream.read(_BLOCK):
                digest.update(block)
                size += len(block)
    return InputFile(path.name, size, digest.hexdigest())


def add_inputs(survey: Survey, *files: InputFile) -> Survey:
    """Return the survey with these input files named in its provenance."""
    record = json.loads(survey.attrs.get("provenance", "{}"))
    record["inputs"] = [*record.get("inputs", []), *(asdict(f) for f in files)]
    return survey.with_attrs(provenance=json.dumps(record))


def add_provenance(survey: Survey, **entries: Any) -> Survey:
    """Return the survey with entries set in its provenance, such as how it was read; None takes one out."""
    record = json.loads(survey.attrs.get("provenance", "{}"))
    kept = {key: value for key, value in (record | entries).items() if value is not None}
    return survey.with_attrs(provenance=json.dumps(kept, ensure_ascii=False))


def add_run(survey: Survey, *, version: str, config: dict) -> Survey:
    """Return the survey with the program's version and its resolved configuration in its provenance."""
    record = json.loads(survey.attrs.get("provenance", "{}"))
    record.update(version=version, config=config)
    return survey.with_attrs(provenance=json.dumps(record))


def add_warning(survey: Survey, *sentences: str) -> Survey:
    """Return the survey with sentences added to its warnings, each once."""
    return survey.with_attrs(warnings=json.dumps(list(dict.fromkeys([*survey.warnings, *sentences]))))


def add_assumption(survey: Survey, *sentences: str) -> Survey:
    """Return the survey with sentences added to its assumptions, each once."""
    return survey.with_attrs(assumptions=json.dumps(list(dict.fromkeys([*survey.assumptions, *sentences]))))
