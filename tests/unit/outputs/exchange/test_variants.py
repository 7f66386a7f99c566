"""Every export of surveys that are short, long, mostly unseen, without features or without any section."""

import numpy as np
import pytest

import springline as sl
from springline.errors import InputError
from springline.outputs.exchange import EXPORTS

from ..finished import finished_survey
from .conftest import with_layout


def one_station():
    survey = finished_survey(stations=40, bearings=36)
    return sl.Survey(
        {
            name: survey.group(name).isel({d: [5] for d in ("ring", "station") if d in survey.group(name).dims})
            for name in survey.groups
        },
        survey.attrs,
    )


def unseen():
    """Return a survey with readings, and no station with a section."""
    survey = finished_survey(stations=20, bearings=36)
    lost = {
        name: survey.group(name).map(lambda v: v * np.nan if v.dtype.kind == "f" and v.name != "chainage" else v)
        for name in ("section", "metrics")
    }
    for name in lost:
        lost[name]["chainage"] = survey.group(name)["chainage"]
        lost[name].attrs = {"diameter_mean": np.nan}
    held = {name: survey.group(name) for name in survey.groups if name != "features"}
    return sl.Survey({**held, **lost}, survey.attrs)


def no_features():
    survey = finished_survey(stations=20, bearings=36)
    return survey.corrected("features", survey.features.isel(feature=[]))


def tenth_of_a_metre():
    return finished_survey(stations=4, bearings=36, length=0.1)


def nameless():
    return finished_survey(stations=20, bearings=36).with_attrs(name=None, date=None, operator=None, material=None)


CASES = (one_station, unseen, no_features, tenth_of_a_metre, nameless)


@pytest.mark.parametrize("make", CASES, ids=lambda make: make.__name__)
@pytest.mark.parametrize("key", EXPORTS)
def test_it_is_written_or_refused_with_a_reason(make, key, tmp_path):
    survey = make()
    laid = with_layout(survey) if survey.section.sizes["station"] > 1 else survey
    path = tmp_path / f"a{EXPORTS[key].extensions[0]}"
    refused = None
    try:
        sl.write(laid, path, format=key)
    except InputError as error:
        refused = str(error)
    if make is unseen and key in ("obj", "ply-mesh", "vtu"):
        assert "no wall was seen" in refused
    elif make is one_station and key == "landxml":
        assert "where the pipe runs" in refused
    elif make is one_station and key in ("obj", "ply-mesh", "vtu"):
        assert refused is None or "no wall" in refused
    else:
        assert refused is None and path.exists()
