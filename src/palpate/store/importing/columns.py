"""What the columns of CSV files mean: the parts of a column map, each of which reads its part of a file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from palpate.store.entries import Entry, FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.importing.column_times import FileTime, Moment, TimeColumn, groups_in_name
from palpate.store.importing.csv_table import CsvForm, CsvTable
from palpate.store.records import Setup, ThingRef

__all__ = [
    "ChannelColumn",
    "ColumnMap",
    "NamedThing",
    "ResultColumn",
    "Thing",
    "ThingColumn",
    "ThingInName",
]


class Thing(Protocol):
    """Where the object is named."""

    def thing(self, table: CsvTable) -> ThingRef:
        """The object of a file; StoreError where it is not named."""


@dataclass(frozen=True)
class NamedThing:
    """One object for all files."""

    ref: ThingRef

    def thing(self, table: CsvTable) -> ThingRef:
        """That object."""
        return self.ref


@dataclass(frozen=True)
class ThingColumn:
    """An object whose name in a dataset stands in a column."""

    column: str
    dataset: str

    def thing(self, table: CsvTable) -> ThingRef:
        """The object that the column names.

        Raises
        ------
        StoreError
            If the column is empty.
        """
        found = table.only(self.column)
        if found is None:
            raise StoreError(f"{table.file}: column {self.column!r} is empty, expected the name of the object")
        return ThingRef(self.dataset, found)


@dataclass(frozen=True)
class ThingInName:
    """An object that the file's name tells: groups of a pattern are ``id`` and perhaps ``dataset``, ``common_name``."""

    pattern: re.Pattern[str]
    dataset: str | None = None

    def thing(self, table: CsvTable) -> ThingRef:
        """The object that the name tells."""
        found = {key: text for key, text in groups_in_name(self.pattern, table).items() if text}
        return ThingRef(
            found.get("dataset", self.dataset or ""), found.get("id", ""), common_name=found.get("common_name")
        )


@dataclass(frozen=True)
class ChannelColumn:
    """Samples in a column."""

    name: str
    column: str
    quantity: str
    unit: str | None


@dataclass(frozen=True)
class ResultColumn:
    """A result in a column: the same number in all cells that are not empty."""

    property: str
    column: str
    unit: str | None
    sd: float | None = None
    sd_column: str | None = None

    def entry(self, table: CsvTable, notices: list[str]) -> Entry:
        """The result; a failed one where there is no number."""
        value = table.only_number(self.column)
        if value is None:
            notices.append(f"column {self.column!r} holds no number: this is a failed measurement")
            return FailedEntry(f"no number in column {self.column!r}", self.property)
        sd = table.only_number(self.sd_column) if self.sd_column is not None else self.sd
        return Value(self.property, value, sd, self.unit)


@dataclass(frozen=True)
class ColumnMap:
    """What CSV files of one kind mean.

    Attributes
    ----------
    action, thing, recorded, setup
        What was done, to what, when, and with which devices.
    series
        The name of the series.
    channels, results
        The columns with samples, and with results.
    time, rate_hz
        Where the time stamps are, or the samples per second; neither where nobody knows.
    about
        Further fields of each recording, such as its owner.
    keep_file
        Whether the CSV is kept as a file too.
    form
        How the files are written.
    """

    action: str
    thing: Thing
    series: str
    channels: tuple[ChannelColumn, ...]
    recorded: Moment = field(default_factory=FileTime)
    setup: Setup = field(default_factory=Setup)
    results: tuple[ResultColumn, ...] = ()
    time: TimeColumn | None = None
    rate_hz: float | None = None
    about: Mapping[str, Any] = field(default_factory=dict)
    keep_file: bool = False
    form: CsvForm = field(default_factory=CsvForm)

    @property
    def columns(self) -> set[str]:
        """All columns that the map uses."""
        parts = (self.thing, self.recorded, self.time, *self.channels, *self.results)
        names = {getattr(part, "column", None) for part in parts}
        return {name for name in names | {one.sd_column for one in self.results} if name is not None}
