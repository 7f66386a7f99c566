"""Stations that do not speak for the pipe are left out of charts, and of what stands for a group."""

import base64
import zlib

import numpy as np

from springline.outputs.results import Results
from springline.outputs.unroll import unroll
from springline.outputs.viewer.payload import pack
from springline.survey import Survey

from ..finished import finished_survey


def arrays(header, packed):
    content, out, at = zlib.decompress(base64.b64decode(packed)), {}, 0
    for name, kind, count in header["arrays"]:
        out[name] = np.frombuffer(content, np.dtype(f"<{kind}"), count, at)
        at += out[name].nbytes
    return out


def flagged(bad):
    survey = finished_survey(stations=400, bearings=36)
    flags = np.where(np.arange(survey.section.sizes["station"]) == bad, "unlike_neighbours", "")
    widest = survey.metrics["deflection"].values.copy()
    widest[bad] = 0.5
    groups = {name: survey.group(name) for name in survey.groups}
    groups["section"] = survey.section.assign(flags=("station", flags))
    groups["metrics"] = survey.metrics.assign(deflection=("station", widest))
    return Results(Survey(groups, survey.attrs))


def test_the_misread_station_is_told_apart():
    results = flagged(50)
    found = arrays(*pack(results, unroll(results)))
    assert np.flatnonzero(found["speaks"] == 0).tolist() == [50]
    assert found["deflection"][50] == 0.5


def test_it_does_not_stand_for_its_group():
    results = flagged(50)
    found = arrays(*pack(results, unroll(results, cells=100 * 18)))
    assert found["speaks"].size < 200 and found["speaks"].all()
    assert np.nanmax(found["deflection"]) < 0.1
