"""The built-in survey: 30 m of 300 mm pipe, small enough to ship, with everything in it that the main job must meet.

python -m springline.simulate.builtin OUT.zarr.zip
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

SEED = 2026


def main(path: str | Path) -> None:
    """Write the survey of the ready scenario `builtin` to `path`."""
    from ..survey import save_survey
    from .simulation import simulate

    save_survey(simulate("builtin", SEED), path, force=True)


if __name__ == "__main__":
    main(sys.argv[1])
