"""The report in a real browser, opened from disk."""

import pytest
from tests.unit.outputs.variants import VARIANTS

from springline.outputs.report import render_report
from springline.outputs.results import Results
from springline.outputs.unroll import unroll

CHARTS = ("diameter", "ovality", "deflection", "loss", "coverage", "liner", "elevation", "sag", "gradient", "bend")
MAPS = ("shape", "surface", "readings")


@pytest.fixture
def page(browser, complete_folder):
    browser.resize(1280, 900)
    browser.open(complete_folder / "report.html")
    return browser


def test_opens_without_a_complaint_or_a_request(page, complete_folder):
    assert page.complaints == []
    assert page.requests == [(complete_folder / "report.html").as_uri()]


def test_every_chart_and_map_is_there_drawn_and_labelled(page):
    for key in CHARTS:
        chart = f"document.querySelector('[data-chart={key}]')"
        assert "[" in page.run(f"{chart}.getAttribute('aria-label')")
        widest = f"Math.max(...[...{chart}.querySelectorAll('.line')].map((line) => line.getBBox().width))"
        assert page.run(widest) > (90 if key == "bend" else 900), key
        assert page.run(f"{chart}.querySelectorAll('.legend li').length") >= 1
        assert page.run(f"{chart}.querySelectorAll('.yaxis span').length") >= 3
    for key in MAPS:
        image = f"document.querySelector('[data-map={key}] img')"
        assert page.run(f"{image}.complete && {image}.naturalWidth") == 1200
    assert page.run("document.querySelector('[data-plan] .line').getBBox().width") > 500
    assert page.run("document.querySelectorAll('.pictures img').length") == 32
    assert page.run("document.querySelectorAll('.section').length") == 11, "one to scale, ten with residuals"
    assert page.run("document.querySelectorAll('.residuals .dots').length") == 10
    axes = "[...document.querySelectorAll('[data-chart] .xaxis, [data-map] .xaxis')]"
    ticks = page.run(f"new Set({axes}.map((axis) => axis.textContent.trim())).size")
    assert ticks == 1, "all charts and maps share one chainage axis"


CROWDED = """(() => {
  const bad = [];
  const lie = (a, b) => a.right > b.left + 1 && b.right > a.left + 1 && a.bottom > b.top + 1 && b.bottom > a.top + 1;
  const seen = (e) => getComputedStyle(e).visibility !== "hidden" && getComputedStyle(e).display !== "none";
  const groups = ".xaxis, .yaxis, .legend, .facts, .headlines, .map .area, .plan .area";
  for (const group of document.querySelectorAll(groups)) {
    const labels = group.matches(".area") ? group.querySelectorAll(".mark b") : group.children;
    const boxes = [...labels].filter(seen).map((e) => [e.getBoundingClientRect(), e.textContent]);
    boxes.forEach(([a, text], i) => {
      for (const [b, other] of boxes.slice(0, i)) if (lie(a, b)) bad.push(`${text} on ${other}`);
    });
  }
  return bad;
})()"""


@pytest.mark.parametrize("name", VARIANTS)
def test_nothing_overlaps_or_leaves_the_page(browser, tmp_path, name):
    results = Results(VARIANTS[name]())
    path = tmp_path / "report.html"
    path.write_text(render_report(results, unroll(results), ""), encoding="utf-8")
    for width in (390, 768, 1280):
        browser.resize(width, 900)
        browser.open(path)
        assert browser.run("document.documentElement.scrollWidth") <= width
        assert browser.run(CROWDED) == [], f"labels overlap at {width} px"
    assert browser.complaints == []


def test_pointing_at_a_chart_shows_values_there_on_all(page):
    x, y = page.run(
        "(() => { const a = document.querySelector('[data-chart=deflection] .area'); a.scrollIntoView();"
        " const b = a.getBoundingClientRect(); return [b.left + b.width * 2 / 3, b.top + 20]; })()"
    )
    page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    assert page.run("document.getElementById('readout').textContent").startswith("20.0")
    value = page.run("document.querySelector('[data-chart=deflection] output').textContent")
    assert float(value.split(" … ")[-1]) == pytest.approx(4.0, abs=0.01)
    shown = page.run("[...document.querySelectorAll('.cursor')].every((c) => c.style.display === 'block')")
    assert shown is True


def test_prints_on_a_few_full_pages(page):
    pdf = page.pdf()
    pages = pdf.count(b"/Type /Page\n") or pdf.count(b"/Type /Page") - pdf.count(b"/Type /Pages")
    assert 8 <= pages <= 16
