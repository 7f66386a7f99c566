"""`springline reproduce`: the tables cell by cell, and one page that needs nothing else."""

from __future__ import annotations

import re
from functools import partial

from springline.reproduce.figures import MAKERS

from . import command_line

reproduce = partial(command_line.run, "reproduce")


def test_tables_are_told_cell_by_cell():
    code, out, _ = reproduce("tables")
    assert code == 0
    for line in (
        "Table 3.1 (printed as 0.1): 50 of 50 cells as coded, 47 of 50 by the geometry",
        "Table 3.2 (printed as 0.2): 66 of 66 cells as coded, 66 of 66 by the geometry",
        "Table 3.3 (printed as 0.3): 66 of 66 cells as coded, 66 of 66 by the geometry",
        "Table 3.4 (printed as 0.4): 36 of 36 cells as coded, 17 of 36 by the geometry",
        "Table 3.5 (printed as 0.5): 18 of 18 cells as coded, 5 of 18 by the geometry",
    ):
        assert line in out
    assert re.search(r"s1 = 0\.90, q polar\s+printed\s+10\.89, corrected\s+10\.53", out)
    assert len(re.findall("printed .*, corrected", out)) == 35
    assert "Erratum A1" in out
    assert "Figure" not in out


def test_everything_goes_onto_one_page(tmp_path):
    folder = tmp_path / "gallery"
    code, out, _ = reproduce("-o", str(folder))
    assert code == 0
    assert str(folder / "index.html") in out
    assert {p.name for p in folder.iterdir()} == {"index.html", *(f"figure-{n}.svg" for n in MAKERS)}
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "236 of 236" in page
    assert "201 of 236" in page
    assert all(f'id="figure-{n}"' in page for n in MAKERS)
    assert page.count("<svg ") == len(MAKERS)
    assert "{{" not in page
    assert not re.search(r'(src|href)="(?!data:)', page)
    assert len(page.encode()) < 5e6

    code, _, err = reproduce("tables", "-o", str(folder))
    assert code == 2
    assert "it exists already" in err
    code, _, _ = reproduce("tables", "-o", str(folder), "--force")
    assert code == 0
    assert [p.name for p in folder.iterdir()] == ["index.html"]


def test_a_folder_of_something_else_is_not_thrown_away(tmp_path):
    (tmp_path / "thesis.txt").write_text("mine")
    code, _, err = reproduce("tables", "-o", str(tmp_path), "--force")
    assert code == 2
    assert "other files than those of a gallery" in err
    assert (tmp_path / "thesis.txt").read_text() == "mine"


def test_unknown_part_is_refused():
    code, _, err = reproduce("chapters")
    assert code == 2
    assert "chapters" in err
