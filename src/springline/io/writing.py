"""Writing of a survey in any format, whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..survey import save_survey
from ..survey.files import SURVEY_FOLDER, replacing
from . import registry

if TYPE_CHECKING:
    from os import PathLike

    from ..survey import Survey
    from .registry import Format


def write(
    survey: Survey,
    path: str | PathLike[str],
    *,
    format: str | None = None,  # noqa: A002 -- the word that the command line uses
    force: bool = False,
) -> Path:
    """Write a survey, by the extension of `path`; a path without one becomes a survey folder.

    `.zarr` and `.zarr.zip` hold everything; the other formats hold one group, and `left_out` tells what they lose.

    Args:
        survey: The survey.
        path: Where to write.
        format: Key of a format, instead of the extension's.
        force: Replace what stands there.

    Returns:
        The path.

    Raises:
        InputError: The format is unknown, cannot be written, or holds nothing of this survey.
        OutputError: `path` exists without `force`, or the disk refuses (full, read-only); nothing half-written stays.
    """
    path = Path(path)
    kind = output_format(path, format)
    if kind.key == "zarr":
        return save_survey(survey, path, force=force)
    function = kind.write_function()
    if kind.groups and not any(survey.has(group) for group in kind.groups):
        raise InputError(
            f"the survey has none of /{', /'.join(kind.groups)}, which is what {kind.key} holds",
            where=path,
            mend="choose another format; see: springline formats",
        )
    own = SURVEY_FOLDER if kind.key == "folder" else None
    with replacing(path, force=force, own=own) as temporary:
        function(survey, temporary)
    return path


def output_format(path: Path, key: str | None = None) -> Format:
    """Return the format to write, by `key` or by the extension of `path`.

    Raises:
        InputError: None is known by it, or it can be read only.
    """
    if key is None:
        name = path.name.lower()
        kind = next(
            (f for f in registry.FORMATS.values() if f.writer and any(e and name.endswith(e) for e in f.extensions)),
            None,
        )
        kind = registry.FORMATS["folder"] if kind is None and not path.suffix else kind
    else:
        kind = registry.by_key(key)
    if kind is None or not kind.writer:
        raise InputError(
            f"{'the format ' + repr(kind.key) if kind else 'this extension'} cannot be written",
            where=path,
            expected=", ".join(e for f in registry.FORMATS.values() if f.writer for e in f.extensions if e),
            mend="name the format with --to",
        )
    return kind


def left_out(survey: Survey, kind: Format) -> list[str]:
    """Return what of the survey a format does not hold: groups as '/name', variables as '/group variable'."""
    if kind.holds_all:
        return []
    held = [group for group in kind.groups if survey.has(group)]
    if kind.holds == "clouds":
        held = held[:1]
    lost = [f"/{group}" for group in survey.groups if group not in held]
    if kind.holds == "clouds" and held == ["rings"]:
        lost.append("which ring a point belongs to")
    for group in held:
        data = survey.group(group)
        lost += [f"/{group} {v}" for v in map(str, data.variables) if kind.variables and v not in kind.variables]
        if kind.key == "csv" and data.attrs.get("referred_to", "sensor") != "sensor":
            lost.append(f"/{group} referred_to = {data.attrs['referred_to']}")
    return lost
