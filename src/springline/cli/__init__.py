"""The command line: one file per command; the library raises, this explains.

Exit codes: 0 done; 1 a fault of ours; 2 the input or the command is wrong; 3 done, and a rule asked for did not pass.
"""

from __future__ import annotations

import signal
import sys
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from .. import __version__
from ..errors import SpringlineError

# Commands load only when they are called, so that `springline --help` stays quick.
_COMMANDS = {
    "inspect": "Read a scan, find the section at every station, and write numbers and a report.",
    "demo": "Run the main job on the built-in survey.",
    "formats": "List the formats that can be read and written.",
    "convert": "Convert a survey from one format to another.",
    "calibrate": "Calibrate a sensor from references, or study a method's precision.",
    "simulate": "Simulate a survey with known truth from a scenario.",
    "view": "Serve an inspection's viewer and report on this machine.",
    "detect": "Find joints in CCTV frames, from the images alone.",
    "compare": "Compare two inspections of one pipe or more: what changed, and what cannot be said.",
    "design": "Size a liner, from numbers or along an inspected pipe.",
    "reproduce": "Make the dissertation's tables and figures again, beside what was printed.",
}


class _LazyGroup(TyperGroup):
    """A group whose commands are imported when they are called."""

    def list_commands(self, ctx: Any) -> list[str]:
        return list(_COMMANDS)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        if cmd_name not in _COMMANDS:
            return None
        if ctx.resilient_parsing or _only_listing():
            return typer.main.get_command(_listed(cmd_name))
        command = typer.main.get_command(import_module(f".{cmd_name}", __name__).app)
        command.name = cmd_name
        return command


def _only_listing() -> bool:
    words = [word for word in sys.argv[1:] if not word.startswith("-")]
    return not words


def _listed(name: str) -> typer.Typer:
    stand_in = typer.Typer(add_completion=False)
    stand_in.command(name, help=_COMMANDS[name])(lambda: None)
    return stand_in


app = typer.Typer(
    cls=_LazyGroup,
    add_completion=False,
    no_args_is_help=True,
    help="Quantitative pipe inspection: true cross-sections with their uncertainty.",
    epilog="Try: springline demo",
)


def _say_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"springline {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_say_version, is_eager=True, help="Say the version and exit.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line; every deliberate error becomes one message on stderr and exit code 2.

    A request to end (SIGTERM, as of `timeout` and of services) is taken as Ctrl-C is: nothing half-written stays.
    """
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        app(standalone_mode=True)
    except SpringlineError as error:
        sys.stderr.write(f"springline: {error}\n")
        sys.exit(2)
    except (KeyboardInterrupt, SystemError) as error:
        if not _is_interrupt(error):
            raise
        sys.stderr.write("springline: stopped; nothing was written\n")
        sys.exit(130)
    finally:
        signal.signal(signal.SIGTERM, before)


def _is_interrupt(error: BaseException | None) -> bool:
    """Return whether Ctrl-C is behind an error: within a compiled kernel it comes out as a SystemError."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__ or error.__context__
    return error is not None
