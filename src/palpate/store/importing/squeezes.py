"""Recordings from CSV files, one in each; a column map says what their columns mean."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from palpate.store.checks import check
from palpate.store.importing.columns import ColumnMap
from palpate.store.importing.csv_table import CsvTable
from palpate.store.importing.items import Fate, Item, Outcome, identified
from palpate.store.records import Channel, FileItem, Recording, Series

__all__ = ["Squeezes", "read_squeeze"]

ENDINGS = (".csv", ".tsv")
UNMAPPED = "is CSV, and nothing says what its columns mean: give a column map with --columns FILE.toml"


class Squeezes:
    """CSV files.

    Parameters
    ----------
    columns
        What their columns mean; without it they are skipped.
    """

    def __init__(self, columns: ColumnMap | None = None) -> None:
        self.columns = columns

    def owns(self, path: Path) -> bool:
        """Tell whether the name ends like that of a CSV."""
        return path.suffix.lower() in ENDINGS and path.is_file()

    def count(self, path: Path) -> int:
        """One."""
        return 1

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """The recording."""
        if self.columns is None:
            yield Outcome(str(path), Fate.SKIPPED, UNMAPPED)
        else:
            yield Item(str(path), partial(read_squeeze, path, self.columns))


def read_squeeze(file: Path, columns: ColumnMap) -> Recording:
    """Read a CSV; the same file gives the same recording, under the same id.

    Raises
    ------
    StoreError
        Naming line and column of a cell that is not what the column map says.
    """
    table, notices = CsvTable.read(file, columns.form), list[str]()
    series = _series(table, columns, notices)
    recording = Recording(
        recorded_at=columns.recorded.moment(table, notices),
        action=columns.action,
        thing=columns.thing.thing(table),
        setup=columns.setup,
        series=(series,),
        files=(FileItem(file.name, "text/csv", file),) if columns.keep_file else (),
        entries=tuple(result.entry(table, notices) for result in columns.results),
        **columns.about,
    )
    left = sorted({name for name in table.header if name} - columns.columns)
    if left:
        kept = "they are in the file that is kept" if columns.keep_file else "they are left out"
        notices.append(f"the column map does not name {', '.join(map(repr, left))}: {kept}")
    recording = replace(recording, notices=tuple(notices))
    check(recording)
    return identified(recording)


def _series(table: CsvTable, columns: ColumnMap, notices: list[str]) -> Series:
    time_s = None if columns.time is None else columns.time.time_s(table)
    if time_s is None and columns.rate_hz is None:
        notices.append("neither time stamps nor a rate are stated: when the samples were taken is not known")
    channels = []
    for one in columns.channels:
        values = table.numbers(one.column)
        missing = int(np.isnan(values).sum())
        if missing:
            notices.append(f"{one.name}: {missing} of {len(values)} samples are missing")
        channels.append(Channel(one.name, one.quantity, one.unit, values, columns.rate_hz, time_s))
    return Series(columns.series, tuple(channels))
