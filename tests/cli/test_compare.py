"""`springline compare`, end to end: surveys and lists, whole or nothing, one clear message when it cannot."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from bench._compare_walls import repeat
from typer.testing import CliRunner

from springline.cli.compare import app
from springline.errors import SpringlineError
from springline.survey import save_survey

FILES = {"summary.json", "pairs.csv", "changes.csv", "placing.csv", "report.html"}


def run(*arguments):
    """Return exit code, what was printed, and the message of a deliberate error."""
    result = CliRunner().invoke(app, [str(a) for a in arguments])
    told = str(result.exception) if isinstance(result.exception, SpringlineError) else ""
    assert not result.exception or told or result.exit_code == 0, result.exception
    return (2 if told else result.exit_code), result.output, told


@pytest.fixture(scope="module")
def surveys(tmp_path_factory):
    folder = tmp_path_factory.mktemp("surveys")
    dent = '{ chainage = 6.2, clock_h = 3.0, depth = "4mm", length = 0.3, width_deg = 40.0 }'
    a, b = repeat(8, length=10.0, dents=dent, slips=False, other_end=True)
    for name, one, day in (("a", a, "2020-06-01"), ("b", b, "2024-06-01")):
        save_survey(one.result.with_attrs(date=day, name=f"MH 1 to 2, {name}"), folder / f"{name}.zarr.zip")
    return folder


@pytest.fixture
def lists(tmp_path):
    rng = np.random.default_rng(2)
    x = np.sort(rng.uniform(0.0, 200.0, 30))
    clock = rng.uniform(0.5, 12.0, 30)
    for name, y, hours in (("a", x, clock), ("b", 3.0 + 1.004 * x, clock)):
        rows = [f"{u:.3f},lateral,{h:.2f},100" for u, h in zip(y, hours, strict=True)]
        (tmp_path / f"{name}.csv").write_text("chainage_m,kind,clock_h,size_mm\n" + "\n".join(rows) + "\n")
    return tmp_path


def test_two_surveys(surveys, tmp_path):
    code, out, _ = run(surveys / "a.zarr.zip", surveys / "b.zarr.zip", "-o", tmp_path / "out")
    assert code == 0
    assert "driven from the other end" in out
    assert {p.name for p in (tmp_path / "out").iterdir()} >= FILES
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["driven_from_the_other_end"]
    assert summary["years"] == pytest.approx(4.0, abs=0.01)
    assert summary["largest_wall_change_mm"] == pytest.approx(-4.0, abs=1.0)
    with (tmp_path / "out" / "changes.csv").open() as stream:
        rows = [row for row in csv.DictReader(stream) if row["quantity"] == "wall, local"]
    assert len(rows) == 1
    assert float(rows[0]["rate_per_year"]) == pytest.approx(float(rows[0]["change"]) / summary["years"], rel=1e-3)
    page = (tmp_path / "out" / "report.html").read_text()
    assert "data:image/png" in page
    assert "http" not in page.replace("http-equiv", "")


def test_two_lists_and_the_file_is_replaced_only_when_asked(lists, tmp_path):
    out = tmp_path / "out"
    assert run(lists / "a.csv", lists / "b.csv", "-o", out)[0] == 0
    summary = json.loads((out / "summary.json").read_text())
    assert summary["pairs"] == 30
    code, _, told = run(lists / "a.csv", lists / "b.csv", "-o", out)
    assert code == 2
    assert "--force" in told
    assert run(lists / "a.csv", lists / "b.csv", "-o", out, "--force")[0] == 0


def test_a_tally_in_excel_with_a_column_map(tmp_path):
    pd = pytest.importorskip("pandas")
    pytest.importorskip("openpyxl")
    weld = np.cumsum(np.random.default_rng(4).choice([12.2, 11.6, 10.8], 60) + 0.1)
    for name, scale in (("a", 1.0), ("b", 1.002)):
        pd.DataFrame({"Log dist": weld * scale / 0.3048, "Event": "GWD"}).to_excel(
            tmp_path / f"{name}.xlsx", index=False
        )
    mapped = ("--columns", "chainage=Log dist,kind=Event", "--kinds", "GWD=joint", "--unit", "ft")
    assert run(tmp_path / "a.xlsx", tmp_path / "b.xlsx", *mapped, "-o", tmp_path / "out")[0] == 0
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["pairs"] >= 58


def test_plain_headings_are_known(lists, tmp_path):
    for name in ("a.csv", "b.csv"):
        text = (lists / name).read_text().replace("chainage_m,kind,clock_h,size_mm", "Chainage,Kind,Clock,Size")
        (tmp_path / f"plain-{name}").write_text(text)
    out = tmp_path / "out"
    assert run(tmp_path / "plain-a.csv", tmp_path / "plain-b.csv", "-o", out)[0] == 0
    assert json.loads((out / "summary.json").read_text())["pairs"] == 30


BAD = {
    "zero.csv": ("", "the file is empty"),
    "empty.csv": ("chainage_m,kind\n", "it has no rows"),
    "one.csv": ("chainage_m,kind\n1.0,joint\n", "a single feature"),
    "unsorted.csv": ("chainage_m,kind\n5,joint\n1,joint\n7,joint\n", "Sort the list by chainage"),
    "columns.csv": ("foo,bar\n1,2\n", "its columns are not known"),
    "kind.csv": ("chainage_m,kind\n1,joint\n3,jiont\n", "did you mean 'joint'"),
    "text.csv": ("chainage_m,kind\n1,joint\nthree,joint\n", "row 2 of the table, column chainage_m"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_list_is_named_and_nothing_is_written(tmp_path, lists, name):
    content, expected = BAD[name]
    (tmp_path / name).write_text(content)
    code, _, told = run(tmp_path / name, lists / "b.csv", "-o", tmp_path / "out")
    assert code == 2
    assert expected in told
    assert name in told
    assert not (tmp_path / "out").exists()


def test_other_pipes_and_missing_files_are_refused(tmp_path, lists):
    rng = np.random.default_rng(9)
    rows = [
        f"{u:.3f},lateral,{h:.2f},100"
        for u, h in zip(np.sort(rng.uniform(0, 200, 30)), rng.uniform(1, 12, 30), strict=True)
    ]
    (tmp_path / "other.csv").write_text("chainage_m,kind,clock_h,size_mm\n" + "\n".join(rows) + "\n")
    code, _, told = run(lists / "a.csv", tmp_path / "other.csv", "-o", tmp_path / "out")
    assert code == 2
    assert "two inspections of one pipe" in told
    assert "no such file" in run(lists / "a.csv", tmp_path / "gone.csv", "-o", tmp_path / "out")[2]
    assert "two inspections or more" in run(lists / "a.csv", "-o", tmp_path / "out")[2]
    assert not (tmp_path / "out").exists()


def test_a_foreign_folder_is_not_replaced(lists, tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    code, _, told = run(lists / "a.csv", lists / "b.csv", "-o", tmp_path / "mine", "--force")
    assert code == 2
    assert "other files than those of a comparison" in told


def test_three_lists_or_surveys_make_a_series(surveys, tmp_path):
    a, b = surveys / "a.zarr.zip", surveys / "b.zarr.zip"
    code, _, told = run(a, b, b, "-o", tmp_path / "out")
    assert code == 2
    assert "comes after" in told
    from springline.survey import open_survey

    later = tmp_path / "c.zarr.zip"
    save_survey(open_survey(b).with_attrs(date="2026-06-01"), later)
    assert run(a, b, later, "-o", tmp_path / "out")[0] == 0
    with (tmp_path / "out" / "wall_trends.csv").open() as stream:
        (row,) = csv.DictReader(stream)
    assert row["significant"] == "yes"
    assert float(row["rate_per_year"]) == pytest.approx(-0.85, abs=0.25)
    assert (tmp_path / "out" / "1-2" / "report.html").exists()
