import pytest

from .finished import finished_survey


@pytest.fixture(scope="session")
def survey():
    return finished_survey()
