"""The report in a real browser, opened from disk."""

import pytest

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


def test_nothing_overlaps_or_leaves_the_page(page):
    for width in (390, 768, 1280):
        page.resize(width, 900)
        assert page.run("document.documentElement.scrollWidth") <= width
        crowded = page.run(
            """(() => {
              const bad = [];
              for (const axis of document.querySelectorAll(".xaxis, .yaxis")) {
                const boxes = [...axis.children].filter((e) => getComputedStyle(e).visibility !== "hidden")
                  .map((e) => e.getBoundingClientRect());
                for (let i = 1; i < boxes.length; i += 1) {
                  const [a, b] = [boxes[i - 1], boxes[i]];
                  const apart = a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
                  if (!apart) bad.push(axis.closest("figure").getAttribute("aria-label"));
                }
              }
              return bad;
            })()"""
        )
        assert crowded == [], f"labels overlap at {width} px"


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
