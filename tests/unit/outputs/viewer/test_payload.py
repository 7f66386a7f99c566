import base64
import json
import re
import zlib

import numpy as np
import pytest
from tests.unit.outputs.finished import finished_survey

from springline.outputs.results import Results
from springline.outputs.unroll import unroll
from springline.outputs.viewer import render_viewer
from springline.outputs.viewer.payload import pack
from springline.survey import Survey


def unpacked(header, payload):
    data, offset, arrays = zlib.decompress(base64.b64decode(payload)), 0, {}
    for name, kind, count in header["arrays"]:
        arrays[name] = np.frombuffer(data, np.dtype(f"<{kind}"), count, offset)
        offset += arrays[name].nbytes
    assert offset == len(data)
    return arrays


def test_what_the_viewer_gets_is_the_wall_to_a_tick(survey):
    wall = unroll(Results(survey))
    header, payload = pack(Results(survey), wall)
    arrays = unpacked(header, payload)
    shape = arrays["shape"].reshape(wall.shape.shape).astype(float)
    used = wall.reason == 0
    np.testing.assert_allclose(shape[used] * header["tick"], wall.shape[used], atol=0.51 * header["tick"])
    np.testing.assert_array_equal(shape[~used] + 32768, wall.reason[~used])
    np.testing.assert_allclose(arrays["diameter_max"], survey.metrics["diameter_max"].values, rtol=1e-6)
    assert header["reference"] == pytest.approx(0.3) and len(header["features"]) == 2


def test_joined_groups_speak_through_their_worst_station(survey):
    results = Results(survey)
    wall = unroll(results, cells=180 * 100)
    arrays = unpacked(*pack(results, wall))
    assert arrays["deflection"].size == wall.start.size < 130
    assert np.nanmax(arrays["deflection"]) == pytest.approx(np.nanmax(survey.metrics["deflection"].values))
    inside = (arrays["chainage"] >= wall.start - 1e-9) & (arrays["chainage"] <= wall.end + 1e-9)
    assert inside.all()


def test_page_is_one_file_without_addresses_and_with_its_licence():
    survey = finished_survey(stations=40, bearings=36, name="</script><b>\"x\" & 'y'", dense=True)
    page = render_viewer(Results(survey), unroll(Results(survey)))
    outside = set(re.findall(r"\w+://[\w./]+", page))
    assert outside <= {"http://www.w3.org/1999/xhtml"}
    assert not re.search(r"""(?:src|href)=["'](?!report\.html)|url\((?!data:)|@import|sourceMappingURL""", page)
    assert "The MIT License" in page and "three.js authors" in page
    assert page.count("</script>") == 4 and "<b>" not in page.split("<script")[0]
    header = re.search(r'id="header">(.*?)</script>', page).group(1)
    assert json.loads(header)["name"] == "</script><b>\"x\" & 'y'"


def test_intensity_is_the_mean_of_used_readings(survey):
    bright = np.where(np.sin(survey.rings["bearing"].values) > 0, 200.0, 100.0)
    values = np.broadcast_to(bright, survey.rings["range"].shape).astype(np.float32)
    groups = {name: survey.group(name) for name in survey.groups}
    groups["rings"] = survey.rings.assign(intensity=(("ring", "bearing"), values))
    results = Results(Survey(groups, survey.attrs))
    wall = unroll(results)
    header, payload = pack(results, wall)
    found = unpacked(header, payload)["intensity"].reshape(wall.shape.shape)
    upper, lower = (np.sin(wall.bearing) * side > 0.3 for side in (1, -1))
    assert set(np.unique(found[:, upper])) == {0, 255} and set(np.unique(found[:, lower])) == {0, 1}
    np.testing.assert_array_equal(found == 0, ~np.isfinite(wall.shape))
    assert header["arrays"][-1][:2] == ["intensity", "u1"] and len(header["palette"]) <= 256
