"""A CSV file as columns of text that know their lines, so that an error can name a cell."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.errors import choices, near
from palpate.store.errors import StoreError

__all__ = ["CsvForm", "CsvTable"]


@dataclass(frozen=True)
class CsvForm:
    """How CSV files are written.

    Attributes
    ----------
    delimiter, quote
        Single characters, between cells and around them.
    decimal
        ``"."`` or ``","`` in numbers.
    encoding
        Of the text; a mark of the byte order at its beginning is no part of it.
    lines_before
        Lines before the one with the names of the columns.
    """

    delimiter: str = ","
    quote: str = '"'
    decimal: str = "."
    encoding: str = "utf-8-sig"
    lines_before: int = 0


@dataclass(frozen=True)
class CsvTable:
    """The cells of a file.

    Attributes
    ----------
    file
        For messages.
    lines
        The number of the line of each row.
    """

    file: Path
    form: CsvForm
    header: Sequence[str]
    rows: Sequence[Sequence[str]] = field(repr=False)
    lines: Sequence[int] = field(repr=False)

    @classmethod
    def read(cls, file: Path, form: CsvForm) -> CsvTable:
        """Read a file.

        Raises
        ------
        StoreError
            If it cannot be read, has no line of names or none after it, or one with more or fewer cells.
        """
        try:
            with file.open(encoding=form.encoding, newline="") as opened:
                header, *numbered = _rows(file, opened, form) or [(1, [])]
        except UnicodeError as error:
            raise StoreError(
                f"{file}: is no text in {form.encoding} ({error}), expected CSV in this encoding"
            ) from error
        names = [name.strip() for name in header[1]]
        if not any(names) or not numbered:
            raise StoreError(f"{file}: has no samples, expected a line of names and lines of numbers")
        for line, cells in numbered:
            if len(cells) != len(names):
                raise StoreError(f"{file} line {line}: {len(cells)} cells, expected {len(names)} as in the names")
        return cls(file, form, names, [cells for _, cells in numbered], [line for line, _ in numbered])

    def cells(self, column: str) -> Iterator[tuple[int, str]]:
        """The cells of a column with their lines.

        Raises
        ------
        StoreError
            If there is no such column, or two of them.
        """
        if self.header.count(column) != 1:
            names = [name for name in dict.fromkeys(self.header) if name]
            found = "two columns" if column in self.header else "no column"
            raise StoreError(f"{self.file}: {found} {column!r}{near(column, names)}; {choices(names)}")
        place = self.header.index(column)
        return ((line, row[place].strip()) for line, row in zip(self.lines, self.rows, strict=True))

    def numbers(self, column: str) -> NDArray[np.float64]:
        """The numbers of a column; NaN where a cell is empty.

        Raises
        ------
        StoreError
            Naming line and column of a cell that is no number.
        """
        return np.array([self._number(line, column, cell) for line, cell in self.cells(column)])

    def only(self, column: str) -> str | None:
        """What stands in all cells of a column that are not empty; None where all are.

        Raises
        ------
        StoreError
            Naming the line where something else stands.
        """
        found: str | None = None
        for line, cell in self.cells(column):
            if cell and found is not None and cell != found:
                raise self.error(line, column, cell, f"{found!r} as in the lines before, as one file is one recording")
            found = cell or found
        return found

    def only_number(self, column: str) -> float | None:
        """The number in all cells of a column that are not empty; None where all are, or where it is NaN."""
        text = self.only(column)
        if text is None:
            return None
        line = next(line for line, cell in self.cells(column) if cell)
        value = self._number(line, column, text)
        return None if math.isnan(value) else value

    def error(self, line: int, column: str, found: str, expected: str) -> StoreError:
        """An error at a cell."""
        return StoreError(f"{self.file} line {line}, column {column!r}: found {found!r}, expected {expected}")

    def _number(self, line: int, column: str, text: str) -> float:
        if not text:
            return math.nan
        wrong = "." if self.form.decimal == "," else ","
        try:
            # Python reads 1_000, and nobody writes it
            if wrong in text or "_" in text:
                raise ValueError
            return float(text.replace(",", "."))
        except ValueError:
            comma = " with a decimal comma" if self.form.decimal == "," else ""
            raise self.error(line, column, text, f"a number{comma}") from None


def _rows(file: Path, lines: Iterable[str], form: CsvForm) -> list[tuple[int, list[str]]]:
    """Rows that are not empty, with the numbers of their lines."""
    given = iter(lines)
    for _ in range(form.lines_before):
        next(given, None)
    reader = csv.reader(given, delimiter=form.delimiter, quotechar=form.quote, skipinitialspace=True, strict=True)
    try:
        return [(form.lines_before + reader.line_num, row) for row in reader if row not in ([], [""])]
    except csv.Error as error:
        where = f"{file} line {form.lines_before + reader.line_num}"
        raise StoreError(f"{where}: cannot be read ({error}), expected cells between {form.delimiter!r}") from error
