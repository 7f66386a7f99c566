"""Studies whose tables stand in `docs/estimator.md`: which seeds they run, and where a table goes."""

from __future__ import annotations

import os
import re
from pathlib import Path

PAGE = Path(__file__).parents[1] / "docs" / "estimator.md"


def seeds(count: int) -> range:
    """Return the seeds of a study: so many unless `SPRINGLINE_RUNS` says how many, from `SPRINGLINE_FIRST` on."""
    count, first = (int(os.environ.get(f"SPRINGLINE_{name}", n)) for name, n in (("RUNS", count), ("FIRST", 1)))
    return range(first, first + count)


def publish(name: str, text: str) -> None:
    """Print a table and put it into the page, between the marks of its name."""
    print(text)
    start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
    page = PAGE.read_text(encoding="utf-8")
    between = re.compile(re.escape(start) + ".*?" + re.escape(end), re.DOTALL)
    PAGE.write_text(between.sub(lambda _: start + text + end, page), encoding="utf-8")
