"""Ring tables as Parquet, wide or long, by pyarrow."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import FormatError, InputError, MissingExtraError
from .ring_export import blocks
from .rings import Statements, ring_survey
from .tables import Rows

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from ..survey import Survey
    from .options import ReadOptions

_CELLS = 1 << 21
_KEY = b"springline"


def _parquet() -> Any:
    try:
        import pyarrow.parquet
    except ImportError:
        raise MissingExtraError.of("parquet", "reading and writing Parquet files") from None
    return pyarrow.parquet


@dataclass(frozen=True)
class _ParquetTable:
    path: Path
    names: tuple[str, ...]
    file: Any

    def blocks(self) -> Iterator[Rows]:
        """Yield the table's numbers; rows count from 1 at the first row of data."""
        row = 1
        for batch in self.file.iter_batches(batch_size=max(1, _CELLS // max(1, len(self.names)))):
            values = np.empty((batch.num_rows, len(self.names)))
            for i, column in enumerate(batch.columns):
                values[:, i] = column.to_numpy(zero_copy_only=False)
            yield Rows(np.arange(row, row + batch.num_rows), values)
            row += batch.num_rows


def read_ring_parquet(path: Path, options: ReadOptions, statements: Statements | None = None) -> Survey:
    """Read a ring table from Parquet into `/rings`; layouts and errors are those of `rings.ring_survey`.

    Raises:
        FormatError: Not Parquet, or cut short.
        InputError: A column does not hold numbers.
        MissingExtraError: The extra `parquet` is not installed.
    """
    parquet = _parquet()
    import pyarrow as pa

    try:
        with parquet.ParquetFile(path) as file:
            schema = file.schema_arrow
            _check_columns(schema, path)
            table = _ParquetTable(path, tuple(schema.names), file)
            return ring_survey(table, options, statements or _statements(schema.metadata))
    except (pa.ArrowException, OSError, UnicodeDecodeError) as error:
        raise FormatError(f"cut short or damaged: {error}", where=path, mend="copy or export it again") from None


def _check_columns(schema: Any, path: Path) -> None:
    import pyarrow as pa

    for field in schema:
        if not (pa.types.is_integer(field.type) or pa.types.is_floating(field.type) or pa.types.is_null(field.type)):
            raise InputError(f"the column holds {field.type}", where=f"{path}, column {field.name}", expected="numbers")


def _statements(metadata: Mapping[bytes, bytes] | None) -> Statements:
    """Return what `write_ring_parquet` stated, and nothing for files of others."""
    text = (metadata or {}).get(_KEY)
    return Statements(**json.loads(text)) if text else Statements()


def write_ring_parquet(survey: Survey, path: Path) -> None:
    """Write rings as Parquet without loss: columns as `ring_csv.write_ring_csv`, attributes in the file's metadata.

    Raises:
        MissingExtraError: The extra `parquet` is not installed.
    """
    parquet = _parquet()
    import pyarrow as pa

    rings = survey.rings
    attrs = {k: v.item() if isinstance(v, np.generic) else v for k, v in rings.attrs.items()}
    attrs = {k: v for k, v in attrs.items() if not k.startswith("bearing")}
    statement = {"units": {"range": "m"}, "attrs": attrs, "assumptions": survey.assumptions}
    if not rings.attrs.get("bearing_assumed"):
        statement |= {"bearing_zero": "right", "bearing_sense": "ccw"}
    writer = None
    try:
        for frame in blocks(rings):
            table = pa.Table.from_pandas(frame, preserve_index=False)
            if writer is None:
                writer = parquet.ParquetWriter(
                    path, table.schema.with_metadata({_KEY: json.dumps(statement)}), compression="zstd"
                )
            writer.write_table(table.replace_schema_metadata(writer.schema.metadata))
    finally:
        if writer is not None:
            writer.close()
