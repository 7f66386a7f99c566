"""Write docs/contract.md from the one table in `springline.conventions`: run `python docs/make_contract.py`."""

from __future__ import annotations

from pathlib import Path

from springline.conventions import (
    FEATURE_COLUMNS,
    FIT_STATUS,
    GROUPS,
    MASK_REASONS,
    ROOT_ATTRIBUTES,
    STATION_COLUMNS,
    STATION_FLAGS,
    SURVEY_FOLDER_KEYS,
    SURVEY_SENSOR_KEYS,
)

OPENING = """\
```python
import xarray, zarr

tree = xarray.open_datatree("survey.zarr", engine="zarr")  # a folder
tree = xarray.open_datatree(zarr.storage.ZipStore("survey.zarr.zip", mode="r"), engine="zarr")  # a zip
tree["metrics"]["diameter_max"]  # [m]
```"""


def contract() -> str:
    """Return the page as Markdown."""
    lines = [
        "# The data contract",
        "",
        "Made by `docs/make_contract.py` from `springline/conventions`; change it there.",
        "",
        "A survey is a zarr store, in a folder or in one `.zip`. Without Springline:",
        "",
        *OPENING.splitlines(),
        "",
        "## Root attributes",
        "",
        *_table(("attribute", "meaning"), ROOT_ATTRIBUTES.items()),
    ]
    for group in GROUPS.values():
        lines += ["", f"## `/{group.name}`", "", f"{group.description[0].upper()}{group.description[1:]}. "]
        lines[-1] += f"Made by `{group.made_by}`." + (" Other variables may stand in it." if group.open else "")
        if group.variables:
            rows = [
                (f"`{v.name}`" + (" (required)" if v.required else ""), ", ".join(v.dims), v.unit, v.description)
                for v in group.variables
            ]
            lines += ["", *_table(("variable", "dims", "unit", "meaning"), rows)]
        if group.attributes:
            lines += ["", *_table(("attribute", "meaning"), group.attributes)]
    for title, flags in (("`/mask` reason", MASK_REASONS), ("`/section` status", FIT_STATUS)):
        lines += ["", f"## Flag values of {title}", "", *_table(("value", "meaning"), flags.items())]
    lines += ["", "## Words in `/section` flags", "", *_table(("word", "meaning"), STATION_FLAGS.items())]
    columns = [(f"`{c.name}`", c.heading, f"`/{c.group}` {c.variable}") for c in STATION_COLUMNS]
    lines += ["", "## `stations.csv`", "", "Empty = not available, never 0.", ""]
    lines += _table(("column", "heading", "from"), columns)
    lines += ["", "## `features.csv`", "", ", ".join(f"`{name}`" for name in FEATURE_COLUMNS)]
    lines += ["", "## `survey.toml`", "", *_table(("key", "meaning"), SURVEY_FOLDER_KEYS.items())]
    lines += ["", "### `[sensor]`", "", *_table(("key", "meaning"), SURVEY_SENSOR_KEYS.items())]
    return "\n".join(lines) + "\n"


def _table(heads: tuple[str, ...], rows: object) -> list[str]:
    return [
        f"| {' | '.join(heads)} |",
        f"|{'---|' * len(heads)}",
        *(f"| {' | '.join(str(cell) for cell in row)} |" for row in rows),
    ]


if __name__ == "__main__":
    Path(__file__).with_name("contract.md").write_text(contract(), encoding="utf-8")
