"""Quadrature grids: panels as narrow as the integrand asks for, eight Gauss-Legendre nodes in each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Step = Callable[[float], float]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes x with weights w, in panels between edges; `log` when panels are even in log x."""

    x: Array
    w: Array
    edges: Array
    log: bool

    def quantile(self, mass: Array, p: float) -> float:
        """The quantile of a distribution given by its mass (density times weight) at the nodes."""
        per_panel = mass.reshape(-1, NODES.size)
        ends = np.concatenate([[0.0], np.cumsum(per_panel.sum(axis=1))])
        target = p * ends[-1]
        panel = int(np.clip(np.searchsorted(ends, target) - 1, 0, len(per_panel) - 1))
        polynomial = np.polynomial.Legendre.fit(NODES, per_panel[panel] / WEIGHTS, NODES.size - 1, domain=[-1, 1])
        area = polynomial.integ(lbnd=-1)
        fine = np.linspace(-1, 1, 4001)
        at = float(np.interp(target - ends[panel], np.maximum.accumulate(area(fine)), fine))
        left, right = self.edges[panel : panel + 2]
        if self.log:
            return float(left * (right / left) ** ((at + 1) / 2))
        return float(left + (right - left) * (at + 1) / 2)

    def kept(self, mass: Array, share: float) -> Grid:
        """The panels from the first to the last that hold more than a share of the mass."""
        per_panel = np.nan_to_num(mass).reshape(-1, NODES.size).sum(axis=1)
        on = np.flatnonzero(per_panel > share * per_panel.sum())
        return grid(self.edges[on[0] : on[-1] + 2], self.log)


def grid(edges: Array, log: bool = False) -> Grid:
    """Eight nodes in each panel between the edges."""
    ends = np.log(edges) if log else edges
    half = np.diff(ends)[:, None] / 2
    t = (ends[:-1, None] + half + half * NODES).ravel()
    w = (half * WEIGHTS).ravel()
    x = np.exp(t) if log else t
    return Grid(x, w * x if log else w, edges, log)


def walk(low: float, high: float, step: Step, log: bool = False) -> Grid:
    """A grid from low to high whose panel at x is at most step(x) wide."""
    edges = [low]
    while edges[-1] < high:
        here = edges[-1]
        # The width asked for at the far end counts too: do not step over a narrow feature.
        width = step(here)
        for _ in range(30):
            ahead = step(here + width)
            if ahead >= 0.7 * width:
                break
            width = max(0.7 * width, ahead)
        edges.append(here + width)
    edges[-1] = high
    if len(edges) > 2 and edges[-1] - edges[-2] < 1e-9 * abs(high):
        del edges[-2]
    return grid(np.array(edges), log)


def near(centre: float, width: float) -> Step:
    """Panels of half a width within ten widths of the centre, growing with the distance beyond."""
    return lambda x: 0.5 * width + max(0.0, abs(x - centre) - 10 * width) / 3
