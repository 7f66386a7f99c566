"""`springline simulate`: a survey with known truth from a scenario."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError, OutputError
from .options import Force

app = typer.Typer(add_completion=False)


@app.command(
    epilog="Examples:  springline simulate --list  |  springline simulate weaving -o survey.zarr.zip --seed 3  |  "
    "springline simulate my-pipe.toml -o survey-folder"
)
def simulate(
    scenario: Annotated[
        str | None, typer.Argument(metavar="SCENARIO", help="A scenario file in TOML, or a ready scenario's name.")
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="OUT", help="NAME.zarr.zip, NAME.zarr, or any format that can be written."
        ),
    ] = None,
    seed: Annotated[
        int, typer.Option("--seed", min=0, max=2**32 - 1, metavar="N", help="Seed of the measurement's noise.")
    ] = 0,
    list_ready: Annotated[bool, typer.Option("--list", help="List the ready scenarios.")] = False,
    force: Force = False,
) -> None:
    """Simulate a survey with known truth from a scenario.

    Rays are cast on the true wall of a pipe in space; the truth is stored in the survey's group /truth, which no stage
    reads. A zarr output is written block by block, so that its length is not limited by memory. A camera's frames are
    rendered into NAME-frames beside a zarr output, or into frames/ of a survey folder.
    """
    from ..simulate import scenarios

    if list_ready:
        ready = scenarios()
        width = max(map(len, ready))
        typer.echo("\n".join(f"{name:<{width}}  {description}" for name, description in ready.items()))
        return
    if scenario is None:
        raise InputError("no scenario was named", mend="name a TOML file or a ready scenario; --list shows those")
    if output is None:
        raise InputError("no output was named", mend="add -o survey.zarr.zip")
    if output.exists() and not force:
        raise OutputError("it exists already", where=output, mend="choose another name or pass --force")
    _run(scenario, output, seed, force)
    typer.echo(f"{output}: simulated from '{scenario}', seed {seed}")


def _run(scenario: str, output: Path, seed: int, force: bool) -> None:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    from ..io.writing import left_out, output_format, write
    from ..simulate import Footage, simulate_to
    from ..simulate import simulate as run
    from ..simulate.camera.writing import write_frames
    from ..survey.files import SURVEY_FOLDER, replacing

    kind = output_format(output, None)
    lost: list[str] = []
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("simulating", total=1.0)
        if kind.holds_all:
            simulate_to(output, scenario, seed, force=force, progress=lambda done: bar.update(task, completed=done))
        else:
            survey = run(scenario, seed)
            lost = left_out(survey, kind)
            if kind.key == "folder" and survey.has("frames"):
                with replacing(output, force=force, own=SURVEY_FOLDER) as folder:
                    write(survey, folder, format=kind.key)
                    write_frames(
                        Footage(scenario, seed),
                        folder / "frames",
                        progress=lambda done: bar.update(task, completed=done),
                    )
            else:
                write(survey, output, format=kind.key, force=force)
    if lost:
        sys.stderr.write(f"not held by {kind.key}: {', '.join(lost)}\n")
