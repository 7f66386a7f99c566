"""Reading of any format, of several parts of one survey, and of several surveys."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError, SpringlineError
from ..survey import Survey, add_assumption, fingerprint, validate
from ..survey.overrides import with_overrides
from ..survey.provenance import add_inputs, add_provenance
from . import registry
from .options import ReadOptions
from .parts import combine

if TYPE_CHECKING:
    from os import PathLike

    from .registry import Format

_FLAGS = {"nominal_diameter": "--nominal", "bearing_zero": "--bearing-zero", "bearing_sense": "--bearing-sense",
          "depth_unit": "--depth-unit"}  # fmt: skip

OVERRIDES = "overrides.toml"
"""Name of the file of corrections that people make, beside a survey."""


@dataclass(frozen=True)
class Unreadable:
    """An input that could not be read, and why."""

    path: Path
    reason: str


def read(
    source: str | PathLike[str] | Iterable[str | PathLike[str]],
    *,
    nominal_diameter: float | None = None,
    format: str | None = None,  # noqa: A002 -- the word that the command line uses
    unit: str | None = None,
    bearing_zero: str | None = None,
    bearing_sense: str | None = None,
    intrinsics: Sequence[float] | None = None,
    depth_unit: str | None = None,
    axes: str | None = None,
    sensor: str | None = None,
    name: str | None = None,
) -> Survey:
    """Read a scan of any known format, or several parts of one scan.

    The format is told by content. What the file does not say and the user does not state is assumed by a stated rule
    and told in `Survey.assumptions`; what cannot be assumed safely is refused.

    Args:
        source: A file, a survey folder, a zarr store; or a list of parts, which are joined: clouds seen from one
            place into one cloud, ring tables that follow one another into one run.
        nominal_diameter: Nominal diameter [m].
        format: Key of a format, instead of the guess; see `springline formats`.
        unit: Unit of a cloud's coordinates or a ring table's ranges: mm, cm, m, in or ft.
        bearing_zero: Where the device's zero lies: right, crown, left or invert.
        bearing_sense: ccw or cw, seen looking forward.
        intrinsics: Pinhole fx, fy, cx, cy [pixel] of a depth image.
        depth_unit: Unit of one count of a depth image; mm when not given.
        axes: Which file axes make x forward, y up, z right, such as "-z,y,x".
        sensor: Kind of range sensor, one of `conventions.SENSOR_KINDS`.
        name: Asset name; the file's stem when not given.

    Returns:
        A survey that follows the contract of `springline.conventions`.

    Raises:
        InputError: The input is missing, empty, damaged or contradicts itself or the options; file and place named.
        MissingExtraError: The format needs an optional library.

    >>> import tempfile
    >>> from pathlib import Path
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     table = Path(folder) / "run.csv"
    ...     _ = table.write_text("distance_m,r_0_mm,r_1_mm,r_2_mm,r_3_mm" + chr(10) + "0,150,151,150,149" + chr(10))
    ...     survey = read(table, nominal_diameter=0.3, bearing_zero="crown", bearing_sense="cw")
    >>> survey.rings["range"].values  # from +z counter-clockwise: right, crown, left, invert
    array([[0.151, 0.15 , 0.149, 0.15 ]], dtype=float32)
    """
    options = ReadOptions(
        nominal_diameter=nominal_diameter,
        format=format,
        unit=unit,
        bearing_zero=bearing_zero,
        bearing_sense=bearing_sense,
        intrinsics=intrinsics,
        depth_unit=depth_unit,
        axes=axes,
        sensor=sensor,
        name=name,
    )
    if isinstance(source, (str, Path)) or not isinstance(source, Iterable):
        return read_one(Path(source), options)
    paths = [Path(p) for p in source]
    if len(paths) == 1:
        return read_one(paths[0], options)
    return combine([read_one(p, options, strict=False) for p in paths], paths, options)


def read_one(path: Path, options: ReadOptions, *, strict: bool = True) -> Survey:
    """Read one input.

    Args:
        path: A file, a survey folder or a zarr store.
        options: What the user states.
        strict: Refuse options that mean nothing to the input's format; they are passed over otherwise, as one set of
            options may serve inputs of several formats.

    Raises:
        InputError: As `read`.
    """
    kind = _format_of(path, options)
    _check_options(kind, options, path, strict=strict)
    try:
        survey = kind.read_function()(path, options.only(kind.options))
        inputs = fingerprint(path)
    except MemoryError:
        raise InputError("it does not fit into memory", where=path, mend="split it into parts") from None
    except OSError as error:
        if isinstance(error, SpringlineError):
            raise
        raise InputError(f"cannot be read: {error.strerror or error}", where=path) from None
    name = options.name or survey.attrs.get("name") or _stem(path)
    survey = survey.with_attrs(name=name)
    if options.nominal_diameter is not None:
        survey = survey.with_attrs(nominal_diameter=options.nominal_diameter)
    read = {"names": [path.name], "options": options.only(kind.options).values()}
    # What was given at an earlier inspection is in the survey by now and need not be given again.
    survey = add_provenance(add_inputs(survey, inputs), read=read, calibration=None, overrides=None)
    survey = validate(survey, where=str(path))
    beside = overrides_beside(path)
    if beside is None:
        return survey
    survey = with_overrides(survey, beside)
    if survey.has("section"):
        return survey
    count = len(survey.overrides)
    return add_assumption(survey, f"{count} correction{'s' * (count != 1)} made by hand stand in {beside.name}.")


def overrides_beside(path: Path) -> Path | None:
    """Return the file of corrections that goes with an input: `overrides.toml` in a survey folder; beside another
    input `NAME.overrides.toml` after its stem, or else `overrides.toml`. None when there is none."""
    if (path / "survey.toml").is_file():
        places = [path / OVERRIDES]
    else:
        places = [path.with_name(f"{_stem(path)}.{OVERRIDES}"), path.with_name(OVERRIDES)]
    return next((place for place in places if place.is_file()), None)


def read_many(
    paths: Iterable[str | PathLike[str]], options: ReadOptions | None = None, *, keep_going: bool = False
) -> tuple[dict[str, Survey], list[Unreadable]]:
    """Read several inputs, each into a survey of its own.

    Args:
        paths: Files, survey folders, zarr stores, or folders of such, whose visible entries count one by one.
        options: What the user states, for all of them; each format takes what means something to it.
        keep_going: Pass over inputs that cannot be read instead of refusing all.

    Returns:
        Surveys by name (the file's stem, made unique), and the inputs that could not be read.

    Raises:
        InputError: An input cannot be read and `keep_going` is not set, every one named; or none can be read.
    """
    options = options or ReadOptions()
    surveys: dict[str, Survey] = {}
    unreadable: list[Unreadable] = []
    found = expand(Path(p) for p in paths)
    _one_survey_each(found)
    for path in found:
        try:
            survey = read_one(path, options, strict=len(found) == 1)
        except SpringlineError as error:
            if len(found) == 1:
                raise
            unreadable.append(Unreadable(path, str(error)))
            continue
        surveys[_unique(path, surveys)] = survey
    if unreadable and not (keep_going and surveys):
        listed = "\n  ".join(u.reason for u in unreadable)
        raise InputError(
            f"{len(unreadable)} of {len(found)} inputs cannot be read:\n  {listed}\n",
            mend="Pass --keep-going to go on with the rest" if surveys else "Nothing is left to go on with",
        )
    return surveys, unreadable


def expand(paths: Iterable[Path]) -> list[Path]:
    """Return inputs one by one: a folder that is no survey itself stands for its visible entries, in order of name.

    Raises:
        InputError: A folder is empty.
    """
    found: list[Path] = []
    for path in paths:
        if not path.is_dir() or any((path / mark).exists() for mark in ("survey.toml", "zarr.json", ".zgroup")):
            found.append(path)
            continue
        entries = sorted(p for p in path.iterdir() if not p.name.startswith(".") and not p.name.endswith(OVERRIDES))
        if not entries:
            raise InputError("the folder is empty", where=path)
        found += entries
    return found


def _one_survey_each(paths: list[Path]) -> None:
    """Refuse one file of corrections for several surveys: its places are those of one."""
    beside = [place for place in map(overrides_beside, paths) if place is not None]
    for place in beside:
        if beside.count(place) > 1:
            raise InputError(
                f"it stands beside {beside.count(place)} surveys",
                where=place,
                expected="a file for one survey",
                mend=f"name it after that survey: NAME.{OVERRIDES}",
            )


def _format_of(path: Path, options: ReadOptions) -> Format:
    if options.format is None:
        return registry.guess(path)
    registry.require_there(path)
    if path.is_file() and path.stat().st_size == 0:
        raise InputError("the file is empty", where=path)
    return registry.by_key(options.format)


def _check_options(kind: Format, options: ReadOptions, path: Path, *, strict: bool) -> None:
    idle = [name for name in options.stated() if name not in kind.options]
    if strict and idle:
        flag = _FLAGS.get(idle[0], f"--{idle[0]}")
        raise InputError(
            f"{flag} means nothing to a file of the format '{kind.key}' ({kind.title})",
            where=path,
            mend=f"leave out {flag}, or name another format with --format",
        )


def _stem(path: Path) -> str:
    name = path.resolve().name
    return name.removesuffix(".zip").removesuffix(".zarr") if name.endswith((".zip", ".zarr")) else Path(name).stem


def _unique(path: Path, taken: Iterable[str]) -> str:
    known, stem = set(taken), _stem(path)
    if stem not in known:
        return stem
    base = f"{stem}_{path.suffix.lstrip('.')}" if path.suffix else stem
    name, count = base, 2
    while name in known:
        name, count = f"{base}_{count}", count + 1
    return name
