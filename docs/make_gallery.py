"""Make the pictures of the README in docs/images: `python docs/make_gallery.py`; needs Chromium and the extra `pdf`.

The surveys are simulated and ship with the program: the built-in one, the weaving robot with its inertial log and ties,
and an earlier state of the built-in pipe, in which it was rounder.
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

import pypdfium2  # noqa: E402
from PIL import Image  # noqa: E402
from tests.viewer.browser import Browser  # noqa: E402

import springline as sl  # noqa: E402
from springline.config import Config, dump_config  # noqa: E402
from springline.outputs.results import Results  # noqa: E402
from springline.outputs.unroll import unroll  # noqa: E402
from springline.outputs.viewer import Epoch, matched, render_viewer  # noqa: E402
from springline.outputs.write import write_outputs  # noqa: E402

IMAGES = HERE / "images"
READY = "document.body.dataset.ready"
SETTLED = "new Promise((done) => setTimeout(done, 400))"
DENT = "#chainage=20.26"


def main() -> None:
    """Inspect the surveys, and take a picture of each page and part."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        built_in = sl.inspect(sl.read(sl.builtin_survey()), checks=["deflection-5"])
        write_outputs(built_in, folder / "built-in", config_toml=dump_config(Config()))
        weaving = sl.inspect(sl.simulate("weaving"), checks=["deflection-5"])
        write_outputs(weaving, folder / "weaving", config_toml=dump_config(Config()))
        (folder / "pair.html").write_text(_pair(built_in), encoding="utf-8")
        browser = Browser(1280, 800)
        try:
            _report(browser, folder)
            _viewer(browser, folder)
        finally:
            browser.close()
        _pdf(folder / "built-in" / "report.pdf")


def _pair(survey: sl.Survey) -> str:
    """Return a viewer of the survey beside a rounder state of the same pipe: half as much departure from the circle."""
    from dataclasses import replace

    results = Results(survey)
    wall = unroll(results)
    rounder = replace(wall, shape=wall.shape * 0.5)
    return render_viewer(results, wall, Epoch("an earlier state", matched(wall, rounder)))


def _report(browser: Browser, folder: Path) -> None:
    browser.resize(1100, 900)
    browser.open(folder / "built-in" / "report.html")
    _save(browser.screenshot(), "report")
    _part(browser, "report-sections", "The worst sections", 1000)
    _part(browser, "report-features", "Features", 880)
    browser.open(folder / "weaving" / "report.html")
    _part(browser, "report-layout", "Layout", 1250)
    browser.resize(390, 844)
    browser.open(folder / "built-in" / "report.html")
    _save(browser.screenshot(), "report-phone")


def _part(browser: Browser, name: str, heading: str, height: int) -> None:
    browser.resize(1100, height)
    browser.run(f"[...document.querySelectorAll('h2')].find((h) => h.textContent === '{heading}').scrollIntoView()")
    browser.run(SETTLED)
    _save(browser.screenshot(), name)


def _viewer(browser: Browser, folder: Path) -> None:
    browser.resize(1280, 800)
    browser.open(folder / "built-in" / "viewer.html", DENT, READY)
    browser.run(SETTLED)
    _save(browser.screenshot(), "viewer")
    browser.key("i")
    browser.run(SETTLED)
    _save(browser.screenshot(), "viewer-inside")
    browser.open(folder / "pair.html", "#chainage=22", READY)
    browser.key("b")
    for _ in range(2):
        browser.key("m")
    browser.run(SETTLED)
    _save(browser.screenshot(), "viewer-pair")


def _pdf(path: Path) -> None:
    pages = [page.render(scale=0.9).to_pil() for page in list(pypdfium2.PdfDocument(path))[:4]]
    width, height = pages[0].size
    sheet = Image.new("RGB", (4 * width + 50, height + 20), "#c9ced4")
    for k, page in enumerate(pages):
        sheet.paste(page, (10 + k * (width + 10), 10))
    _write(sheet, "report-pdf")


def _save(png: bytes, name: str) -> None:
    _write(Image.open(io.BytesIO(png)).convert("RGB"), name)


def _write(picture: Image.Image, name: str) -> None:
    # An octree keeps the rare colours of legends, which a median cut loses.
    IMAGES.mkdir(exist_ok=True)
    picture.quantize(256, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE).save(
        IMAGES / f"{name}.png", optimize=True
    )


if __name__ == "__main__":
    main()
