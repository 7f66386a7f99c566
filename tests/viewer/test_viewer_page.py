"""The viewer in a real browser, opened from disk and drawn in software."""

import io
import re

import numpy as np
import pytest

READY = "document.body.dataset.ready"


def places(browser):
    """Chainage at which the scene, the section, the map and the address stand."""
    return browser.run(
        """[document.querySelector("#scene canvas").dataset.chainage,
        document.querySelector("#section canvas").dataset.chainage,
        document.getElementById("map").dataset.chainage, location.hash.split("=")[1]].map(Number)"""
    )


@pytest.fixture
def page(browser, folder):
    browser.resize(1280, 720)
    browser.open(folder / "viewer.html", "#chainage=18.0", READY)
    return browser


def test_opens_at_the_linked_chainage_without_a_complaint_or_a_request(page, folder):
    assert page.run(READY) == "yes"
    assert page.complaints == []
    assert page.requests == [(folder / "viewer.html").as_uri() + "#chainage=18.0"] or page.requests == [
        (folder / "viewer.html").as_uri()
    ]
    assert places(page) == pytest.approx([18.0] * 4, abs=0.03)


def test_the_pipe_is_drawn_in_the_colours_of_the_scale(page):
    image = pytest.importorskip("PIL.Image")
    page.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    box = page.run(
        "(() => { const b = document.querySelector('#scene').getBoundingClientRect();"
        " return [b.left, b.top, b.right, b.bottom]; })()"
    )
    picture = image.open(io.BytesIO(page.screenshot())).convert("RGB").crop([round(v) for v in box])
    red, _, blue = np.moveaxis(np.asarray(picture, int), 2, 0)
    assert (blue > red + 60).mean() > 0.05 and (red > blue + 40).mean() > 0.01


def test_clicking_the_map_moves_scene_section_and_address(page):
    page.click("#map", share_x=0.5)
    scene, section, strip, address = places(page)
    assert scene == strip == pytest.approx(address, abs=1e-3)
    # The map leaves 44 px for the clock and 8 px at the right.
    width = page.run("document.getElementById('map').clientWidth")
    assert scene == pytest.approx((0.5 * width - 44) / (width - 52) * 29.975, abs=0.1)
    assert section == pytest.approx(scene, abs=0.06)
    assert page.run("document.querySelector('#values dd').textContent") == f"{section:.3f} m"


def test_every_diameter_stands_with_its_interval(page):
    values = page.run(
        "(() => { const all = [...document.querySelectorAll('#values dt')];"
        " return Object.fromEntries(all.map((one) => [one.textContent, one.nextElementSibling.textContent])); })()"
    )
    for name in ("Largest", "Smallest", "Horizontal (X)", "Vertical (Y)", "Mean (area)"):
        assert re.match(r"\d+\.\d ± \d+\.\d mm", values[name]), (name, values[name])
    assert "±: 95 %" in page.run("document.querySelector('#section').parentElement.textContent")


def test_keys_walk_and_switch(page):
    start = places(page)[0]
    page.key("ArrowRight")
    assert places(page)[0] == pytest.approx(start + 0.05, abs=0.03)
    page.key("Home")
    assert places(page)[0] == pytest.approx(0.025, abs=0.03)
    page.key("n")
    assert places(page)[0] == pytest.approx(9.06)
    page.key("End")
    assert places(page)[0] == pytest.approx(29.975, abs=0.03)
    for key, state in (("i", "inside"), ("x", "cut"), ("w", "wire")):
        page.key(key)
        assert page.run(f"document.querySelector('[data-act={state}]').getAttribute('aria-pressed')") == "true"
    page.key("m")
    assert page.run("document.getElementById('mode').value") == "surface"
    page.key("c")
    assert page.run("document.getElementById('series').value") == "Ovality"
    page.key("]")
    assert page.run("document.getElementById('exaggeration').value") == "2"
    assert page.complaints == []


def test_a_new_link_moves_there_and_nonsense_does_not(page):
    page.run("location.hash = '#chainage=5.5'")
    page.wait("document.getElementById('map').dataset.chainage === '5.5000'")
    page.run("location.hash = '#chainage=abc'")
    assert page.run("document.getElementById('map').dataset.chainage") == "5.5000"
    page.run("location.hash = '#chainage=9999'")
    page.wait("Number(document.getElementById('map').dataset.chainage) > 29")
    assert page.complaints == []


def test_a_stretch_without_section_says_why(page):
    page.run("location.hash = '#chainage=12.2'")
    page.wait("document.getElementById('map').dataset.chainage === '12.2000'")
    assert "too few readings" in page.run("document.getElementById('values').textContent")


def test_fits_a_phone(page):
    page.resize(390, 800)
    assert page.run("document.documentElement.scrollWidth") <= 390
