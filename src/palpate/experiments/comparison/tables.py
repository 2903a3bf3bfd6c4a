"""The table of a comparison, as Parquet and CSV."""

from __future__ import annotations

from pathlib import Path

from palpate.experiments.comparison.results import Results
from palpate.experiments.reproduction.tables import read_table
from palpate.experiments.running import gathered

__all__ = ["RESULTS", "read_results", "save_results"]

RESULTS = "results"
"""Name of the table: a row per method, tape and number of actions."""


def save_results(folder: Path) -> None:
    """Make the table of a run's parts; the probabilities of all states are in the Parquet file only."""
    from pyarrow import csv, parquet, types

    rows = gathered(folder)
    parquet.write_table(rows, folder / f"{RESULTS}.parquet")
    plain = [field.name for field in rows.schema if not types.is_list(field.type)]
    csv.write_csv(rows.select(plain), folder / f"{RESULTS}.csv")


def read_results(folder: Path) -> Results:
    """The table that `save_results` wrote.

    Raises
    ------
    PalpateError
        It is not there.
    """
    return Results(read_table(folder, RESULTS))
