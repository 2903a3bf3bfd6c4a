"""Rows: the states and nodes of all objectives, with their joint probabilities with categorical properties."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.inference.targets import Target
from palpate.inference.trim import Trimmed
from palpate.information import TINY

__all__ = ["Rows", "stacked"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rows:
    """Joint tables stacked on top of each other.

    Parameters
    ----------
    values
        (rows, states of each of `names`...); the rows of each objective sum to one.
    starts
        First row of each objective (O,).
    place
        Objective's number to its place among the stacked ones.
    sum_p_log_p
        Of each objective's row totals (O,) [nats].
    """

    values: Array
    names: tuple[str, ...]
    starts: NDArray[np.intp]
    place: Mapping[int, int]
    sum_p_log_p: Array

    def over(self, names: tuple[str, ...]) -> Array:
        """The rows with some of the categorical properties only, as a matrix (rows, configurations)."""
        drop = tuple(i + 1 for i, n in enumerate(self.names) if n not in names)
        values = self.values.sum(axis=drop) if drop else self.values
        return values.reshape(len(values), -1)

    def per_objective(self, values: Array) -> Array:
        """Sums over each objective's rows (O,)."""
        return np.asarray(np.add.reduceat(values, self.starts))


def stacked(view: Trimmed, targets: Mapping[int, Target], names: tuple[str, ...]) -> Rows:
    """The rows of all objectives, each with the categorical properties `names`."""
    blocks = [_block(view, target, names) for target in targets.values()]
    values = np.concatenate(blocks) if len(blocks) > 1 else blocks[0]
    starts = np.cumsum([0, *(len(b) for b in blocks[:-1])])
    totals = values.reshape(len(values), -1).sum(axis=1)
    logs = np.add.reduceat(totals * np.log(np.maximum(totals, TINY)), starts)
    return Rows(values, names, starts, {i: k for k, i in enumerate(targets)}, logs)


def _block(view: Trimmed, target: Target, names: tuple[str, ...]) -> Array:
    """Joint of an objective (flattened to rows) and of the named categorical properties."""
    own = tuple(n for n in target.categorical if n in names)
    beside = tuple(n for n in target.categorical if n not in names)
    table = view.joint(view.members(target), (*beside, *names)).values
    shape = table.shape[table.ndim - len(names) :]
    table = table.reshape(-1, *shape)
    for name in own:
        # A property that is both the row's and the column's: the diagonal of the two.
        axis = names.index(name)
        diagonal = np.eye(shape[axis]).reshape([shape[axis], *(shape[axis] if i == axis else 1 for i in range(len(shape)))])
        table = (table[:, None] * diagonal).reshape(-1, *shape)
    return table
