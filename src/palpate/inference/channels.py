"""Channels: an action's outcome as a table of probabilities given the property it measures.

Readings are put on a mesh of their own, weights included, with a column for each end at which the
sensor saturates, so that information is computed for numbers as for labels.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import special

from palpate.inference.mesh import ORDER, WIDTH, Mesh
from palpate.network.noises import Kernel, NormalNoise, StudentTNoise
from palpate.network.sensors import NumberOutcome, NumberSensor

__all__ = ["OUTCOME", "NumberChannel", "Tables", "reading_ends", "reading_mesh", "reading_mesh_again"]

Array = NDArray[np.float64]
Tables = dict[tuple[int, bytes, bytes], Array]
"""Sensor, mesh of readings and mesh of the measured property to a table of both."""

OUTCOME = "(outcome)"
"""Name of the axis of outcomes in tables."""
NORMAL_REACH = 6.0
HEAVY_TAIL = 1e-6
HEAVY_SHARP = 0.5
"""How much finer meshes are for Student's t, whose peak is sharper than its scale says."""
SHARED = 1e-10
"""Share of the offsets that may still be below which they count as none."""
SAMPLES = 32
TAN_ORDER = 128
MOST_KEPT, LARGEST_KEPT = 500, 20_000
"""Tables kept for all beliefs at a time, and their largest number of numbers: 80 MB together."""
SHARPEST = 0.01
"""Share of a panel below which the width of the noise changes nothing."""


class NumberChannel:
    """A reading's distribution on a mesh of readings, given the true value of the measured property.

    Parameters
    ----------
    past
        The sensor's readings so far.
    held
        The nodes of the measured property that hold something in any configuration.
    own
        The mesh of these nodes.
    readings
        The mesh of readings.
    kept
        Where tables are kept that no reading so far changes: beliefs look at the same panels again and again.
    """

    def __init__(
        self, sensor: NumberSensor, past: Sequence[NumberOutcome], held: slice, own: Mesh, readings: Mesh, kept: Tables
    ) -> None:
        self.sensor = sensor
        self.past = past
        self.held = held
        self.own = own
        self.readings = readings
        self._own: Tables = {}
        self._shared = kept
        self._key = id(sensor), readings.edges.tobytes()

    @property
    def noise_nats(self) -> Array:
        """Entropy of a reading given each node of `own` (K,) [nats]."""
        return self._kept(
            b"", self.own, lambda: _noise_nats(self.sensor, self.sensor.predictive(self.past, self.own.nodes))
        )

    def table(self, mesh: Mesh) -> Array:
        """p(reading | node of a mesh of the measured property) x weights (K, Y); rows sum to about one."""
        return self._kept(self._key[1], mesh, lambda: self._made(mesh))

    def _kept(self, readings: bytes, mesh: Mesh, made: Callable[[], Array]) -> Array:
        key = (self._key[0], readings, mesh.edges.tobytes() + mesh.graded.tobytes())
        if key in self._own:
            return self._own[key]
        alone = bool(self.past and self.sensor.offset_sd)
        if not alone and key in self._shared:
            return self._shared[key]
        table = made()
        if alone or table.size > LARGEST_KEPT:
            self._own[key] = table
            return table
        if len(self._shared) >= MOST_KEPT:
            self._shared.clear()
        self._shared[key] = table
        return table

    def at(self, x: Array) -> Array:
        """p(reading | true value x) x weights (x..., Y); zero where x is not a number."""
        flat = np.ravel(x)
        table = _columns(self.sensor, self.sensor.predictive(self.past, np.nan_to_num(flat)), self.readings)
        return np.where(np.isnan(flat)[:, None], 0.0, table).reshape(*np.shape(x), -1)

    def _made(self, mesh: Mesh) -> Array:
        # Noise far narrower than a panel counts as a hundredth of it: it smooths nothing either way.
        panels = np.repeat(np.diff(mesh.edges), ORDER)
        finer = mesh.finer(np.maximum(self.sensor.scale(mesh.nodes), SHARPEST * panels))
        if finer is None:
            return _columns(self.sensor, self.sensor.predictive(self.past, mesh.nodes), self.readings)
        # The noise is narrower than the mesh: average the kernel over each panel's polynomial.
        return finer.averaged(lambda x: self._blurred(x, SHARPEST * mesh.widths_at(x)), mesh.size)

    def _blurred(self, x: Array, least: Array) -> Array:
        kernel = self.sensor.predictive(self.past, x)
        blurred = replace(kernel, scale=np.maximum(kernel.scale, least[:, None]))
        return _columns(self.sensor, blurred, self.readings)


def _columns(sensor: NumberSensor, kernel: Kernel, readings: Mesh) -> Array:
    columns = [kernel.density(readings.nodes) * readings.weights]
    if np.isfinite(sensor.low):
        columns.append(kernel.cdf(np.array([sensor.low])))
    if np.isfinite(sensor.high):
        columns.append(kernel.survival(np.array([sensor.high])))
    return columns[0] if len(columns) == 1 else np.hstack(columns)


def _reach(sensor: NumberSensor) -> float:
    """Scales of the noise from the true value beyond which there are hardly any readings."""
    if isinstance(sensor.noise, StudentTNoise):
        return float(-special.stdtrit(sensor.noise.dof, HEAVY_TAIL))
    return NORMAL_REACH


def _within(sensor: NumberSensor, low: float, high: float) -> tuple[float, float]:
    """The part of an interval in which the sensor does not saturate."""
    low, high = max(low, sensor.low), min(high, sensor.high)
    if not low < high:  # all readings saturate; a mesh that holds nothing keeps the shapes
        return (sensor.high - 1e-6, sensor.high) if low >= sensor.high else (sensor.low, sensor.low + 1e-6)
    return low, high


def reading_ends(sensor: NumberSensor, low: float, high: float) -> tuple[float, float]:
    """Ends of the readings that true values from low to high give, where the sensor does not saturate."""
    far = _reach(sensor) * float(np.hypot(sensor.scale(np.array([low, high])).max(), sensor.offset_sd))
    return _within(sensor, low + sensor.bias - far, high + sensor.bias + far)


def reading_mesh_again(sensor: NumberSensor, kernel: Kernel) -> Mesh:
    """A mesh for the next reading of a sensor whose readings share an offset that some of them have told.

    The next one lies near those before, closer than the property and the offset would let expect.

    Parameters
    ----------
    kernel
        The next reading's distribution at the nodes of the measured property.
    """
    counts = kernel.weight > SHARED
    centres, scales = kernel.centre[counts], kernel.scale[counts]
    far = _reach(sensor) * scales
    low, high = _within(sensor, float((centres - far).min()), float((centres + far).max()))
    sharp = HEAVY_SHARP if isinstance(sensor.noise, StudentTNoise) else 0.5
    panels = int(np.ceil((high - low) / (WIDTH * sharp * float(scales.min()))))
    return Mesh(np.linspace(low, high, panels + 1), np.zeros(panels, dtype=bool), low)


def reading_mesh(sensor: NumberSensor, meshes: Sequence[Mesh], corners: Array, only_noise: bool) -> Mesh:
    """A mesh for readings, as fine as the noise and the finest mesh of the measured property ask for.

    Parameters
    ----------
    meshes
        Of the measured property: its own and those of its charts with
        other members, where it can be narrower given them. The panels that hold something.
    corners
        Where densities of the measured property have an end.
    only_noise
        Whether the property can be far narrower given other evidence than its meshes show.
    """
    ends = np.array([min(m.edges[0] for m in meshes), max(m.edges[-1] for m in meshes)])
    sharp = HEAVY_SHARP if isinstance(sensor.noise, StudentTNoise) else 1.0
    low, high = reading_ends(sensor, ends[0], ends[1])
    # what is wanted of a reading is worked out where the true value would be if there were no noise
    x = _sampled(low - sensor.bias, high - sensor.bias, meshes)
    inside = np.clip(x, *ends)
    noise = np.hypot(sensor.scale(inside), sensor.offset_sd)
    fine = np.min([m.widths_at(inside) for m in meshes], axis=0) / WIDTH * (not only_noise)
    # Near a corner of the densities only the noise smooths the readings'.
    for corner in corners:
        near = np.abs(x - corner)
        fine, noise = np.minimum(fine, 0.3 * near), noise * np.minimum(1.0, 0.5 + 0.1 * near / noise)
    # Beyond the property's mesh there is only the tail of the noise, which changes ever more slowly.
    wanted = 1 / (WIDTH * sharp * np.hypot(np.hypot(noise, fine), 0.25 * np.abs(x - inside)))
    total = np.concatenate([[0.0], np.cumsum((wanted[1:] + wanted[:-1]) / 2 * np.diff(x))])
    panels = int(np.ceil(total[-1]))
    edges = np.interp(np.linspace(0, total[-1], panels + 1), total, x) + sensor.bias
    return Mesh(edges, np.zeros(panels, dtype=bool), low)


def _sampled(low: float, high: float, meshes: Sequence[Mesh]) -> Array:
    """Points at which the wanted fineness is looked at: even ones, and those of the meshes."""
    points = np.concatenate([np.linspace(low, high, SAMPLES), *(m.edges for m in meshes)])
    points.sort()
    return points[(points >= low) & (points <= high)]


def _noise_nats(sensor: NumberSensor, kernel: Kernel) -> Array:
    if isinstance(kernel.noise, NormalNoise) and kernel.centre.shape[1] == 1:
        return _normal_nats(sensor, kernel.centre[:, 0], kernel.scale[:, 0])
    return _numeric_nats(sensor, kernel)


def _normal_nats(sensor: NumberSensor, centre: Array, scale: Array) -> Array:
    """Entropy of a saturating normal reading: closed form of -int f ln f between the ends."""
    whole = 0.5 * np.log(2 * np.pi * np.e) + np.log(scale)
    if np.isinf(sensor.low) and np.isinf(sensor.high):
        return np.asarray(whole)
    nats = np.zeros_like(centre)
    inside, edge_term = np.ones_like(centre), np.zeros_like(centre)
    for end, sign in ((sensor.low, -1.0), (sensor.high, 1.0)):
        if np.isfinite(end):
            z = (end - centre) / scale
            atom = special.ndtr(-sign * z)
            nats -= special.xlogy(atom, atom)
            inside -= atom
            edge_term += sign * z * np.exp(-0.5 * z * z) / np.sqrt(2 * np.pi)
    return np.asarray(nats + inside * whole - 0.5 * edge_term)


def _numeric_nats(sensor: NumberSensor, kernel: Kernel) -> Array:
    """The same for any noise, by quadrature in the angle whose tangent is the residual."""
    t, w = np.polynomial.legendre.leggauss(TAN_ORDER)
    middle = (kernel.weight * kernel.centre).sum(axis=1)
    spread = np.sqrt((kernel.weight * (kernel.centre - middle[:, None]) ** 2).sum(axis=1))
    wide = np.hypot(kernel.scale.max(axis=1), spread)
    first, last = (np.arctan((end - middle) / wide)[:, None] for end in (sensor.low, sensor.high))
    angle = first + (last - first) * (t + 1) / 2
    y = middle[:, None] + wide[:, None] * np.tan(angle)
    weight = (last - first) / 2 * w * wide[:, None] / np.cos(angle) ** 2
    z = (y[:, None, :] - kernel.centre[:, :, None]) / kernel.scale[:, :, None]
    p = (kernel.weight[:, :, None] * np.exp(kernel.noise.log_density(z)) / kernel.scale[:, :, None]).sum(axis=1)
    nats = -(special.xlogy(p, p) * weight).sum(axis=1)
    for end, side in ((sensor.low, kernel.cdf), (sensor.high, kernel.survival)):
        if np.isfinite(end):
            atom = side(np.array([end]))[:, 0]
            nats = nats - special.xlogy(atom, atom)
    return np.asarray(nats)
