"""Rows of a CSV file whose errors name the line and the column."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from palpate.fitting.data import Source
from palpate.fitting.errors import FittingError

__all__ = ["Row", "read_rows"]


@dataclass(frozen=True)
class Row:
    """A line of a file, by column."""

    file: Path
    line: int
    cells: Sequence[str]

    def error(self, column: str, problem: object) -> FittingError:
        """An error at a column of this line."""
        return FittingError(f"{self.file}: line {self.line}, column {column!r}: {problem}")


def read_rows(path: Path) -> tuple[Row, list[Row], Source]:
    """Read the header, the other lines that hold something, and say what the file is.

    Raises
    ------
    FittingError
        The file cannot be read, is empty, a column has no name or that of another, or a line has too many or too few
        cells.
    """
    try:
        content = path.read_bytes()
        # what spreadsheets write begins with a mark
        text = content.decode("utf-8-sig")
    except OSError as error:
        raise FittingError(f"{path}: found a file that cannot be read ({error.strerror}); expected CSV") from None
    except UnicodeDecodeError as error:
        raise FittingError(f"{path}: found bytes that are not UTF-8 at {error.start}; expected CSV text") from None
    header, *rows = _rows(path, text) or [Row(path, 1, ())]
    _check_header(header)
    for row in rows:
        if len(row.cells) != len(header.cells):
            found = f"found {len(row.cells)} cells"
            raise FittingError(f"{path}: line {row.line}: {found}; expected {len(header.cells)}, as in line 1")
    return header, rows, Source("csv", path.name, sha256(content).hexdigest(), len(rows))


def _rows(path: Path, text: str) -> list[Row]:
    reader = csv.reader(io.StringIO(text, newline=""), skipinitialspace=True, strict=True)
    rows = []
    try:
        for cells in reader:
            if any(cell.strip() for cell in cells):
                rows.append(Row(path, reader.line_num, [cell.strip() for cell in cells]))
    except csv.Error as error:
        raise FittingError(f"{path}: line {reader.line_num}: found what is no CSV ({error}); expected rows") from None
    return rows


def _check_header(header: Row) -> None:
    for place, name in enumerate(header.cells, start=1):
        if not name:
            raise FittingError(f"{header.file}: line 1, column {place}: found no name; expected one for each column")
        if header.cells.index(name) != place - 1:
            raise header.error(name, "found a second column of this name; expected each once")
    if not header.cells:
        raise FittingError(f"{header.file}: found an empty file; expected a line with the names of columns")
