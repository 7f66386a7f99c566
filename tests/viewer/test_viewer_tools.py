"""The viewer's tools: picking, measuring, flying, features, two inspections, corrections."""

import json
import tomllib
from math import cos, hypot, sin

import numpy as np
import pytest
from tests.unit.outputs.finished import finished_survey

from springline.outputs.results import Results
from springline.outputs.unroll import unroll
from springline.outputs.viewer import render_viewer
from springline.survey import Survey
from springline.survey.overrides import read_overrides

from .pictures import DRAWN, READY
from .test_viewer_page import places

# The map leaves 44 px for the clock and 8 px at the right, 7 px above and 17 px below.
GUTTER, RIGHT, TOP, BELOW = 44, 8, 7, 17


@pytest.fixture
def page(browser, folder):
    browser.resize(1280, 720)
    browser.open(folder / "viewer.html", "#chainage=18.0", READY)
    browser.run(DRAWN)
    return browser


def choose(page, name, value):
    """Choose an option of a list."""
    page.run(
        f"(() => {{ const list = document.getElementById('{name}'); list.value = '{value}';"
        " list.dispatchEvent(new Event('change')); })()"
    )


def on_map(page, chainage, clock):
    """Click the map at a place of the wall."""
    width, height = page.run(
        "(() => { const m = document.getElementById('map'); return [m.clientWidth, m.clientHeight]; })()"
    )
    x = GUTTER + (chainage - 0.025) / 29.95 * (width - GUTTER - RIGHT)
    y = TOP + ((6 - clock) / 12 % 1) * (height - TOP - BELOW)
    page.click("#map", x / width, y / height)


def test_clicking_the_wall_goes_to_where_the_line_of_sight_meets_it(page):
    page.click("#scene canvas", 0.5, 0.5)
    # The camera looks at the axis, 0.9 rad off it and 0.35 rad up: the near wall stands a radius before it.
    azimuth, elevation, radius = 0.9, 0.35, 0.15
    along = cos(elevation) * cos(azimuth)
    across = hypot(sin(elevation), cos(elevation) * sin(azimuth))
    assert places(page)[0] == pytest.approx(18.0 - along * radius / across, abs=0.012)
    assert len(set(places(page)[::2])) == 1


def test_measures_between_two_places_of_the_map(page):
    page.key("r")
    on_map(page, 2.0, 3.0)
    on_map(page, 3.0, 12.0)
    text = page.run("document.getElementById('measured').textContent")
    straight, along, arc = (
        float(part.split(" mm")[0].split()[-1]) for part in text.split(";")[0:1] + text.split(";")[1].split(",")[:2]
    )
    # There the pipe is round, 300 mm: a quarter of it is 235.6 mm of arc and a chord of 212.1 mm.
    assert along == pytest.approx(1000, abs=40) and arc == pytest.approx(235.6, abs=10)
    assert straight == pytest.approx(hypot(along, 212.1), abs=10)
    assert places(page)[0] == pytest.approx(18.0), "measuring does not move the cursor"
    page.key("r")
    assert page.run("document.getElementById('measured').hidden") is True


def test_flies_through_and_stops(page):
    page.key("f")
    page.wait("Number(document.querySelector('#scene canvas').dataset.chainage) > 18.15")
    assert page.run("document.querySelector('[data-act=inside]').getAttribute('aria-pressed')") == "true"
    page.key("Escape")
    scene, section, strip, _ = places(page)
    assert scene == strip == pytest.approx(section, abs=0.06)
    page.run(DRAWN)
    assert places(page)[0] == scene
    assert page.complaints == []


def test_a_feature_shows_what_is_known_of_it_and_its_picture(page):
    text = page.run("document.getElementById('feature').textContent")
    for words in ("dent", "18.000 ± 0.039 m", "2:00", "500 mm", "-9.0 mm", "0.90", "rings"):
        assert words in text
    middle, corner = page.run(
        """(() => { const c = document.getElementById("patch");
        const at = (x, y) => [...c.getContext("2d").getImageData(x * c.width, y * c.height, 1, 1).data];
        return [at(.5, .5), at(.05, .1)]; })()"""
    )
    assert middle[0] > middle[2] + 60, "the dent's middle stands inward: red-brown"
    assert abs(corner[0] - corner[2]) < 100
    page.run("location.hash = '#chainage=3'")
    page.wait("document.getElementById('feature').hidden")
    choose(page, "feature-list", "0")
    assert places(page)[0] == pytest.approx(9.06)
    assert "lateral" in page.run("document.getElementById('feature').textContent")


def test_corrections_are_saved_as_overrides_that_inspect_reads(page, tmp_path):
    page.run("URL.createObjectURL = (blob) => { window.saved = blob; return '#'; }")
    page.run("HTMLAnchorElement.prototype.click = function () { window.savedAs = this.download; }")
    reason = 'roots \\ "curtain"\u00fc'
    page.key("o")
    fill = """(values) => {
      const field = (name) => document.querySelector(`#correct [name=${name}]`);
      for (const [name, value] of Object.entries(values)) field(name).value = value;
      document.getElementById("correct-form").requestSubmit();
    }"""
    signed = {"author": 'A. "Surveyor"', "date": "2024-05-20", "reason": reason}

    def add(action, values):
        choose(page, "correct-action", action)
        page.run(f"({fill})({json.dumps(values | signed)})")

    add("mask", {"from_m": "12.0", "to_m": "13,5", "from_clock": "4", "to_clock": "8"})
    add("remove", {})
    add("relabel", {"to": "deposit"})
    add("add", {"kind": "joint", "chainage_m": "6"})
    add("datum", {"at_m": "0", "chainage_m": "100"})
    assert page.run("document.querySelectorAll('#correct-list li').length") == 5
    page.run("document.getElementById('correct-save').click()")
    text = page.run("window.saved.text()")
    assert page.run("window.savedAs") == "overrides.toml"
    path = tmp_path / "overrides.toml"
    path.write_text(text, encoding="utf-8")
    assert tomllib.loads(text)["mask"][0]["to_m"] == 13.5
    records = read_overrides(path)
    assert [r["action"] for r in records] == ["mask", "relabel", "remove", "add", "datum"]
    assert {r["reason"] for r in records} == {reason} and {r["author"] for r in records} == {'A. "Surveyor"'}
    assert records[2]["change"]["kind"] == "dent" and records[2]["change"]["chainage_m"] == 18.0
    assert page.complaints == []


def test_nothing_incomplete_is_added(page):
    page.key("o")
    page.run("document.getElementById('correct-form').requestSubmit()")
    assert page.run("document.querySelectorAll('#correct-list li').length") == 0
    assert page.run("document.getElementById('correct-save').disabled") is True


def test_two_inspections_side_by_side_and_their_change(browser, epochs_page):
    browser.resize(1280, 800)
    browser.open(epochs_page, "#chainage=4.5", READY)
    assert browser.run("document.getElementById('other-map').hidden") is True
    browser.key("b")
    assert browser.run("document.getElementById('other-map').clientHeight") > 80
    choose(browser, "mode", "difference")
    assert browser.run("document.getElementById('map-title').textContent") == "Change since 2019 <b>, outward positive"
    assert browser.complaints == []
    blues = browser.run(
        """[4.5, 8.5].map((x) => { const c = document.getElementById("map");
        const at = (c.width / c.clientWidth) * (44 + ((x - .025) / 29.95) * (c.clientWidth - 52));
        const data = c.getContext("2d").getImageData(at + 3, 10, 1, c.height - 30).data;
        let blue = 0; for (let i = 0; i < data.length; i += 4) blue += data[i + 2] > data[i] + 60 ? 1 : 0;
        return blue / (data.length / 4); })"""
    )
    assert blues[0] > 0.9 and blues[1] < 0.3, "outward by 3 mm where the wall stood further in"
    assert "purple those of 2019 <b>" in browser.run("document.getElementById('section-note').textContent")


def test_without_another_inspection_nothing_of_it_is_offered(page):
    assert page.run("document.querySelector('[data-act=beside]').hidden") is True
    assert page.run("[...document.getElementById('mode').options].map((o) => o.value).join()") == "shape,surface"


def test_intensity_is_a_colour_where_it_was_recorded(browser, page, tmp_path):
    assert "intensity" not in page.run("[...document.getElementById('mode').options].map((o) => o.value).join()")
    survey = finished_survey(stations=200, bearings=90, dense=True)
    bright = np.where(np.sin(survey.rings["bearing"].values) > 0, 9.0, 1.0)
    values = np.broadcast_to(bright, survey.rings["range"].shape).astype(np.float32)
    groups = {name: survey.group(name) for name in survey.groups}
    groups["rings"] = survey.rings.assign(intensity=(("ring", "bearing"), values))
    results = Results(Survey(groups, survey.attrs))
    path = tmp_path / "viewer.html"
    path.write_text(render_viewer(results, unroll(results)), encoding="utf-8")
    browser.open(path, "#chainage=10", READY)
    choose(browser, "mode", "intensity")
    browser.run(DRAWN)
    crown, invert = browser.run(
        """[.5, .06].map((share) => { const c = document.getElementById("map");
        const y = (c.height / c.clientHeight) * (7 + share * (c.clientHeight - 24));
        return [...c.getContext("2d").getImageData(c.width * 0.4, y, 1, 1).data].slice(0, 3); })"""
    )
    assert len(set(crown)) == 1 and len(set(invert)) == 1 and crown[0] > 200 > 40 > invert[0]
    assert browser.run("document.querySelector('#scene .scale').textContent.trim()") == "darkbright"
