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
