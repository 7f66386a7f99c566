"""`springline calibrate`: what a sensor gets wrong, from references; what a method is worth, from repeating it."""

from __future__ import annotations

import typer

from . import calibrate_lens, calibrate_ring, calibrate_study

app = typer.Typer(add_completion=False, no_args_is_help=True, help="Calibrate a sensor, or study a method's precision.")
app.command("ring", epilog=calibrate_ring.EXAMPLES)(calibrate_ring.ring)
app.command("lens", epilog=calibrate_lens.EXAMPLES)(calibrate_lens.lens)
app.command("study", epilog=calibrate_study.EXAMPLES)(calibrate_study.study)
