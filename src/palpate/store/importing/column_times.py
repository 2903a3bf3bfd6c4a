"""When a CSV file was recorded, and when its samples were taken, as a column map says."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta, tzinfo
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.network.units import factor
from palpate.store.errors import StoreError
from palpate.store.importing.csv_table import CsvTable
from palpate.store.rows import EPOCH, moment_at

__all__ = ["FileTime", "Moment", "MomentColumn", "MomentInName", "TimeColumn", "TimeForm", "groups_in_name"]

UNIX = "unix"
"""A form of time: seconds since 1970."""


class Moment(Protocol):
    """Where it stands when a file was recorded."""

    def moment(self, table: CsvTable, notices: list[str]) -> datetime:
        """The time of a file; StoreError where it cannot be told."""


@dataclass(frozen=True)
class TimeForm:
    """How a time is written.

    Attributes
    ----------
    form
        As `datetime.strptime` has it, `UNIX`, or None for ISO 8601.
    zone
        Of times that state none; None where nobody knows.
    """

    form: str | None = None
    zone: tzinfo | None = None

    def read(self, text: str, notices: list[str]) -> datetime:
        """A time; ValueError or OverflowError where the text has another form."""
        if self.form == UNIX:
            return EPOCH + timedelta(seconds=float(text))
        moment = datetime.fromisoformat(text) if self.form is None else datetime.strptime(text, self.form)
        if moment.utcoffset() is None and self.zone is None:
            notices.append("the time states no time zone: UTC is assumed")
        return moment if moment.utcoffset() is not None else moment.replace(tzinfo=self.zone or UTC)

    @property
    def words(self) -> str:
        """What is expected."""
        return "seconds since 1970" if self.form == UNIX else f"a time {self.form or 'such as 2024-05-01T14:00:00'}"


@dataclass(frozen=True)
class MomentColumn:
    """A time in a column: that of the first row is the recording's."""

    column: str
    form: TimeForm

    def moment(self, table: CsvTable, notices: list[str]) -> datetime:
        """The time in the first cell.

        Raises
        ------
        StoreError
            If it tells none.
        """
        line, text = next(table.cells(self.column))
        try:
            return self.form.read(text, notices)
        except (ValueError, OverflowError):
            raise table.error(line, self.column, text, self.form.words) from None


@dataclass(frozen=True)
class MomentInName:
    """A time in the file's name: the group ``time`` of a pattern."""

    pattern: re.Pattern[str]
    form: TimeForm

    def moment(self, table: CsvTable, notices: list[str]) -> datetime:
        """The time that the name tells.

        Raises
        ------
        StoreError
            If it tells none.
        """
        text = groups_in_name(self.pattern, table).get("time") or ""
        try:
            return self.form.read(text, notices)
        except (ValueError, OverflowError):
            raise StoreError(f"{table.file}: found {text!r} in the name, expected {self.form.words}") from None


@dataclass(frozen=True)
class FileTime:
    """The time at which a file was last changed, which copying may change."""

    def moment(self, table: CsvTable, notices: list[str]) -> datetime:
        """The time of the file."""
        notices.append("the time is that of the last change of the file, as nothing else tells it")
        return moment_at(table.file.stat().st_mtime_ns // 1000)


@dataclass(frozen=True)
class TimeColumn:
    """Time stamps in a column."""

    column: str
    unit: str

    def time_s(self, table: CsvTable) -> NDArray[np.float64]:
        """Time stamps [s]; each row must have one, and none may be before the one ahead of it.

        Raises
        ------
        StoreError
            If that is not so; the line and the column are named.
        """
        stamps = table.numbers(self.column) * factor(self.unit, "s")
        wrong = np.flatnonzero(~np.isfinite(stamps))
        if len(wrong):
            line, cell = list(table.cells(self.column))[wrong[0]]
            raise table.error(line, self.column, cell, "a time stamp")
        back = np.flatnonzero(np.diff(stamps) < 0)
        if len(back):
            # rows of two recordings in one file, or a clock that was set: either way nobody knows when they were taken
            (before, ahead), (line, cell) = list(table.cells(self.column))[back[0] : back[0] + 2]
            raise table.error(line, self.column, cell, f"a time stamp that is not before {ahead!r} in line {before}")
        return stamps


def groups_in_name(pattern: re.Pattern[str], table: CsvTable) -> Mapping[str, str | None]:
    """What the groups of a pattern are in the name of a file.

    Raises
    ------
    StoreError
        If the pattern is nowhere in it.
    """
    found = pattern.search(table.file.name)
    if found is None:
        raise StoreError(f"{table.file}: the name does not fit the pattern {pattern.pattern!r} of the column map")
    return found.groupdict()
