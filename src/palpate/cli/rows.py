"""Tables for other programs: CSV and Parquet, on standard output or in a file."""

from __future__ import annotations

from enum import Enum
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli.files import check_writable, replacing
from palpate.errors import PalpateError

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Form", "check_output", "write_rows", "write_text"]


class Form(Enum):
    """What is printed or written."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"
    PARQUET = "parquet"

    @property
    def is_flat(self) -> bool:
        """Whether it holds rows of plain values."""
        return self in (Form.CSV, Form.PARQUET)


def check_output(form: Form, output: Path | None) -> None:
    """Refuse a form without a file to write it to, or the other way round, before anything is done."""
    if form is Form.PARQUET and output is None:
        raise PalpateError("--format parquet: is for a file, expected --output FILE")
    if form is Form.TABLE and output is not None:
        raise PalpateError("--output: a table is for people, expected --format json, csv or parquet")
    if output is not None:
        check_writable("--output", output)


def write_rows(table: pyarrow.Table, form: Form, output: Path | None) -> None:
    """Write rows as CSV or Parquet."""
    from pyarrow import csv, parquet

    if form is Form.PARQUET and output is not None:
        with replacing(output) as draft:
            parquet.write_table(table, draft, compression="zstd")
        return
    written = BytesIO()
    csv.write_csv(table, written)
    write_text(written.getvalue().decode(), output)


def write_text(text: str, output: Path | None) -> None:
    """Print a text, or write it to a file."""
    if output is None:
        print(text.rstrip("\n"))
        return
    with replacing(output) as draft:
        draft.write_text(text.rstrip("\n") + "\n", encoding="utf-8")
