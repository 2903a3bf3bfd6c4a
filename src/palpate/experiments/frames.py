"""Columns of a table as arrays, and the rows of them that are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Frame"]

Array = NDArray[Any]


class Frame:
    """A table in memory, a column an array; missing numbers are NaN and missing texts None.

    Parameters
    ----------
    columns
        Name to values, all as many.

    Examples
    --------
    >>> frame = Frame({"step": np.array([0, 1, 1]), "bits": np.array([3.0, 1.0, 2.0])})
    >>> frame.where(step=1)["bits"].tolist(), frame.means("bits", "step")
    ([1.0, 2.0], {0: 3.0, 1: 1.5})
    """

    def __init__(self, columns: Mapping[str, Array]) -> None:
        self._columns = dict(columns)

    @classmethod
    def of(cls, table: pa.Table) -> Frame:
        """The columns of a table of pyarrow."""
        return cls({name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names})

    def __len__(self) -> int:
        return len(next(iter(self._columns.values()), ()))

    def __contains__(self, name: str) -> bool:
        return name in self._columns

    def __getitem__(self, name: str) -> Array:
        return self._columns[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._columns)

    def where(self, **equal: object) -> Frame:
        """The rows in which the columns have these values."""
        mask = np.ones(len(self), dtype=bool)
        for name, value in equal.items():
            mask &= np.asarray(self[name] == value, dtype=bool)
        return self.rows(mask)

    def rows(self, mask: Array) -> Frame:
        """The rows that a mask, or an array of places, picks out."""
        return Frame({name: values[mask] for name, values in self._columns.items()})

    def unique(self, name: str) -> list[Any]:
        """The values of a column in order of appearance, without None."""
        return [value for value in dict.fromkeys(self[name].tolist()) if value is not None]

    def means(self, name: str, by: str) -> dict[Any, float]:
        """Mean of a column for each value of another one, missing numbers left out; NaN where all are."""
        values = np.asarray(self[name], dtype=float)
        found = {}
        for key in self.unique(by):
            own = values[self[by] == key]
            own = own[~np.isnan(own)]
            found[key] = float(own.mean()) if len(own) else float("nan")
        return found
