"""The PDF, read back by another program: pages that are full, words that are whole, labels that keep apart."""

import numpy as np
import pytest
from tests.unit.outputs.finished import finished_survey
from tests.unit.outputs.variants import VARIANTS, complete

from springline.errors import OutputError
from springline.outputs.pdf import render_pdf
from springline.outputs.pdf.content import breakable
from springline.outputs.pdf.svg import scaled
from springline.outputs.report import make_report
from springline.outputs.results import Results
from springline.outputs.unroll import unroll

pdfium = pytest.importorskip("pypdfium2")
pytest.importorskip("typst")

HOSTILE = "#panic(\"x\") $a$ *b* [c] \\ <d> & 'Straße' ../.. Ж Ω @e `f` //g"


def pdf_of(survey, config="[clean]\noutlier_sigma = 4.0\n"):
    results = Results(survey)
    return pdfium.PdfDocument(render_pdf(make_report(results, unroll(results), config)))


def words_of(page):
    """Boxes (left, bottom, right, top) and texts of the words on a page."""
    text = page.get_textpage()
    return [(text.get_rect(k), text.get_text_bounded(*text.get_rect(k)).strip()) for k in range(text.count_rects())]


@pytest.mark.parametrize("name", VARIANTS)
def test_pages_are_full_whole_and_uncrowded(name):
    document = pdf_of(VARIANTS[name]())
    assert 4 <= len(document) <= 20
    for number, page in enumerate(document):
        width, height = page.get_size()
        picture = np.asarray(page.render(scale=0.5, grayscale=True).to_pil())
        printed = (picture[: int(0.93 * picture.shape[0])] < 200).mean()
        assert printed > 0.004, f"page {number + 1} is as good as empty"
        boxes = [(box, text) for box, text in words_of(page) if text]
        for (left, bottom, right, top), text in boxes:
            inside = left > 25 and right < width - 25 and bottom > 15 and top < height - 25
            assert inside, f"'{text}' leaves page {number + 1}"
        for i, (a, text) in enumerate(boxes):
            for b, other in boxes[:i]:
                across = min(a[2], b[2]) - max(a[0], b[0])
                up = min(a[3], b[3]) - max(a[1], b[1])
                # Boxes of glyphs may touch; words must not lie on one another.
                lie = across > 1.0 and up > 0.15 * min(a[3] - a[1], b[3] - b[1])
                assert not lie, f"'{text}' lies on '{other}' on page {number + 1}"


def test_says_what_the_page_says():
    document = pdf_of(complete())
    text = "\n".join(page.get_textpage().get_text_range() for page in document)
    for words in (
        *("MH 12 to MH 13", "Verdicts", "fail", "Corrected by people", "The wall, unrolled", "Along the pipe"),
        *("Ovality, (largest", "limit of deflection-5, 5 %", "Required liner thickness", "Layout", "Easting [m]"),
        *("The worst sections", "Features", "By stretch", "What the definition does", "To reproduce it", "SHA-256"),
        *("none given; scale known to 0.5 %", "Chainage [m]", "1 of ", "outlier_sigma = 4.0"),
    ):
        assert words in text, words
    assert document.get_metadata_dict()["Title"] == "MH 12 to MH 13"


def test_text_of_others_is_never_markup():
    document = pdf_of(finished_survey(stations=20, bearings=36, dense=True, name=HOSTILE), config=HOSTILE)
    text = document[0].get_textpage().get_text_range().replace("\r\n", " ").replace("\n", " ")
    assert HOSTILE in text.replace("\u200b", "")
    assert document.get_metadata_dict()["Title"].replace("\u200b", "") == HOSTILE


def test_long_words_break_and_short_ones_stay():
    assert breakable("ab" * 32).replace("\u200b", "") == "ab" * 32 and breakable("PVC-U") == "PVC-U"


def test_paths_keep_their_shape_in_another_box():
    assert scaled("M100 200h0L300 400V500Z", 100, 200) == "M10 40h0L30 80V100Z"
    assert scaled("M1.5 2.5L3 4", 2000, 1000) == "M3 2.5L6 4"


def test_without_typst_the_message_names_the_extra(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "typst", None)
    with pytest.raises(OutputError, match=r"springline\[pdf\]"):
        pdf_of(finished_survey(stations=3, bearings=36, dense=True))
