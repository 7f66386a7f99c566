"""Writing in any format: exports of results, or what `springline.io` reads back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ...errors import InputError, MissingExtraError, nearest
from ...io.registry import FORMATS
from ...io.registry import by_key as format_by_key
from ...io.writing import write as write_survey
from ...survey.files import OwnFolder, replacing
from .registry import EXPORTS, Export

if TYPE_CHECKING:
    from os import PathLike

    from ...survey import Survey


def write(
    survey: Survey,
    path: str | PathLike[str],
    *,
    format: str | None = None,  # noqa: A002 -- the word that the command line uses
    force: bool = False,
) -> Path:
    """Write a survey or its results, by the extension of `path`; a path without one becomes a survey folder.

    `.zarr` and `.zarr.zip` hold everything. Exports such as `.gpkg`, `.xlsx` or `.isybau.xml` hold what their format
    has words for; several share `.xml`, `.csv` and `.txt` and have a longer extension of their own.

    Args:
        survey: The survey.
        path: Where to write.
        format: Key of a format, instead of the extension's.
        force: Replace what stands there.

    Returns:
        The path.

    Raises:
        InputError: The format is unknown, cannot be written, or holds nothing of this survey.
        MissingExtraError: It needs an optional library.
        OutputError: `path` exists without `force`, or the disk refuses; nothing half-written stays.
    """
    path = Path(path)
    export = export_of(path, format or own_format(survey, path))
    if export is None:
        return write_survey(survey, path, format=format, force=force)
    function = export.write_function()
    own = OwnFolder.of(f"an export to {export.key}", export.folder) if export.folder else None
    with replacing(path, force=force, own=own) as temporary:
        try:
            function(survey, temporary)
        except ModuleNotFoundError as error:
            if error.name not in export.libraries:
                raise
            raise MissingExtraError.of(str(export.extra), f"writing {export.title}") from None
    return path


SHARED = (".xml", ".txt")
"""Extensions that several formats share."""


def own_format(survey: Survey, path: Path) -> str | None:
    """Return the format that a survey of observations alone was read from, when `path` may be such a file."""
    if path.suffix.lower() not in SHARED or survey.groups != ("observations",):
        return None
    key = str(survey.observations.attrs.get("format", ""))
    return key if key in EXPORTS and EXPORTS[key].extensions[0].endswith(path.suffix.lower()) else None


def export_of(path: Path, key: str | None = None, *, where: str = "format") -> Export | None:
    """Return the export to write, by `key` or by the extension of `path`; None when it is a format of `io`.

    Raises:
        InputError: Several share the extension, or the key is unknown.
    """
    if key is not None:
        wanted = key.lower().removeprefix(".")
        if wanted in EXPORTS:
            return EXPORTS[wanted]
        if wanted in FORMATS:
            return None
        found = [e for e in EXPORTS.values() if f".{wanted}" in e.extensions]
        if len(found) == 1:
            return found[0]
        _refuse_unknown(wanted, where)
        return None
    name = path.name.lower()
    found = [e for e in EXPORTS.values() if any(name.endswith(extension) for extension in e.extensions)]
    if found:
        return max(found, key=lambda e: max(len(x) for x in e.extensions if name.endswith(x)))
    if path.suffix.lower() == ".xml":
        several = [e for e in EXPORTS.values() if any(x.endswith(".xml") for x in e.extensions)]
        raise InputError(
            "several formats are written as .xml",
            where=path,
            expected=" or ".join(f"{e.extensions[0]} ({e.title})" for e in several),
            mend="name the format with --to",
        )
    if key is None and path.suffix and not any(f.writer and _ends(name, f.extensions) for f in FORMATS.values()):
        kinds = (*(f for f in FORMATS.values() if f.writer), *EXPORTS.values())
        raise InputError(
            "this extension cannot be written",
            where=path,
            expected=", ".join(dict.fromkeys(e for f in kinds for e in f.extensions if e)),
            mend="name the format with --to",
        )
    return None


def _ends(name: str, extensions: tuple[str, ...]) -> bool:
    return any(extension and name.endswith(extension) for extension in extensions)


def _refuse_unknown(key: str, where: str) -> None:
    """Raise when no format at all is called `key`."""
    if any(f".{key}" in f.extensions for f in FORMATS.values()):
        return
    known = list(dict.fromkeys([*FORMATS, *EXPORTS]))
    raise InputError(f"the format '{key}' is unknown{nearest(key, known)}", where=where, expected=", ".join(known))


def known_format(key: str, *, where: str) -> str:
    """Return the key of a format of either kind, which may be given as an extension.

    Raises:
        InputError: It is unknown.
    """
    export = export_of(Path("x"), key, where=where)
    return export.key if export is not None else format_by_key(key, where=where).key
