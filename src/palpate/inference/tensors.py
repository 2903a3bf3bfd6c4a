"""Tables whose axes are named, and the one operation on them: multiply and sum out.

`numpy.einsum` does the same but spends more time on its subscripts than on tables of this size, and
does not use matrix products; here the plan for each pair of name tuples is made once.
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
    """How to multiply two tables: as a broadcast product, as one matrix product, or as a stack of them.

    Orders are of the operands' axes after those that neither the other table nor the result has
    were summed.
    """

    drop_a: tuple[int, ...]
    drop_b: tuple[int, ...]
    kind: str
    order_a: tuple[int, ...]
    order_b: tuple[int, ...]
    summed: int
    first_a: bool
    first_b: bool
    order_out: tuple[int, ...]


@lru_cache(maxsize=4096)
def _plan(a: Names, b: Names, out: Names) -> _Plan:
    drop_a = tuple(i for i, n in enumerate(a) if n not in b and n not in out)
    drop_b = tuple(i for i, n in enumerate(b) if n not in a and n not in out)
    a, b = tuple(n for n in a if n in b or n in out), tuple(n for n in b if n in a or n in out)
    batch = [n for n in out if n in a and n in b]
    free_a, free_b = [n for n in a if n not in b], [n for n in b if n not in a]
    summed = [n for n in b if n in a and n not in out]
    if not summed:
        order_a, order_b = (tuple(x.index(n) if n in x else -1 for n in out) for x in (a, b))
        return _Plan(drop_a, drop_b, "multiply", order_a, order_b, 0, False, False, ())
    # Summed axes stand first where they already do, last elsewhere: that saves copies.
    first_a, first_b = not batch and a[0] in summed, batch == [] and b[0] in summed
    order_a = tuple(a.index(n) for n in ([*summed, *free_a] if first_a else [*batch, *free_a, *summed]))
    order_b = tuple(b.index(n) for n in ([*summed, *free_b] if first_b else [*batch, *free_b, *summed]))
    made = [*batch, *free_a, *free_b]
    order_out = tuple(made.index(n) for n in out)
    kind = "stacked" if batch else "matmul"
    return _Plan(drop_a, drop_b, kind, order_a, order_b, len(summed), first_a, first_b, order_out)


def _shaped(values: Array, order: tuple[int, ...]) -> Array:
    """Axes in the given order, -1 for one of length one."""
    moved = values.transpose([i for i in order if i >= 0])
    return moved[tuple(slice(None) if i >= 0 else None for i in order)] if -1 in order else moved


def product(a: Table, b: Table, out: Names) -> Table:
    """Multiply two tables over their common names and sum out what is not in `out`."""
    plan = _plan(a.names, b.names, out)
    x = a.values.sum(axis=plan.drop_a) if plan.drop_a else a.values
    y = b.values.sum(axis=plan.drop_b) if plan.drop_b else b.values
    if plan.kind == "multiply":
        return Table(_shaped(x, plan.order_a) * _shaped(y, plan.order_b), out)
    x, y, n = x.transpose(plan.order_a), y.transpose(plan.order_b), plan.summed
    if plan.kind == "stacked":
        return Table(_stacked(x, y, n, len(plan.order_out)).transpose(plan.order_out), out)
    free_a = x.shape[n:] if plan.first_a else x.shape[: x.ndim - n]
    free_b = y.shape[n:] if plan.first_b else y.shape[: y.ndim - n]
    rows, columns = prod(free_a), prod(free_b)
    x = x.reshape(-1, rows).T if plan.first_a else x.reshape(rows, -1)
    y = y.reshape(-1, columns) if plan.first_b else y.reshape(columns, -1).T
    return Table((x @ y).reshape(free_a + free_b).transpose(plan.order_out), out)


def _stacked(x: Array, y: Array, summed: int, ndim: int) -> Array:
    """Matrix products over the last axes of both, one for each index of the axes they share first."""
    batch = (x.ndim + y.ndim - 2 * summed) - ndim
    both, free_a, free_b = x.shape[:batch], x.shape[batch : x.ndim - summed], y.shape[batch : y.ndim - summed]
    stack, size = prod(both), prod(x.shape[x.ndim - summed :])
    left, right = x.reshape(stack, prod(free_a), size), y.reshape(stack, prod(free_b), size)
    return np.asarray((left @ right.transpose(0, 2, 1)).reshape(both + free_a + free_b))


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
    if len(tables) == 2:
        return product(tables[1], tables[0], out)
    left = list(tables)
    # Sizes to the next power of two: meshes differ from belief to belief, the best order hardly does.
    sizes = tuple(tuple(n.bit_length() for n in t.values.shape) for t in tables)
    for i, j, keep in _path(tuple(t.names for t in tables), sizes, out):
        left.append(product(left.pop(i), left.pop(j), keep))
    return left[0]


@lru_cache(maxsize=4096)
def _path(
    names: tuple[Names, ...], lengths: tuple[tuple[int, ...], ...], out: Names
) -> tuple[tuple[int, int, Names], ...]:
    """Which two tables to multiply next, and what names to keep: greedily the cheapest pair, j before i.

    Lengths of axes are in bits.
    """
    size = {n: 1 << bits for ns, own in zip(names, lengths, strict=True) for n, bits in zip(ns, own, strict=True)}
    left, path = list(names), list[tuple[int, int, Names]]()

    def kept(j: int, i: int) -> Names:
        later = {n for k, ns in enumerate(left) if k not in (i, j) for n in ns} | set(out)
        return tuple(n for n in dict.fromkeys(left[i] + left[j]) if n in later)

    def work(j: int, i: int) -> tuple[bool, int, int]:
        """Tables that share a name first, then the fewest products, then the smallest result."""
        both = {*left[i], *left[j]}
        return set(left[i]).isdisjoint(left[j]), prod(size[n] for n in both), prod(size[n] for n in kept(j, i))

    while len(left) > 1:
        j, i = min(((j, i) for i in range(len(left)) for j in range(i)), key=lambda pair: work(*pair))
        keep = out if len(left) == 2 else kept(j, i)
        path.append((i, j, keep))
        left = [ns for k, ns in enumerate(left) if k not in (i, j)] + [keep]
    return tuple(path)


def _summed(table: Table, out: Names) -> Table:
    drop = tuple(i for i, n in enumerate(table.names) if n not in out)
    left = tuple(n for n in table.names if n in out)
    values = table.values.sum(axis=drop) if drop else table.values
    return Table(values.transpose([left.index(n) for n in out]), out)
