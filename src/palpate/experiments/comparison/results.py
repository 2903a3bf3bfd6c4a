"""The table of a comparison, read: columns as arrays, means by object, and the paths that methods took."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.experiments.frames import Frame
from palpate.experiments.statistics import bootstrap_interval, object_means

if TYPE_CHECKING:
    import pyarrow as pa

__all__ = ["Curve", "Path", "Results"]

Array = NDArray[np.float64]
MARK = "_cross_entropy_bits"
CURVE_SEED = 1


@dataclass(frozen=True)
class Path:
    """A way that a method went through one tape.

    Parameters
    ----------
    weight
        Probability of it.
    rows
        Indices of the rows, by number of actions.
    """

    object: str
    weight: float
    rows: NDArray[np.intp]


@dataclass(frozen=True)
class Curve:
    """Means over objects by number of actions, with 95 % intervals over objects."""

    steps: tuple[int, ...]
    mean: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


class Results:
    """Rows of a comparison.

    Parameters
    ----------
    frame
        Its table, a column an array.
    """

    def __init__(self, frame: Frame) -> None:
        self._frame = frame

    @classmethod
    def read(cls, table: pa.Table) -> Results:
        """The rows of a table."""
        return cls(Frame.of(table))

    def __len__(self) -> int:
        return len(self._frame)

    @cached_property
    def categorical(self) -> tuple[str, ...]:
        """The categorical properties."""
        return tuple(name.removesuffix(MARK) for name in self._frame.names if name.endswith(MARK))

    @cached_property
    def continuous(self) -> tuple[str, ...]:
        """The continuous properties."""
        return tuple(name.removesuffix("_crps") for name in self._frame.names if name.endswith("_crps"))

    def distinct(self, column: str) -> tuple[str, ...]:
        """The values of a column, in order of first appearance."""
        return tuple(self._frame.unique(column))

    def numbers(self, column: str) -> Array:
        """A column of numbers (N,)."""
        return np.asarray(self._frame[column], float)

    def texts(self, column: str) -> list[str]:
        """A column of texts."""
        return [str(value) for value in self._frame[column].tolist()]

    def where(self, **wanted: str | float) -> Results:
        """The rows in which columns have these values."""
        return Results(self._frame.where(**wanted))

    def over_states(self, measure: str) -> Array:
        """Mean of a measure over the categorical properties whose truth is known (N,)."""
        found = np.stack([self.numbers(f"{name}_{measure}") for name in self.categorical])
        known = ~np.isnan(found)
        total = known.sum(axis=0)
        return np.where(total, np.where(known, found, 0.0).sum(axis=0) / np.maximum(total, 1), np.nan)

    def by_object(self, values: Array) -> dict[str, float]:
        """Weighted means of values (N,) by object."""
        return object_means(self.texts("object"), values, self.numbers("weight"))

    def mean(self, values: Array) -> float:
        """Mean over objects of the objects' means."""
        found = list(self.by_object(values).values())
        return float(np.mean(found)) if found else float("nan")

    def curve(self, measure: str) -> Curve:
        """A measure over the number of actions: one of a row, or of the categorical properties."""
        steps = tuple(sorted({int(step) for step in self.numbers("step")}))
        parts = [self.where(step=step) for step in steps]
        per_step = [np.array(list(part.by_object(part._measured(measure)).values())) for part in parts]
        ends = [bootstrap_interval(values, seed=CURVE_SEED) for values in per_step]
        low, high = zip(*ends, strict=True)
        return Curve(steps, tuple(float(values.mean()) for values in per_step), low, high)

    def _measured(self, measure: str) -> Array:
        return self.numbers(measure) if measure in self._frame else self.over_states(measure)

    def stacked(self, name: str) -> tuple[Array, NDArray[np.intp], Array]:
        """Of the rows that know a categorical property's truth: probabilities (M, S), true index (M,), weights (M,)."""
        truth = self.numbers(f"{name}_truth")
        known = ~np.isnan(truth)
        p = np.array(self._frame[f"{name}_probabilities"][known].tolist(), float)
        return p, truth[known].astype(np.intp), self.numbers("weight")[known]

    def paths(self) -> Iterator[Path]:
        """The paths of one method in one world; of beliefs that stand for sets of actions, all orders."""
        places: dict[tuple[str, float], list[int]] = {}
        for row, key in enumerate(zip(self.texts("object"), self.numbers("repetition").tolist(), strict=True)):
            places.setdefault(key, []).append(row)
        steps, used = self.numbers("step"), self.texts("used")
        for (name, _), rows in places.items():
            taken = {tuple(used[row].split("+")) if used[row] else (): row for row in rows}
            if len({steps[row] for row in rows}) == len(rows):  # one way only
                yield Path(name, 1.0, np.array(sorted(rows, key=lambda row: steps[row])))
                continue
            full = [key for key in taken if len(key) == max(map(len, taken))]
            ways = [_chain(taken, key) for key in full] if len(full) > 1 else _all_orders(taken, full[0])
            for way in ways:
                yield Path(name, 1 / len(ways), np.array(way))


def _chain(taken: Mapping[tuple[str, ...], int], key: tuple[str, ...]) -> list[int]:
    """The rows on the way to a sequence of actions."""
    return [taken[key[:step]] for step in range(len(key) + 1)]


def _all_orders(taken: Mapping[tuple[str, ...], int], full: Sequence[str]) -> list[list[int]]:
    """The rows on the way in each order, where a row stands for a set of actions in the order of `full`."""
    sets = {frozenset(key): row for key, row in taken.items()}
    return [[sets[frozenset(order[:step])] for step in range(len(full) + 1)] for order in permutations(full)]
