"""`springline view`: an inspection's pages, served on this machine."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

app = typer.Typer(add_completion=False)


@app.command(epilog="Examples:  springline view report  |  springline view report --full --port 8000")
def view(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A folder that inspect has written.")],
    full: Annotated[
        bool, typer.Option("--full", help="Show every station, however large the page; made anew from the survey.")
    ] = False,
    host: Annotated[
        str,
        typer.Option(
            "--host", metavar="ADDRESS", help="Address to listen on; others than this machine's are open to all."
        ),
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", metavar="NUMBER", min=0, max=65535, help="Port; 0 takes a free one.")
    ] = 0,
    browse: Annotated[bool, typer.Option("--open/--no-open", help="Open a browser.")] = True,
) -> None:
    """Serve the viewer and the report of an inspection on this machine, until Ctrl+C.

    viewer.html opens from disk without this; a long survey's joins neighbouring stations there, and --full does not.
    """
    from ..outputs.viewer.serve import make_server

    server = make_server(directory, host=host, port=port, made=_full(directory) if full else None)
    shown = "127.0.0.1" if host == "0.0.0.0" else host
    address = f"http://{f'[{shown}]' if ':' in shown else shown}:{server.server_address[1]}/viewer.html"
    if host not in ("127.0.0.1", "::1", "localhost"):
        sys.stderr.write(f"warning: everyone who reaches {host} can read what stands in {directory}\n")
    typer.echo(address)
    sys.stdout.flush()
    if browse:
        _browser()(address)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        sys.stderr.write("stopped\n")
    finally:
        server.server_close()


def _full(directory: Path) -> dict[str, bytes]:
    """Return the viewer with every station, made from the saved survey."""
    from ..outputs.results import Results
    from ..outputs.unroll import unroll
    from ..outputs.viewer import render_viewer
    from ..survey import open_survey

    path = directory / "survey.zarr.zip"
    if not path.is_file():
        raise InputError("no survey.zarr.zip stands in it", where=directory, mend="leave out --full, or inspect anew")
    results = Results(open_survey(path))
    wall = unroll(results, cells=sys.maxsize)
    return {"viewer.html": render_viewer(results, wall).encode("utf-8")}


def _browser() -> Callable[[str], object]:
    import webbrowser

    return webbrowser.open
