"""Where the likelihood of readings lives, and the mesh that resolves it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.inference.axes import ALONE
from palpate.inference.mesh import WIDTH, Mesh
from palpate.network.noises import NormalNoise
from palpate.network.sensors import NumberOutcome, NumberSensor
from palpate.outcomes import Above, Reading

__all__ = ["EDGE_MASS", "EDGE_NODES", "FAINT", "Readings", "Window", "crowding", "cut", "resolve"]

Array = NDArray[np.float64]

Readings = Sequence[tuple[NumberSensor, Sequence[NumberOutcome]]]
"""The readings of one property: per action its sensor and its outcomes."""

REACH = 7.0
"""Scales from a reading beyond which its likelihood counts as nothing at first."""
HEAVY_SHARP = 0.7
"""A heavy-tailed likelihood's peak is sharper than its scale says."""
GAP_SCALES = 4000
"""Most scales to resolve between the prior and a reading far from it."""
EDGE_NODES = 2
EDGE_MASS = 1e-6
"""Share of a configuration's mass at the outermost nodes at which a mesh reaches further."""
FAINT, FAINT_EDGE_MASS = 1e-13, 1e-2
"""Configurations this much less probable than another hardly ever matter, and the share for them."""
TINY = 1e-290
MAX_PIECES = 4000
"""Pieces that one panel is cut into at most."""
SLACK = 1.2
"""A panel may be this much wider than asked for."""


@dataclass(frozen=True)
class Window:
    """An interval that holds the likelihood, and intervals (low, high, scale) to resolve in it."""

    low: float
    high: float
    fine: tuple[tuple[float, float, float], ...]

    @classmethod
    def of(cls, readings: Readings) -> Window:
        """The window of all readings of one property together."""
        fine = [_pooled(sensor, outcomes) for sensor, outcomes in readings]
        bounds = [_bound(sensor, o) for sensor, outcomes in readings for o in outcomes if not isinstance(o, Reading)]
        pieces = [piece for group in fine for piece in group]
        heavy = any(not isinstance(sensor.noise, NormalNoise) for sensor, _ in readings)
        low = max([b.low for b in bounds] + [p[0] for p in pieces], default=-np.inf)
        high = min([b.high for b in bounds] + [p[1] for p in pieces], default=np.inf)
        if heavy:
            low, high = -np.inf, np.inf
        elif low >= high:
            ends = [e for p in pieces for e in p[:2]] + [e for b in bounds for e in (b.low, b.high) if np.isfinite(e)]
            low, high = min(ends), max(ends)
        return cls(low, high, tuple(pieces) + tuple(f for b in bounds for f in b.fine))

    def panels(self, mesh: Mesh) -> tuple[int, int] | None:
        """First panel and end of the panels that hold the window; None where the mesh ends within it."""
        end = len(mesh.edges) - 1
        first = int(np.searchsorted(mesh.edges, self.low, "right")) - 1
        last = int(np.searchsorted(mesh.edges, self.high))
        if self.low < mesh.edges[0]:
            first = 0 if mesh.graded[0] else -1
        if np.isinf(self.high):
            last = end
        return (first, last) if 0 <= first < last <= end else None

    def resolved(self, mesh: Mesh, first: int, last: int) -> bool:
        """Whether the panels resolve the window's fine intervals."""
        low, high = mesh.edges[first:last], mesh.edges[first + 1 : last + 1]
        narrow = [(high - low) <= SLACK * WIDTH * scale for *_, scale in self.fine]
        beyond = [(high <= a) | (low >= b) for a, b, _ in self.fine]
        return bool((np.array(narrow) | np.array(beyond)).all())

    def wider(self, at_low: bool, at_high: bool) -> Window:
        """Wider at one end or both, by a quarter of the widest interval to resolve or of the window."""
        widths = [high - low for low, high, _ in self.fine] + [self.high - self.low]
        width = max(w for w in widths if np.isfinite(w))
        return Window(self.low - at_low * width / 4, self.high + at_high * width / 4, self.fine)


def crowding(total: Array, most: Array | float) -> Array:
    """Mass at the end of a mesh at which a configuration wants it to reach further.

    Parameters
    ----------
    total, most
        Mass of the configuration, and of the one that has most.
    """
    return np.asarray(np.where(total > most * FAINT, EDGE_MASS, FAINT_EDGE_MASS) * total + TINY)


def _pooled(sensor: NumberSensor, outcomes: Sequence[NumberOutcome]) -> list[tuple[float, float, float]]:
    """The intervals about the readings of one action: one where the noise is normal."""
    readings = [o for o in outcomes if isinstance(o, Reading)]
    if not readings:
        return []
    values = [r.value - sensor.bias for r in readings]
    scales = [float(sensor.scale(np.array([v]), r.sd)[0]) for v, r in zip(values, readings, strict=True)]
    if sensor.relative_sd:
        least = 1e-6 * max(*map(abs, values), 1e-6)
        scales = [max(scale, least) for scale in scales]
    sharp = 1.0
    if isinstance(sensor.noise, NormalNoise):
        precision = sum(scale**-2.0 for scale in scales)
        values = [sum(v * scale**-2.0 for v, scale in zip(values, scales, strict=True)) / precision]
        scales = [precision**-0.5]
    else:
        sharp = HEAVY_SHARP / len(readings) ** 0.5
    stretch = 1 + REACH * sensor.relative_sd
    wide = [math.hypot(scale, sensor.offset_sd) for scale in scales]
    return [
        (v - REACH * w * stretch, v + REACH * w * stretch**2, sharp * w / stretch)
        for v, w in zip(values, wide, strict=True)
    ]


def _bound(sensor: NumberSensor, outcome: NumberOutcome) -> Window:
    """The half line that a bound leaves, soft over the scale of the noise."""
    assert not isinstance(outcome, Reading)
    bound = outcome.bound - sensor.bias
    scale = float(np.hypot(sensor.scale(np.array([bound]), outcome.sd)[0], sensor.offset_sd))
    reach = REACH * scale * (1 + REACH * sensor.relative_sd)
    fine = ((bound - reach, bound + reach, scale),)
    if isinstance(outcome, Above):
        return Window(bound - reach, np.inf, fine)
    return Window(-np.inf, bound + reach, fine)


def resolve(prior: Mesh, window: Window, support: tuple[float, float], whole: bool) -> Mesh:
    """The prior mesh within the window, its panels cut until they resolve the likelihood.

    Parameters
    ----------
    support
        Ends of the property's support; the mesh never leaves it.
    whole
        Keep the prior's panels outside the window too.
    """
    low, high = max(window.low, support[0]), min(window.high, support[1])
    if not low < high:  # the whole likelihood lies beyond the support: its tail decides
        low, high = support[0], min(support[1], float(prior.edges[-1]))
    # A bound beyond the prior's mesh leaves a half line of which only the beginning is likely.
    if np.isinf(high) and low >= prior.edges[-1]:
        high = max(end for _, end, _ in window.fine)
    if np.isinf(low) and high <= prior.edges[0]:
        low = min(start for start, _, _ in window.fine)
    edges, graded = _extended(prior, low, high)
    if whole:  # between the prior's mesh and a reading far from it lies what the two agree on
        window = Window(window.low, window.high, window.fine + _between(prior, edges, window))
    else:
        first = max(int(np.searchsorted(edges, low, side="right")) - 1, 0)
        last = min(int(np.searchsorted(edges, high, side="left")), len(edges) - 1)
        edges, graded = edges[first : last + 1].copy(), graded[first:last]
        # Cut off what the window leaves of its first and last panel, where that is worth a cut.
        if not graded[0]:
            edges[0] = max(edges[0], low)
        if not graded[-1]:
            edges[-1] = min(edges[-1], high)
    return _cut(edges, graded, window, prior.origin, ALONE if whole else 1.0)


def _between(prior: Mesh, edges: Array, window: Window) -> tuple[tuple[float, float, float], ...]:
    """The stretches added to the prior's mesh, to be resolved like the sharper of prior and evidence."""
    least = min((scale for *_, scale in window.fine), default=np.inf)
    found = []
    for low, high, panel in (
        (edges[0], prior.edges[0], prior.edges[:2]),
        (prior.edges[-1], edges[-1], prior.edges[-2:]),
    ):
        if low < high:
            scale = min(least, float(np.diff(panel)[0]) / WIDTH)
            found.append((float(low), float(high), max(scale, float(high - low) / GAP_SCALES)))
    return tuple(found)


def _extended(prior: Mesh, low: float, high: float) -> tuple[Array, NDArray[np.bool_]]:
    edges, graded = prior.edges, prior.graded
    if np.isfinite(low) and low < edges[0]:
        edges, graded = np.append(low, edges), np.append(False, graded)
    if np.isfinite(high) and high > edges[-1]:
        edges, graded = np.append(edges, high), np.append(graded, False)
    return edges, graded


def _cut(edges: Array, graded: NDArray[np.bool_], window: Window, origin: float, share: float) -> Mesh:
    # The ends of what is to be resolved are edges, so that nothing beside it is cut as finely.
    ends = [end for low, high, _ in window.fine for end in (low, high) if edges[0] < end < edges[-1]]
    if ends:
        split = np.unique(np.concatenate([edges, ends]))
        graded = graded[np.clip(np.searchsorted(edges, split[:-1], side="right") - 1, 0, len(graded) - 1)]
        edges = split
    scale = np.full(len(edges) - 1, np.inf)
    for low, high, fine in window.fine:
        inside = (edges[:-1] < high) & (edges[1:] > low)
        scale = np.where(inside, np.minimum(scale, share * fine), scale)
    return cut(Mesh(edges, graded, origin), scale)


def cut(mesh: Mesh, scale: Array) -> Mesh:
    """The mesh with each panel cut into equal pieces of at most WIDTH times the panel's scale (P,)."""
    edges, graded = mesh.edges, mesh.graded
    widths = np.diff(edges)
    pieces = np.maximum(np.ceil(np.minimum(widths / (WIDTH * scale), MAX_PIECES) - 1e-9).astype(int), 1)
    if (pieces == 1).all():
        return mesh
    starts = np.repeat(edges[:-1], pieces)
    steps = np.repeat(widths / pieces, pieces)
    index = np.arange(len(starts)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    still_graded = np.repeat(graded & ((pieces == 1) | (edges[:-1] <= mesh.origin)), pieces) & (index == 0)
    return Mesh(np.append(starts + index * steps, edges[-1]), still_graded, mesh.origin)
