"""Fixed-point text and tables against Python's own formatting and parsing."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from springline.errors import FormatError, InputError
from springline.io.fixed_text import fixed_text
from springline.io.tables import open_table, parse_numbers

CELLS = st.one_of(st.floats(-1e6, 1e6), st.just(float("nan")), st.just(0.0), st.integers(-5, 5).map(float))


@settings(max_examples=200, deadline=None)
@given(
    values=hnp.arrays(np.float64, st.tuples(st.integers(1, 5), st.integers(1, 4)), elements=CELLS),
    decimals=st.integers(1, 6),
)
def test_fixed_text_reads_as_the_rounded_number(values, decimals):
    text = fixed_text(values, decimals).decode()
    rows = list(csv.reader(io.StringIO(text)))
    assert len(rows) == len(values)
    for row, expected in zip(rows, values, strict=True):
        for cell, value in zip(row if row else [""], expected, strict=True):
            if np.isnan(value):
                assert cell == ""
                continue
            whole, _, fraction = cell.partition(".")
            assert len(fraction) == decimals
            assert whole.lstrip("-") == str(int(whole.lstrip("-")))
            assert abs(float(cell) - value) <= 0.5 * 10.0**-decimals * (1 + 1e-9) + 1e-9


def test_fixed_text_of_too_large_a_number():
    with pytest.raises(OverflowError, match="too large"):
        fixed_text(np.array([[1e12]]), 6)


@settings(max_examples=150, deadline=None)
@given(
    values=hnp.arrays(np.float64, st.tuples(st.integers(1, 6), st.integers(1, 4)), elements=st.floats(-1e9, 1e9)),
    delimiter=st.sampled_from([",", ";", "\t", " "]),
    ending=st.sampled_from(["\n", "\r\n"]),
    gap=st.booleans(),
)
def test_numbers_and_their_rows(values, delimiter, ending, gap):
    lines = [delimiter.join(map(repr, row)) for row in values.tolist()]
    rows = list(range(7, 7 + len(lines)))
    if gap:
        lines.insert(1, "")
        rows = [rows[0], *(r + 1 for r in rows[1:])]
    block = (ending.join(lines) + ending).encode()
    parsed = parse_numbers(block, delimiter=delimiter, names=["c"] * values.shape[1], where=Path("a"), first_row=7)
    np.testing.assert_allclose(parsed.values, values, rtol=1e-15)
    assert parsed.numbers.tolist() == rows


@pytest.mark.parametrize("word", ["", "nan", "NaN", "N/A", "null", "-"])
def test_missing_cells(word):
    parsed = parse_numbers(f"1,{word},3\n".encode(), delimiter=",", names=list("abc"), where=Path("a"), first_row=1)
    np.testing.assert_array_equal(parsed.values, [[1, np.nan, 3]])


@pytest.mark.parametrize(
    ("block", "message"),
    [
        (b"1,2\n3,x\n", "a, row 6, column b: the cell 'x'"),
        (b'"1","2"\n"3","1 2"\n', "a, row 6, column b: the cell '1 2'"),
        (b"1,2\n1_0,2\n", "a, row 6, column a: the cell '1_0'"),
        (b"1,2\n\n3\n", "a, row 7: the row has 1 cells"),
        (b"1,2,\n", "a, row 5: the row has 3 cells"),
    ],
)
def test_faults(block, message):
    with pytest.raises(InputError, match=message):
        parse_numbers(block, delimiter=",", names=["a", "b"], where=Path("a"), first_row=5)


@pytest.mark.parametrize(
    ("text", "names", "first_row", "delimiter"),
    [
        ("1 2 3\n4 5 6\n", (), 1, " "),
        ("# taken at dawn\n\n# x y z\n1 2 3\n", ("x", "y", "z"), 4, " "),
        ("# taken at dawn, by us\n1 2 3\n", (), 2, " "),
        ("sep=;\nx;y\n1;2\n", ("x", "y"), 3, ";"),
        ("x , y\n1,2\n", ("x", "y"), 2, ","),
    ],
)
def test_layouts(text, names, first_row, delimiter, tmp_path):
    (tmp_path / "a").write_text(text)
    table = open_table(tmp_path / "a")
    assert (table.names, table.first_row, table.delimiter) == (names, first_row, delimiter)
    assert [b.numbers[0] for b in table.blocks()] == [first_row]


@pytest.mark.parametrize("content", [b"\0\1\2", b"# only\n# words\n", b"\n\n"])
def test_no_table(content, tmp_path):
    (tmp_path / "a").write_bytes(content)
    with pytest.raises(FormatError):
        open_table(tmp_path / "a")
