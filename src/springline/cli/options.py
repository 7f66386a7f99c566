"""Options that several commands share."""

from __future__ import annotations

from typing import Annotated

import typer

Json = Annotated[bool, typer.Option("--json", help="Print the summary as JSON on stdout.")]
Force = Annotated[bool, typer.Option("--force", help="Replace what stands at the output.")]
