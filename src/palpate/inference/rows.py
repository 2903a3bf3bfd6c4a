"""Rows: the states and nodes of all objectives, with their joint probabilities with categorical properties."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from palpate.inference.targets import Target
from palpate.inference.view import View
from palpate.information import TINY

__all__ = ["Rows", "stacked"]

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Rows:
    """Joint tables side by side: rows are the last axis, along which memory runs.

    Parameters
    ----------
    values
        (states of each of `names`..., rows); the rows of each objective sum to one.
    places
        Objective's number to its rows, in the order in which they are stacked.
    sum_p_log_p
        Of each objective's row totals [nats].
    """

    values: Array
    names: tuple[str, ...]
    places: Mapping[int, slice]
    sum_p_log_p: Mapping[int, float]

    def over(self, names: tuple[str, ...], objectives: Iterable[int]) -> tuple[Array, dict[int, int]]:
        """The rows of some objectives with some of the categorical properties, and where each begins.

        Returns
        -------
        matrix, starts
            (configurations, rows); objective's number to its first row.
        """
        wanted = set(objectives)
        chosen = [i for i in self.places if i in wanted]
        rows = slice(self.places[chosen[0]].start, self.places[chosen[-1]].stop)
        drop = tuple(i for i, n in enumerate(self.names) if n not in names)
        values = self.values[..., rows].sum(axis=drop) if drop else self.values[..., rows]
        between = [i for i in self.places if rows.start <= self.places[i].start < rows.stop]
        return values.reshape(-1, values.shape[-1]), {i: self.places[i].start - rows.start for i in between}


def stacked(view: View, targets: Mapping[int, Target], names: tuple[str, ...]) -> Rows:
    """The rows of all objectives, each with the categorical properties `names`."""
    blocks = [_block(view, target, names) for target in targets.values()]
    values = np.concatenate(blocks, axis=-1) if len(blocks) > 1 else blocks[0]
    ends = [0, *accumulate(b.shape[-1] for b in blocks)]
    totals = values.reshape(-1, ends[-1]).sum(axis=0)
    logs = np.add.reduceat(totals * np.log(np.maximum(totals, TINY)), ends[:-1]).tolist()
    places = {i: slice(*ends[k : k + 2]) for k, i in enumerate(targets)}
    return Rows(values, names, places, dict(zip(targets, logs, strict=True)))


def _block(view: View, target: Target, names: tuple[str, ...]) -> Array:
    """Joint of an objective (flattened to rows) and of the named categorical properties."""
    own = tuple(n for n in target.categorical if n in names)
    beside = tuple(n for n in target.categorical if n not in names)
    table = view.joint(view.members(target), (*names, *beside)).values
    shape = table.shape[: len(names)]
    table = table.reshape(*shape, -1)
    for name in own:
        # A property that is both the row's and the column's: the diagonal of the two.
        axis = names.index(name)
        diagonal = np.eye(shape[axis]).reshape([shape[axis] if i == axis else 1 for i in range(len(shape))] + [-1, 1])
        table = (table[..., None, :] * diagonal).reshape(*shape, -1)
    return table
