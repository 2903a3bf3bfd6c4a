"""A layered layout of a directed graph without cycles, so that no other program is needed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np

__all__ = ["Layout", "layered"]

SWEEPS = 12
STARTS = 10
Edge = tuple[str, str]


@dataclass(frozen=True)
class Layout:
    """Where nodes stand, and the points through which edges run.

    Parameters
    ----------
    nodes
        Name to (x, layer); neighbours in a layer are at least 1 apart; layer 0 has no causes.
    edges
        (start, end) to the points from node to node.
    """

    nodes: Mapping[str, tuple[float, int]]
    edges: Mapping[Edge, Sequence[tuple[float, int]]]


def layered(nodes: Sequence[str], edges: Sequence[Edge]) -> Layout:
    """Lay out a graph in layers by the longest way from a root.

    Source: Sugiyama, Tagawa and Toda (1981): long edges get a stand-in in every layer they cross,
    layers are ordered by the mean position of neighbours, and then moved towards it. Of several
    orders to start from (the same in each call) the one with the fewest crossings is taken.
    """
    layer = _layers(nodes, edges)
    chains = {edge: _chain(edge, layer) for edge in edges}
    rows: list[list[str]] = [[] for _ in range(max(layer.values()) + 1)]
    for node in nodes:
        rows[layer[node]].append(node)
    for (start, _), chain in chains.items():
        for step, stand_in in enumerate(chain[1:-1], start=layer[start] + 1):
            rows[step].append(stand_in)
    links = [pair for chain in chains.values() for pair in pairwise(chain)]
    x = _positions(rows, links)
    depth = {node: index for index, row in enumerate(rows) for node in row}
    points = {edge: [(x[node], depth[node]) for node in chain] for edge, chain in chains.items()}
    return Layout({node: (x[node], layer[node]) for node in nodes}, points)


def _layers(nodes: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    layer = dict.fromkeys(nodes, 0)
    for _ in nodes:
        for start, end in edges:
            layer[end] = max(layer[end], layer[start] + 1)
    return layer


def _chain(edge: Edge, layer: Mapping[str, int]) -> list[str]:
    start, end = edge
    return [start, *(f"{start}>{end}>{step}" for step in range(layer[start] + 1, layer[end])), end]


def _positions(rows: list[list[str]], links: Sequence[Edge]) -> dict[str, float]:
    neighbours: dict[str, list[str]] = {node: [] for row in rows for node in row}
    for start, end in links:
        neighbours[start].append(end)
        neighbours[end].append(start)
    rng = np.random.default_rng(0)
    shuffled = ([[*rng.permutation(row)] for row in rows] for _ in range(STARTS))
    settled = (_settle(start, neighbours) for start in (rows, *shuffled))
    return min(settled, key=lambda x: _crossings(x, links, rows))


def _settle(rows: Sequence[Sequence[str]], neighbours: Mapping[str, Sequence[str]]) -> dict[str, float]:
    """Move nodes towards the mean of their neighbours, from the order given."""
    x = {node: index - (len(row) - 1) / 2 for row in rows for index, node in enumerate(row)}
    for sweep in range(2 * SWEEPS):
        for row in rows if sweep % 2 == 0 else rows[::-1]:
            wish = {n: float(np.mean([x[m] for m in neighbours[n]])) if neighbours[n] else x[n] for n in row}
            # After half of the sweeps the order stays and only the distances change.
            order = sorted(row, key=wish.__getitem__ if sweep < SWEEPS else x.__getitem__)
            x.update(zip(order, _spread([wish[n] for n in order]), strict=True))
    return x


def _crossings(x: Mapping[str, float], links: Sequence[Edge], rows: Sequence[Sequence[str]]) -> tuple[int, float]:
    """How many edges cross, and how far they run sideways."""
    depth = {node: index for index, row in enumerate(rows) for node in row}
    crossed = sum(
        depth[a] == depth[c] and (x[a] - x[c]) * (x[b] - x[d]) < 0 for (a, b), (c, d) in combinations(links, 2)
    )
    return crossed, sum(abs(x[a] - x[b]) for a, b in links)


def _spread(wishes: Sequence[float]) -> list[float]:
    """The positions nearest to the wishes that keep their order and are 1 apart (least squares)."""
    from scipy.optimize import isotonic_regression

    order = np.arange(len(wishes))
    return [float(value) for value in isotonic_regression(np.asarray(wishes) - order).x + order]
