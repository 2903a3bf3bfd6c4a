"""Meshes for deterministic quadrature: panels with Gauss-Legendre nodes, as wide as is safe.

A panel is at most `WIDTH` scales of the narrowest density or likelihood that is alive in it. Near
the finite lower end of a support, where the density of a product can be singular, panels shrink
geometrically and their nodes are placed in the logarithm of the distance to the end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

__all__ = ["WIDTH", "Finer", "Mesh", "Pieces", "split"]

Array = NDArray[np.float64]

ORDER = 6
WIDTH = 4.0
GRADED_PANELS = 4
GRADED_RATIO = 10.0
KERNEL_WIDTH = 4.0
"""Scales of a kernel that a panel may be wide for the kernel to be summed over the panel's nodes."""
MAX_CUTS = 2000
CHUNK = 20_000
"""Finer nodes at which a kernel is evaluated at a time."""
GRADED_SHARE = 0.2
"""Share of the first panel that is graded."""

_X, _W = np.polynomial.legendre.leggauss(ORDER)
_T = (_X + 1) / 2  # nodes on [0, 1]
_W = _W / 2
# _BELOW[i, k]: share of node k's mass that lies below node i, for the polynomial through all nodes.
_VANDERMONDE = np.vander(_T, ORDER, increasing=True)
_COEFFICIENTS = np.linalg.inv(_VANDERMONDE)
_POWERS = np.arange(1, ORDER + 1)
_BELOW = (_T[:, None] ** _POWERS / _POWERS) @ np.linalg.inv(_VANDERMONDE) / _W
_ENDS = (np.array([[0.0], [1.0]]) ** np.arange(ORDER)) @ np.linalg.inv(_VANDERMONDE)  # rows: t = 0, t = 1


@dataclass(frozen=True, eq=False)
class Finer:
    """Finer nodes within the panels of a mesh, and how masses at the mesh's nodes spread over them.

    By each panel's polynomial: masses at the finer nodes of a panel are shares @ its own masses.
    """

    parts: Sequence[tuple[NDArray[np.intp], Array, Array]]

    def spread(self, masses: Array) -> tuple[Array, Array]:
        """The finer nodes and their masses (F,), from masses at the mesh's nodes (K,)."""
        by_panel = masses.reshape(-1, ORDER)
        nodes = np.concatenate([x.ravel() for _, x, _ in self.parts])
        return nodes, np.concatenate([(by_panel[p] @ shares.T).ravel() for p, _, shares in self.parts])

    def averaged(self, f: Callable[[Array], Array], size: int) -> Array:
        """What the values f(x) (X, ...) come to at each of the mesh's nodes (size, ...)."""
        out: Array | None = None
        for panels, x, shares in self.parts:
            step = max(1, CHUNK // x.shape[1])
            for start in range(0, len(panels), step):
                some = slice(start, start + step)
                values = f(x[some].ravel())
                values = values.reshape(*x[some].shape, -1)  # (N, F, rest)
                if out is None:
                    out = np.empty((size // ORDER, ORDER, values.shape[-1]))
                out[panels[some]] = shares.T @ values
        assert out is not None
        return out.reshape(size, -1)


def _lagrange(t: Array) -> Array:
    """Values at t of the polynomials that are one at one node and zero at the others (T, ORDER)."""
    return np.asarray((t[:, None] ** np.arange(ORDER)) @ _COEFFICIENTS)


@dataclass(frozen=True, eq=False)
class Pieces:
    """Stretches of an axis on which densities live, and the lengths over which they change there.

    Parameters
    ----------
    lows, highs
        Ends of each stretch (N,).
    scales
        The lengths at a point (N,).
    """

    lows: Array
    highs: Array
    scales: Callable[[float], Array]


@dataclass(frozen=True, eq=False)
class Mesh:
    """Nodes and weights on panels between `edges`; the first panels may be graded towards `origin`.

    Parameters
    ----------
    edges
        Panel edges, ascending (P + 1,).
    graded
        Per panel (P,): nodes placed in the log of the distance to `origin`.
    """

    edges: Array
    graded: NDArray[np.bool_]
    origin: float = 0.0

    @cached_property
    def _placed(self) -> tuple[Array, Array]:
        low, high = self.edges[:-1, None], self.edges[1:, None]
        nodes, weights = low + (high - low) * _T, (high - low) * _W
        if self.graded.any():
            g = self.graded[:, None] & (low > self.origin)
            ratio = np.log(np.where(g, (high - self.origin) / np.where(g, low - self.origin, 1), 1))
            log_nodes = np.where(g, low - self.origin, 0) * np.exp(ratio * _T)
            nodes = np.where(g, self.origin + log_nodes, nodes)
            weights = np.where(g, log_nodes * ratio * _W, weights)
            first = self.graded[:, None] & (low <= self.origin)
            # The panel that touches the end: x = width t^3, which takes an integrable singularity.
            nodes = np.where(first, low + (high - low) * _T**3, nodes)
            weights = np.where(first, (high - low) * 3 * _T**2 * _W, weights)
        return nodes.ravel(), weights.ravel()

    @property
    def nodes(self) -> Array:
        """(K,) ascending."""
        return self._placed[0]

    @property
    def weights(self) -> Array:
        """(K,): the integral of f is the sum of weights x f(nodes)."""
        return self._placed[1]

    @cached_property
    def log_weights(self) -> Array:
        """Natural log of `weights`."""
        return np.asarray(np.log(self.weights))

    @property
    def size(self) -> int:
        """Number of nodes."""
        return ORDER * (len(self.edges) - 1)

    def cumulative(self, masses: Array) -> tuple[Array, Array]:
        """Distribution function of masses (..., K): at the edges (..., P + 1) and at the nodes (..., K)."""
        by_panel = masses.reshape(*masses.shape[:-1], -1, ORDER)
        totals = np.cumsum(by_panel.sum(axis=-1), axis=-1)
        at_edges = np.concatenate([np.zeros_like(totals[..., :1]), totals], axis=-1)
        at_nodes = at_edges[..., :-1, None] + by_panel @ _BELOW.T
        return at_edges, at_nodes.reshape(masses.shape)

    def interleaved(self, at_edges: Array, at_nodes: Array, density: Array) -> tuple[Array, Array, Array]:
        """Points, distribution function and density at edges and nodes together, ascending."""
        panels = len(self.edges) - 1
        by_panel = density.reshape(panels, ORDER)
        ends = by_panel @ _ENDS.T  # the panel's polynomial at its two ends
        left = np.concatenate([ends[:, 0], ends[-1:, 1]])
        left[1:-1] = (ends[1:, 0] + ends[:-1, 1]) / 2
        stacked = []
        for edge, node in ((self.edges, self.nodes), (at_edges, at_nodes), (np.maximum(left, 0.0), density)):
            both = np.column_stack([edge[:-1], node.reshape(panels, ORDER)]).ravel()
            stacked.append(np.append(both, edge[-1]))
        return stacked[0], stacked[1], stacked[2]

    def finer(self, scale: Array) -> Finer | None:
        """Nodes that resolve `scale` at every panel; None where the mesh's own do.

        Parameters
        ----------
        scale
            Length to resolve, at each node (K,).
        """
        cuts = np.ceil(np.diff(self.edges) / (KERNEL_WIDTH * scale.reshape(-1, ORDER).min(axis=1)))
        if (cuts <= 1).all():
            return None
        cuts = np.clip(cuts, 1, MAX_CUTS).astype(int)
        return Finer([self._finer(np.flatnonzero(cuts == cut), int(cut)) for cut in np.unique(cuts)])

    def _finer(self, panels: NDArray[np.intp], cut: int) -> tuple[NDArray[np.intp], Array, Array]:
        """Panels cut alike: the panels (N,), their finer nodes (N, F), and each panel's shares (F, ORDER)."""
        t = ((np.arange(cut)[:, None] + _T) / cut).ravel()
        shares = _lagrange(t) * (np.tile(_W, cut) / cut)[:, None] / _W
        return panels, np.stack([self._place(int(p), t) for p in panels]), shares

    def _place(self, panel: int, t: Array) -> Array:
        """Points of a panel from their place t in [0, 1]."""
        low, high = self.edges[panel], self.edges[panel + 1]
        if not self.graded[panel]:
            return np.asarray(low + (high - low) * t)
        if low <= self.origin:
            return np.asarray(low + (high - low) * t**3)
        return np.asarray(self.origin + (low - self.origin) * ((high - self.origin) / (low - self.origin)) ** t)

    def smooth(self, masses: Array, cut: int = 3) -> tuple[Array, Array]:
        """A density at `cut` times as many points, by each panel's polynomial, from masses at the nodes (K,)."""
        panels = np.arange(len(self.edges) - 1)
        t = ((np.arange(cut)[:, None] + _T) / cut).ravel()
        step = 1e-6
        x = np.stack([self._place(int(p), t) for p in panels])
        rates = np.stack([self._place(int(p), t + step) for p in panels]) - x
        values = (masses.reshape(-1, ORDER) / _W) @ _lagrange(t).T
        return x.ravel(), np.maximum(values / (rates / step), 0.0).ravel()

    def widths_at(self, x: Array) -> Array:
        """Width of the panel that each x lies in."""
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        return np.asarray(np.diff(self.edges)[panel])

    def between(self, first: int, last: int) -> Mesh:
        """The mesh of panels first to last - 1."""
        part = Mesh(self.edges[first : last + 1], self.graded[first:last], self.origin)
        nodes = slice(first * ORDER, last * ORDER)
        part.__dict__["_placed"] = (self.nodes[nodes], self.weights[nodes])  # a panel's nodes depend on it alone
        return part

    def longer(self, low: float, high: float) -> Mesh:
        """The mesh reaching half as far again at each end, within [low, high], by panels as wide as the last."""
        steps = np.diff(self.edges)
        count = int(np.ceil((self.edges[-1] - self.edges[0]) / 2 / steps[-1]))
        after = self.edges[-1] + steps[-1] * np.arange(1, count + 1)
        before = self.edges[0] - steps[0] * np.arange(count, 0, -1) if self.edges[0] > low else np.empty(0)
        edges = np.concatenate([before[before > low], self.edges, after[after < high]])
        graded = np.zeros(len(edges) - 1, dtype=bool)
        start = int((before > low).sum())
        graded[start : start + len(self.graded)] = self.graded
        return Mesh(edges, graded, self.origin)

    def halved(self) -> Mesh:
        """Every panel cut in two."""
        low, high = self.edges[:-1], self.edges[1:]
        o = self.origin
        cut = (low + high) / 2
        inner = self.graded & (low > o)
        cut = np.where(inner, o + np.sqrt(np.where(inner, (low - o) * (high - o), 1)), cut)
        cut = np.where(self.graded & (low <= o), o + (high - o) / GRADED_RATIO, cut)
        edges = np.empty(2 * len(low) + 1)
        edges[0::2], edges[1::2] = self.edges, cut
        return Mesh(edges, np.repeat(self.graded, 2), o)


def split(pieces: Pieces, low: float, high: float, graded: bool, breaks: Sequence[float] = ()) -> Mesh:
    """A mesh on [low, high], each panel at most WIDTH scales of every piece that is alive in it.

    `breaks` are panel edges, so that jumps of densities fall between panels.
    """
    edges = [low]
    ends = np.array(sorted({b for b in breaks if low < b < high} | {high}))
    while edges[-1] < high:
        end = float(ends[np.searchsorted(ends, edges[-1], side="right")])
        edges.append(_next_edge(edges[-1], end, pieces))
    is_graded = [False] * (len(edges) - 1)
    if graded:
        first = GRADED_SHARE * (edges[1] - low)
        edges[1:1] = [low + first / GRADED_RATIO**k for k in range(GRADED_PANELS, -1, -1)]
        is_graded = [True] * (GRADED_PANELS + 1) + is_graded
    return Mesh(np.array(edges), np.array(is_graded), low)


def _next_edge(x: float, end: float, pieces: Pieces) -> float:
    scales = WIDTH * pieces.scales(x)
    alive = (pieces.lows <= x) & (pieces.highs > x)
    if not alive.any():
        ahead = pieces.lows[pieces.lows > x]
        return float(min(ahead.min(), end)) if len(ahead) else end
    width = float(scales[alive].min())
    # Narrower pieces that begin within the panel end it where they begin.
    soon = (pieces.lows > x) & (pieces.lows < x + width) & (scales < width)
    if soon.any():
        width = min(width, max(float(pieces.lows[soon].min()) - x, float(scales[soon].min())))
    return end if x + width > end - 0.05 * width else float(x + width)
