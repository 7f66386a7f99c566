"""Make the reference pictures anew: `python -m tests.viewer.make_references`; look at them before they are kept."""

from __future__ import annotations

import tempfile
from pathlib import Path

from PIL import Image
from tests.unit.outputs.finished import finished_survey

from springline.outputs.write import write_outputs

from .browser import Browser
from .pictures import REFERENCES, VIEWS, take


def main() -> None:
    REFERENCES.mkdir(exist_ok=True)
    browser = Browser()
    with tempfile.TemporaryDirectory() as folder:
        run = Path(folder) / "run"
        write_outputs(finished_survey(stations=600, bearings=180), run, config_toml="[clean]\n")
        for view in VIEWS:
            Image.fromarray(take(browser, run, view).astype("uint8")).save(REFERENCES / f"{view}.png")
    browser.close()


if __name__ == "__main__":
    main()
