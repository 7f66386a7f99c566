"""Running the chain from the command line: progress on stderr, results into a folder, a few lines at the end."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

import typer

from ..errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from ..config import Config
    from ..survey import Survey


def refuse_existing(output: Path, *, force: bool) -> None:
    """Refuse before the work rather than after it."""
    if output.exists() and not force:
        raise InputError("it exists already", where=output, mend="choose another folder or pass --force")


def inspect_into(
    survey: Survey,
    directory: Path,
    config: Config,
    *,
    back: Survey | None = None,
    checks: tuple[str, ...] = (),
    force: bool = False,
) -> dict[str, Any]:
    """Inspect a survey, write every output into `directory` and return its summary.

    Raises:
        SpringlineError: The survey cannot be inspected, a rule is unknown, or the folder cannot be written.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from ..config import dump_config
    from ..outputs.summary import summary
    from ..outputs.write import write_outputs
    from ..pipeline import inspect

    columns = (TextColumn("{task.description:<16}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("reading", total=1.0)
        result = inspect(
            survey,
            config,
            back=back,
            checks=checks,
            progress=lambda stage, done: bar.update(task, description=stage, completed=0.8 * done),
        )
        written = write_outputs(
            result,
            directory,
            config_toml=dump_config(config),
            force=force,
            progress=lambda name: bar.update(task, description=name),
        )
    if directory / "report.pdf" not in written:
        sys.stderr.write('warning: report.pdf was left out; it needs: pip install "springline[pdf]"\n')
    return summary(result)


def tell(found: dict[str, Any], directory: Path) -> None:
    """Print what was found in a few lines, warnings first on stderr."""
    for sentence in found["warnings"]:
        sys.stderr.write(f"warning: {sentence}\n")
    for sentence in found["assumptions"]:
        sys.stderr.write(f"assumed: {sentence}\n")
    lines = [
        f"{found['name']}: {found['length_m']:g} m, {found['stations']} stations, {found['coverage_pct']:g} % seen",
        f"  mean diameter    {_value(found['diameter_mean_mm'], 'mm')} +- {_value(found['diameter_sigma_mm'], 'mm')}"
        f" (fit {_value(found['diameter_sigma_fit_mm'])}, scale {_value(found['diameter_sigma_scale_mm'])})",
        f"  largest ovality  {_value(found['ovality_polar_max_pct'], '%')} +-"
        f" {_value(found['ovality_polar_max_sigma_pct'], '%')} at {_value(found['ovality_polar_max_chainage_m'], 'm')}",
    ]
    if found["deflection_max_pct"] is not None:
        where = _value(found["deflection_max_chainage_m"], "m")
        sigma = _value(found["deflection_max_sigma_pct"], "%")
        lines.append(f"  most deflection  {_value(found['deflection_max_pct'], '%')} +- {sigma} at {where}")
    if found.get("deviation_up_max_mm") is not None:
        where = _value(found["deviation_up_max_chainage_m"], "m")
        lines.append(f"  off its design   {_value(found['deviation_up_max_mm'], 'mm')} up at {where}")
    if found.get("deviation_right_max_mm") is not None:
        where = _value(found["deviation_right_max_chainage_m"], "m")
        lines.append(f"                   {_value(found['deviation_right_max_mm'], 'mm')} to the right at {where}")
    lines += [f"  rule {rule['rule']}: {rule['verdict']}" for rule in found["rules"]]
    typer.echo("\n".join(lines))
    typer.echo(f"  report           {directory / 'report.html'}")


def finish(found: list[dict[str, Any]]) -> None:
    """Exit with 3 when a rule asked for did not pass."""
    if any(rule["verdict"] != "pass" for one in found for rule in one["rules"]):
        raise typer.Exit(3)


def as_json(found: Any) -> None:
    """Print a summary as JSON on stdout."""
    typer.echo(json.dumps(found, indent=2, ensure_ascii=False))


def _value(number: float | None, unit: str = "") -> str:
    text = "not available" if number is None else f"{number:.2f}"
    return f"{text} {unit}".strip()
