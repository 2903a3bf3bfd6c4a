"""The tables of a reproduction: every step, and the beliefs of the case studies, as Parquet and CSV."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.errors import PalpateError
from palpate.experiments.frames import Frame
from palpate.experiments.reproduction.rows import SHOWN
from palpate.experiments.running import gathered

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["BELIEFS", "STEPS", "read_table", "save_tables"]

STEPS, BELIEFS = "steps", "beliefs"
"""Names of the tables: a row per step, and a row per point of a belief that is drawn."""

WHOSE = ("network", "engine", "object", "repetition", "arm", "objective", "step", "stopped")


def save_tables(folder: Path) -> None:
    """Make the tables of a run's parts, each as Parquet and as CSV."""
    from pyarrow import csv, parquet

    rows = gathered(folder)
    for name, table in ((STEPS, rows.drop_columns(list(SHOWN))), (BELIEFS, _beliefs(rows))):
        parquet.write_table(table, folder / f"{name}.parquet")
        csv.write_csv(table, folder / f"{name}.csv")


def read_table(folder: Path, name: str) -> Frame:
    """A table that `save_tables` wrote.

    Raises
    ------
    PalpateError
        It is not there.
    """
    from pyarrow import parquet

    path = folder / f"{name}.parquet"
    if not path.exists():
        raise PalpateError(f"{folder} holds no {path.name}, expected the folder of a finished run")
    return Frame.of(parquet.read_table(path))


def _beliefs(rows: pa.Table) -> pa.Table:
    """A row per state or per point of a curve, for the rows that hold them."""
    import pyarrow as pa

    states, x, values = (rows[name].to_pylist() for name in SHOWN)
    counts = [len(points or ()) for points in values]
    whose = rows.select(list(WHOSE)).take(pa.array(np.repeat(np.arange(len(counts)), counts)))
    spread = [
        (named or [None] * count, at or [None] * count, points or [])
        for named, at, points, count in zip(states, x, values, counts, strict=True)
    ]
    columns = {
        name: pa.array([item for row in spread for item in row[place]], kind)
        for place, (name, kind) in enumerate((("state", pa.string()), ("x", pa.float64()), ("value", pa.float64())))
    }
    for name, column in columns.items():
        whose = whose.append_column(name, column)
    return whose
