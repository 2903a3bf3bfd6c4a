"""Tables whose axes are named, and the one operation on them: multiply and sum out.

`numpy.einsum` does the same but spends more time on its subscripts than on tables of this size;
here the plan for each pair of name tuples is made once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import prod

import numpy as np
from numpy.typing import NDArray

__all__ = ["Table", "contract", "product"]

Array = NDArray[np.float64]
Names = tuple[str, ...]


@dataclass(frozen=True, eq=False, slots=True)
class Table:
    """An array and the name of each of its axes."""

    values: Array
    names: Names

    def sum_to(self, names: Names) -> Table:
        """The table summed over all axes but `names`, its axes in that order."""
        return _summed(self, names) if self.names != names else self


@dataclass(frozen=True, slots=True)
class _Plan:
    drop_a: tuple[int, ...]
    drop_b: tuple[int, ...]
    order_a: tuple[int, ...]
    order_b: tuple[int, ...]
    batch: int
    free_a: int
    free_b: int
    summed: int
    order_out: tuple[int, ...]


@lru_cache(maxsize=4096)
def _plan(a: Names, b: Names, out: Names) -> _Plan:
    drop_a = tuple(i for i, n in enumerate(a) if n not in b and n not in out)
    drop_b = tuple(i for i, n in enumerate(b) if n not in a and n not in out)
    a, b = tuple(n for n in a if n in b or n in out), tuple(n for n in b if n in a or n in out)
    batch = [n for n in out if n in a and n in b]
    free_a, free_b = [n for n in a if n not in b], [n for n in b if n not in a]
    summed = [n for n in a if n in b and n not in out]
    made = [*batch, *free_a, *free_b]
    return _Plan(
        drop_a,
        drop_b,
        tuple(a.index(n) for n in [*batch, *free_a, *summed]),
        tuple(b.index(n) for n in [*batch, *summed, *free_b]),
        len(batch),
        len(free_a),
        len(free_b),
        len(summed),
        tuple(made.index(n) for n in out),
    )


def product(a: Table, b: Table, out: Names) -> Table:
    """Multiply two tables over their common names and sum out what is not in `out`."""
    plan = _plan(a.names, b.names, out)
    x = a.values.sum(axis=plan.drop_a) if plan.drop_a else a.values
    y = b.values.sum(axis=plan.drop_b) if plan.drop_b else b.values
    x, y = x.transpose(plan.order_a), y.transpose(plan.order_b)
    nb, na, ns = plan.batch, plan.free_a, plan.summed
    shape = x.shape[: nb + na] + y.shape[nb + ns :]
    if ns:
        batch, rows, inner = prod(x.shape[:nb]), prod(x.shape[nb : nb + na]), prod(x.shape[nb + na :])
        z = np.matmul(x.reshape(batch, rows, inner), y.reshape(batch, inner, prod(y.shape[nb + ns :]))).reshape(shape)
    else:
        z = x.reshape(x.shape + (1,) * plan.free_b) * y.reshape(y.shape[:nb] + (1,) * na + y.shape[nb:])
    return Table(z.transpose(plan.order_out), out)


def contract(tables: Sequence[Table], out: Names) -> Table:
    """Multiply tables and sum out every name not in `out`, in the order that makes the least work.

    Examples
    --------
    >>> a = Table(np.ones((2, 3)), ("c", "m"))
    >>> b = Table(np.full((3, 4), 0.5), ("m", "r"))
    >>> contract([a, b], ("r", "c")).values.tolist()[0]
    [1.5, 1.5]
    """
    if len(tables) == 1:
        return tables[0].sum_to(out)
    left = list(tables)
    for i, j, keep in _path(tuple(t.names for t in tables), tuple(t.values.shape for t in tables), out):
        left.append(product(left.pop(i), left.pop(j), keep))
    return left[0]


@lru_cache(maxsize=4096)
def _path(names: tuple[Names, ...], shapes: tuple[tuple[int, ...], ...], out: Names) -> tuple[tuple[int, int, Names], ...]:
    """Which two tables to multiply next, and what names to keep: greedily the cheapest pair, j before i."""
    size = {n: s for ns, shape in zip(names, shapes, strict=True) for n, s in zip(ns, shape, strict=True)}
    left, path = list(names), []
    while len(left) > 1:
        pairs = [(j, i) for i in range(len(left)) for j in range(i)]
        j, i = min(pairs, key=lambda pair: prod(size[n] for n in {*left[pair[0]], *left[pair[1]]}))
        later = {n for k, ns in enumerate(left) if k not in (i, j) for n in ns} | set(out)
        both = dict.fromkeys(left[i] + left[j])
        keep = out if len(left) == 2 else tuple(n for n in both if n in later)
        path.append((i, j, keep))
        left = [ns for k, ns in enumerate(left) if k not in (i, j)] + [keep]
    return tuple(path)


def _summed(table: Table, out: Names) -> Table:
    drop = tuple(i for i, n in enumerate(table.names) if n not in out)
    left = tuple(n for n in table.names if n in out)
    values = table.values.sum(axis=drop) if drop else table.values
    return Table(values.transpose([left.index(n) for n in out]), out)
