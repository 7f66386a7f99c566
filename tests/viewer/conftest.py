import pytest
from tests.unit.outputs.finished import finished_survey
from tests.unit.outputs.variants import complete

from .browser import CHROMIUM, Browser


@pytest.fixture(scope="session")
def browser():
    if CHROMIUM is None:
        pytest.skip("needs Chromium (apt-get install chromium)")
    browser = Browser()
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    from springline.outputs.write import write_outputs

    folder = tmp_path_factory.mktemp("pages") / "out"
    write_outputs(finished_survey(stations=600, bearings=180), folder, config_toml="[clean]\n")
    return folder


@pytest.fixture(scope="session")
def complete_folder(tmp_path_factory):
    """Everything that a report can show: verdicts, corrections, layout, liner, joints."""
    from springline.outputs.write import write_outputs

    folder = tmp_path_factory.mktemp("pages") / "complete"
    write_outputs(complete(), folder, config_toml="[clean]\n")
    return folder


@pytest.fixture(scope="session")
def epochs_page(tmp_path_factory):
    """The complete survey beside an earlier one, in which the wall between 4 m and 5 m stood 3 mm further in."""
    from dataclasses import replace

    import numpy as np

    from springline.outputs.results import Results
    from springline.outputs.unroll import unroll
    from springline.outputs.viewer import Epoch, matched, render_viewer

    results = Results(complete())
    wall = unroll(results)
    earlier = matched(wall, unroll(Results(finished_survey(stations=700, bearings=120, seed=5))))
    moved = (earlier.start > 4.0) & (earlier.end < 5.0)
    shape = np.where(moved[:, None], earlier.shape - np.float32(0.003), earlier.shape)
    path = tmp_path_factory.mktemp("epochs") / "viewer.html"
    path.write_text(render_viewer(results, wall, Epoch("2019 <b>", replace(earlier, shape=shape))), encoding="utf-8")
    return path
