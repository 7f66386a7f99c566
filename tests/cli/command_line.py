"""The command line, run in this process."""

import contextlib
import io
import sys
from typing import NamedTuple

import pytest

from springline.cli import main


class Done(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


def run(*words: object, cwd=None) -> Done:
    """Run `springline WORDS`."""
    out, err, code = io.StringIO(), io.StringIO(), 0
    with (
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
        contextlib.chdir(cwd or "."),
        pytest.MonkeyPatch.context() as patch,
    ):
        patch.setattr(sys, "argv", ["springline", *map(str, words)])
        try:
            main()
        except SystemExit as stop:
            code = int(stop.code or 0)
    return Done(code, out.getvalue(), err.getvalue())
