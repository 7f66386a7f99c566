"""`springline compare`, end to end: surveys and lists, whole or nothing, one clear message when it cannot."""

from __future__ import annotations

import csv
import json
import os

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


def test_a_tally_as_vendors_send_it(tmp_path):
    """Titles above the heading, on the second sheet; clocks in hours and minutes; feet in the heading; empty rows."""
    pd = pytest.importorskip("pandas")
    pytest.importorskip("openpyxl")
    rng = np.random.default_rng(4)
    weld = np.cumsum(rng.choice([40.1, 39.2, 37.5], 60) + rng.normal(0.0, 0.4, 60))
    for name, scale in (("a", 1.0), ("b", 1.002)):
        rows = [[10 * (n + 1), w, "Girth Weld", ""] for n, w in enumerate(weld * scale)]
        rows += [[10 * (n + 1), weld[n] * scale + 7.3, "Tee", f"{n % 12:02d}:30"] for n in range(4, 60, 9)]
        rows += [[10 * (n + 1), weld[n] * scale + 9.1, "Metal Loss", "05:10"] for n in range(2, 60, 7)]
        rows = [*sorted(rows, key=lambda row: row[1]), ["", "", "", ""]]
        heading = ["Joint No.", "Log Dist. [ft]", "Event", "O'clock"]
        with pd.ExcelWriter(tmp_path / f"{name}.xlsx") as book:
            pd.DataFrame([["Final report"]]).to_excel(book, sheet_name="Cover", index=False, header=False)
            sheet = pd.DataFrame([["Tally", "", "", ""], ["", "", "", ""], heading, *rows])
            sheet.to_excel(book, sheet_name="Tally", index=False, header=False)
    mapped = (
        "--columns",
        "chainage=Log Dist. [ft],kind=Event,clock=O'clock",
        "--kinds",
        "Girth Weld=joint,Tee=lateral",
    )
    assert run(tmp_path / "a.xlsx", tmp_path / "b.xlsx", *mapped, "-o", tmp_path / "out")[0] == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["pairs"] >= 64
    assert summary["length_a_m"] == pytest.approx((weld[-1] - weld[0]) * 0.3048, rel=1e-3)


def test_rows_that_repeat_another_are_told_and_read_once(lists, tmp_path):
    head, *rows = (lists / "a.csv").read_text().splitlines()
    (tmp_path / "twice.csv").write_text("\n".join([head, *(row for row in rows for _ in range(2))]) + "\n")
    code, out, _ = run(tmp_path / "twice.csv", lists / "b.csv", "-o", tmp_path / "out")
    assert code == 0
    assert "30 rows that repeat another are read once" in out
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["pairs"] == 30
    assert summary["unclear"] == 0


def test_clocks_cut_to_the_minute_are_no_change(lists, tmp_path):
    head, *rows = (lists / "a.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]
    cut = [f"{x},{kind},{int(float(h))}:{int(float(h) * 60 % 60):02d},{size}" for x, kind, h, size in cells]
    (tmp_path / "minutes.csv").write_text("\n".join([head, *cut]) + "\n")
    assert run(lists / "a.csv", tmp_path / "minutes.csv", "-o", tmp_path / "out")[0] == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["pairs"] == 30
    assert summary["changes"] == summary["measurement_errors"] == 0


def test_semicolons_and_decimal_commas(lists, tmp_path):
    text = (lists / "a.csv").read_text().replace(",", ";").replace(".", ",")
    (tmp_path / "comma.csv").write_text(text)
    assert run(tmp_path / "comma.csv", lists / "b.csv", "-o", tmp_path / "out")[0] == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["pairs"] == 30
    x = [float(row.split(",")[0]) for row in (lists / "a.csv").read_text().splitlines()[1:]]
    assert summary["length_a_m"] == pytest.approx(x[-1] - x[0], abs=1e-3)


def test_one_list_against_many_tells_which_fit(lists, tmp_path):
    rng = np.random.default_rng(9)
    places, clocks = np.sort(rng.uniform(0, 200, 30)), rng.uniform(1, 12, 30)
    rows = [f"{u:.3f},lateral,{h:.2f},100" for u, h in zip(places, clocks, strict=True)]
    (tmp_path / "other.csv").write_text("chainage_m,kind,clock_h,size_mm\n" + "\n".join(rows) + "\n")
    code, out, _ = run(lists / "a.csv", tmp_path / "other.csv", lists / "b.csv", "-o", tmp_path / "out")
    assert code == 0
    assert "other.csv is left out: the features do not show" in out
    assert "b.csv: driven from the same end, features in both 30" in out
    code, _, told = run(tmp_path / "other.csv", lists / "a.csv", lists / "b.csv", "-o", tmp_path / "none")
    assert code == 2
    assert "none of the inspections could be compared with the first" in told


BAD = {
    "zero.csv": ("", "the file is empty"),
    "empty.csv": ("chainage_m,kind\n", "it has no rows"),
    "one.csv": ("chainage_m,kind\n1.0,joint\n", "a single feature"),
    "unsorted.csv": ("chainage_m,kind\n5,joint\n1,joint\n7,joint\n", "Sort the list by chainage"),
    "columns.csv": ("foo,bar\n1,2\n", "its columns are not known"),
    "kind.csv": ("chainage_m,kind\n1,joint\n3,jiont\n", "did you mean 'joint'"),
    "place.csv": ("chainage_m,kind\n4,joint\n4,lateral\n", "its 2 features all stand at 4 m"),
    "clock.csv": ("chainage_m,kind,clock_h\n1,lateral,270\n3,lateral,90\n", "row 1 of the table, column clock_h"),
    "blank.csv": ("chainage_m,kind\n,\n,\n", "it has no rows"),
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


@pytest.mark.parametrize(
    ("option", "told"),
    [
        (("--kind", "jiont"), "there is no kind of feature 'jiont', did you mean 'joint'?"),
        (("--false-alarms", "nan"), "it is nan"),
        (("--false-alarms", "0"), "it is 0"),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path, lists, option, told):
    code, _, error = run(lists / "a.csv", lists / "b.csv", *option, "-o", tmp_path / "out")
    assert code == 2
    assert told in error
    assert not (tmp_path / "out").exists()


def test_a_named_pipe_is_refused(tmp_path, lists):
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    code, _, error = run(lists / "a.csv", pipe, "-o", tmp_path / "out")
    assert code == 2
    assert "neither a file nor a folder" in error


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
