"""The built-in survey: 30 m of simulated 300 mm pipe with known truth."""

from __future__ import annotations

from pathlib import Path


def builtin_survey() -> Path:
    """Return the path of the built-in survey, made by `python -m springline.simulate.builtin`.

    >>> builtin_survey().name
    'builtin.zarr.zip'
    """
    return Path(__file__).with_name("builtin.zarr.zip")
