"""Brute force on dense grids: what a network says of an object given evidence, and expected gains.

Nothing here imports `palpate.inference`; the model objects are only read for their parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor
from tests.oracle import densities, evidence
from tests.oracle.evidence import Item
from tests.oracle.grids import Grid, near, walk
from tests.oracle.groups import Feature, Integrated, Link, base_grid, is_log, pair, single
from tests.oracle.information import divergence, entropy, mutual_information
from tests.oracle.sensing import Outcomes, log_likelihood, outcomes

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Function = Callable[[Array], Array]
EVERYTHING = "everything"
TRIM = 1e-12  # share of the mass below which an end panel of a pair's grid is cut off


@dataclass(frozen=True, eq=False)
class Oracle:
    """A network to ask by brute force.

    Parameters
    ----------
    links
        How each property derived from two others is inverted.
    functions
        Derived property to (the one property it follows from, an increasing function, its inverse).
    refine
        Factor on all panel widths: halve it to see how accurate the answers are.
    """

    network: Network
    links: Sequence[Link] = ()
    functions: Mapping[str, tuple[str, Function, Function]] = field(default_factory=dict)
    refine: float = 1.0

    @cached_property
    def states(self) -> Index:
        """State index of each categorical property in each joint state, [J, properties]."""
        sizes = [len(p.states) for p in self.network.categorical]
        return np.array(list(np.ndindex(*sizes)), dtype=int).reshape(-1, len(sizes))

    def column(self, name: str) -> Index:
        """State index of one categorical property in each joint state [J]."""
        return self.states[:, [p.name for p in self.network.categorical].index(name)]

    @cached_property
    def log_prior(self) -> Array:
        """Natural log of the prior of each joint state [J]."""
        total = np.zeros(len(self.states))
        with np.errstate(divide="ignore"):
            for p in self.network.categorical:
                total += np.log(p.table[(*(self.column(q) for q in p.parents), self.column(p.name))])
        return total

    def index(self, prop: ContinuousProperty) -> Index:
        """Flat configuration index of a continuous property in each joint state [J]."""
        flat = np.zeros(len(self.states), dtype=int)
        for parent in prop.parents:
            flat = flat * len(self._categorical(parent).states) + self.column(parent)
        return flat

    def _categorical(self, name: str) -> CategoricalProperty:
        found = self.network.properties[name]
        assert isinstance(found, CategoricalProperty)
        return found

    def _continuous(self, name: str) -> ContinuousProperty:
        found = self.network.properties[name]
        assert isinstance(found, ContinuousProperty)
        return found

    def parent(self, name: str) -> str:
        """The property whose grid `name` lives on."""
        return self.functions[name][0] if name in self.functions else name

    def posterior(self, items: Sequence[Item], gains: bool = True, features: Sequence[Item] = ()) -> Posterior:
        """The posterior given the evidence; grids are fit for `gains` only if asked.

        `features` is evidence (more than `items`) that the grids shall resolve without cutting
        anything off, to compare posteriors on the same cells.
        """
        log_p = self.log_prior + self.log_categorical(items)
        groups: list[Integrated] = []
        linked = {name for link in self.links for name in (link.first, link.second)}
        for prop in self.network.continuous:
            if prop.name not in linked:
                finest = self._finest(prop.name, gains)
                on = base_grid(prop, is_log(prop), self.refine, self._features(prop.name, features or items), finest)
                groups.append(single(prop, self.index(prop), self._log_l(prop.name, items), on))
                log_p = log_p + groups[-1].log_z
        # Pairs last: their grids are cut to where the evidence outside of them leaves mass.
        for link in self.links:
            groups.append(self._pair(link, items, gains, features, log_p))
            log_p = log_p + groups[-1].log_z
        return Posterior(self, tuple(items), log_p, tuple(groups))

    def log_categorical(self, items: Sequence[Item]) -> Array:
        """Natural log of the likelihood of each joint state by labels and vectors [J]."""
        log_l = np.zeros(len(self.states))
        with np.errstate(divide="ignore"):
            for item in items:
                sensor = self.network.actions[item["action"]].sensor
                if isinstance(sensor, ConfusionSensor):
                    vector = evidence.vector(item, self._categorical(sensor.property).states)
                    if vector is not None:
                        log_l += np.log(vector)[self.column(sensor.property)]
            for name, action in self.network.actions.items():
                if isinstance(action.sensor, ConfusionSensor):
                    labels = [item["label"] for item in items if item["action"] == name and "label" in item]
                    if labels:
                        together = evidence.looks(action.sensor, labels).sum(axis=0)
                        log_l += np.log(together)[self.column(action.sensor.property)]
        return log_l

    def _sensors(self, base: str) -> list[tuple[str, NumberSensor]]:
        """Actions with number sensors of a base property or a function of it."""
        found = []
        for name, action in self.network.actions.items():
            if isinstance(action.sensor, NumberSensor) and self.parent(action.sensor.property) == base:
                found.append((name, action.sensor))
        return found

    def value(self, name: str, x: Array) -> Array:
        """The property `name` at nodes of its grid."""
        return self.functions[name][1](x) if name in self.functions else x

    def _log_l(self, base: str, items: Sequence[Item]) -> Callable[[Array], Array]:
        def log_l(x: Array) -> Array:
            total = np.zeros(x.shape)
            for name, sensor in self._sensors(base):
                mine = [i for i in items if i["action"] == name and "failed" not in i]
                if mine:
                    total += log_likelihood(sensor, mine, self.value(sensor.property, x))
            return total

        return log_l

    def _features(self, base: str, items: Sequence[Item]) -> list[Feature]:
        """Where the evidence on a base property changes within its noise."""
        found = []
        for name, sensor in self._sensors(base):
            mine = [i for i in items if i["action"] == name and "failed" not in i]
            at = [float(i.get("value", i.get("above", i.get("below", 0.0)))) for i in mine]
            sds = [float(densities.scale(sensor, np.array([y]), i.get("sd"))[0]) for y, i in zip(at, mine, strict=True)]
            pooled = sum((s**-2 for s in sds), 0.0) ** -0.5 if sds else 0.0
            centres = [*at, float(np.average(at, weights=[s**-2 for s in sds]))] if len(at) > 1 else at
            found += [self._feature(sensor.property, y, pooled) for y in centres]
        return found

    def _feature(self, name: str, centre: float, width: float) -> Feature:
        """A feature of a property as it stands on the grid of its base."""
        if name not in self.functions:
            return Feature(centre, width)
        ends = self.functions[name][2](np.maximum(np.array([centre - width, centre + width]), 1e-9))
        return Feature(float(ends.mean()), float(ends[1] - ends[0]) / 2)

    def _finest(self, base: str, gains: bool) -> float:
        widths = [s.sd if s.sd else np.inf for _, s in self._sensors(base) if s.property == base]
        return 3.5 * min([np.inf, *widths]) if gains else np.inf

    def _pair(
        self, link: Link, items: Sequence[Item], gains: bool, features: Sequence[Item], log_p: Array
    ) -> Integrated:
        props = (self._continuous(link.first), self._continuous(link.second))
        wanted = self._features(link.derived, features or items)
        # Between a narrow reading and a far tail of the prior what is left is narrow too.
        ratio = 0.05 if wanted else 0.1

        def base(k: int, finest: float = np.inf, ends: tuple[float, float] | None = None) -> Grid:
            around = self._features(props[k].name, features or items)
            return base_grid(props[k], link.log, self.refine, around, finest, ratio, ends)

        one, two = base(0), base(1)
        log_a, log_b, log_d = (self._log_l(name, items) for name in (link.first, link.second, link.derived))
        index = (self.index(props[0]), self.index(props[1]))
        low, high = (float(link.forward(one.edges[i], two.edges[i])) for i in (0, -1))
        low = max(low, 1e-14 * high) if link.log else low

        def derived(ends: tuple[float, float], finest: float, refine: float) -> Grid:
            def step(x: float) -> float:
                plain = (
                    x * (0.1 if x > 1e-4 * high else 0.15 if x > 1e-8 * high else 0.4)
                    if link.log
                    else (high - low) / 300
                )
                return refine * min([finest, plain, *(near(f.centre, f.width)(x) for f in wanted)])

            return walk(*ends, step, link.log)

        def at(first: Grid, second: Grid, third: Grid, check: Array | None = log_p) -> Integrated:
            return pair(props, index, link, (log_a, log_b, log_d), (first, second, third), check)

        if features or not gains:
            return at(one, two, derived((low, high), np.inf, self.refine))
        # Keep the part that holds the mass, and resolve the noise of later readings there.
        rough = at(one, two, derived((low, high), np.inf, 1.5), check=None)
        weights = np.exp(log_p + rough.log_z - np.max(log_p + rough.log_z))[:, None]
        kept = [on.kept(np.nan_to_num(weights * table).sum(axis=0), TRIM) for on, table in rough.tables.values()]
        ends = [(float(on.edges[0]), float(on.edges[-1])) for on in kept]
        one, two = (base(k, (ends[k][1] - ends[k][0]) / 16, ends[k]) for k in (0, 1))
        return at(one, two, derived(ends[2], self._finest(link.derived, True), self.refine))


@dataclass(frozen=True, eq=False)
class Posterior:
    """What the oracle says given the evidence."""

    oracle: Oracle
    items: tuple[Item, ...]
    log_p: Array  # [J], unnormalised: its sum is the evidence's density
    groups: tuple[Integrated, ...]

    @cached_property
    def p(self) -> Array:
        """Posterior of each joint state [J]."""
        w = np.exp(self.log_p - self.log_p.max())
        return np.asarray(w / w.sum())

    @property
    def log2_evidence(self) -> float:
        """log2 of the density of all the evidence together."""
        return float((np.log(np.exp(self.log_p - self.log_p.max()).sum()) + self.log_p.max()) / np.log(2))

    def _labels(self, names: Sequence[str]) -> tuple[Index, tuple[int, ...]]:
        sizes = tuple(len(self.oracle._categorical(n).states) for n in names)
        flat = np.zeros(len(self.p), dtype=int)
        for name, size in zip(names, sizes, strict=True):
            flat = flat * size + self.oracle.column(name)
        return flat, sizes

    def probabilities(self, *names: str) -> Array:
        """Joint table of categorical properties."""
        flat, sizes = self._labels(names)
        return np.asarray(np.bincount(flat, self.p, int(np.prod(sizes))), float).reshape(sizes)

    def _group(self, base: str) -> Integrated:
        return next(g for g in self.groups if base in g.tables)

    def masses(self, name: str) -> tuple[Grid, Array]:
        """(grid of the base property, mass of the property and each joint state [J, N])."""
        on, table = self._group(self.oracle.parent(name)).tables[self.oracle.parent(name)]
        return on, np.nan_to_num(table) * self.p[:, None]

    def moments(self, name: str) -> tuple[float, float]:
        """Mean and SD."""
        on, masses = self.masses(name)
        x, mass = self.oracle.value(name, on.x), masses.sum(axis=0)
        mean = float((x * mass).sum() / mass.sum())
        return mean, float(np.sqrt(((x - mean) ** 2 * mass).sum() / mass.sum()))

    def quantile(self, name: str, p: float) -> float:
        """The value below which a share p of the posterior lies."""
        on, masses = self.masses(name)
        return float(self.oracle.value(name, np.array(on.quantile(masses.sum(axis=0), p))))

    def entropy_bits(self, name: str) -> float:
        """Entropy, differential for the unit for continuous properties."""
        if isinstance(self.oracle.network.properties[name], CategoricalProperty):
            return entropy(self.probabilities(name))
        on, masses = self.masses(name)
        mass = masses.sum(axis=0) / masses.sum()
        keep = mass > 1e-250
        slope = np.ones(on.x.size)
        if name in self.oracle.functions:
            h = 1e-6 * on.x
            slope = (self.oracle.value(name, on.x + h) - self.oracle.value(name, on.x - h)) / (2 * h)
        return float(-(mass[keep] * np.log2(mass[keep] / on.w[keep] / slope[keep])).sum())

    def _next(self, action: str, sd: float | None = None, y: float | None = None) -> Outcomes:
        sensor = self.oracle.network.actions[action].sensor
        assert isinstance(sensor, NumberSensor)
        on, masses = self.masses(sensor.property)
        mine = [i for i in self.items if i["action"] == action and "failed" not in i]
        x = self.oracle.value(sensor.property, on.x)
        return outcomes(sensor, mine, x, masses.sum(axis=0), self.oracle.refine, sd, y)

    def _label_table(self, action: str) -> Array:
        """P(next label | joint state), [J, outcomes]."""
        sensor = self.oracle.network.actions[action].sensor
        assert isinstance(sensor, ConfusionSensor)
        labels = [i["label"] for i in self.items if i["action"] == action and "label" in i]
        return np.asarray(evidence.next_look(sensor, labels).T)[self.oracle.column(sensor.property)]

    @cached_property
    def _kernels(self) -> dict[str, tuple[Array, Array]]:
        return {}

    def _kernel(self, action: str) -> tuple[Array, Array]:
        """(P(next outcome | joint state), P(next outcome | node of the measured property)) as masses."""
        if action not in self._kernels:
            sensor = self.oracle.network.actions[action].sensor
            if isinstance(sensor, ConfusionSensor):
                table = self._label_table(action)
                self._kernels[action] = table, table
            else:
                base, kernel = self.oracle.parent(sensor.property), self._next(action).kernel
                self._kernels[action] = np.nan_to_num(self._group(base).tables[base][1]) @ kernel, kernel
        return self._kernels[action]

    def gain(self, objective: str | tuple[str, ...], action: str) -> float:
        """Mutual information [bits] of the objective and the action's next outcome."""
        parent = self.oracle.network.actions[action].sensor.property
        names = (parent,) if objective == EVERYTHING else objective
        names = (names,) if isinstance(names, str) else names
        discrete = [n for n in names if isinstance(self.oracle.network.properties[n], CategoricalProperty)]
        others = sorted({self.oracle.parent(n) for n in names if n not in discrete})
        if len(others) > 1:
            raise NotImplementedError("the oracle knows objectives with one continuous property at most")
        flat, _ = self._labels(discrete)
        blocks = []
        for k in np.unique(flat):
            of_k = np.where(flat == k, 1.0, 0.0)
            blocks.append(self._rows(action, of_k, others[0] if others else None))
        return mutual_information(blocks)

    def _rows(self, action: str, of_k: Array, other: str | None) -> Array:
        """Joint masses of a continuous property (rows; one row without) and the outcome, in the states of_k."""
        per_state, per_node = self._kernel(action)
        if other is None:
            return np.asarray((of_k * self.p) @ per_state)[None, :]
        sensor = self.oracle.network.actions[action].sensor
        if isinstance(sensor, NumberSensor):
            base = self.oracle.parent(sensor.property)
            if other == base:
                return np.asarray((of_k @ self.masses(base)[1])[:, None] * per_node)
            if other in self._group(base).tables:
                return self._group(base).cross(other, base, of_k * self.p) @ per_node
        return np.asarray((self.masses(other)[1] * of_k[:, None]).T @ per_state)

    def surprise(self, item: Item) -> tuple[float, float] | None:
        """Least and greatest surprise of a next outcome; they differ where rounding decides a tie."""
        sensor = self.oracle.network.actions[item["action"]].sensor
        if "failed" in item or "likelihood" in item or "posterior" in item:
            return None
        if isinstance(sensor, ConfusionSensor):
            predicted = self.p @ self._label_table(item["action"])
            seen = predicted[sensor.outcomes.index(item["label"])]
            low, high = (float(predicted[predicted <= seen * (1 + tie)].sum()) for tie in (-1e-7, 1e-7))
            return low, high
        bound = float(item.get("value", item.get("above", item.get("below", 0.0))))
        below, above = self._next(item["action"], item.get("sd"), bound).tails
        if "above" in item:
            below = 1.0
        if "below" in item:
            above = 1.0
        value = min(1.0, 2 * min(below, above))
        return value, value


def realised_gains(
    oracle: Oracle, items: Sequence[Item], item: Item, objectives: Sequence[str | tuple[str, ...]]
) -> list[float]:
    """KL(after || before) [bits] of each objective by one more item of evidence."""
    longer = [*items, item]
    before = oracle.posterior(items, gains=False, features=longer)
    after = oracle.posterior(longer, gains=False, features=longer)
    bits = []
    for objective in objectives:
        names = (objective,) if isinstance(objective, str) else objective
        if all(isinstance(oracle.network.properties[n], CategoricalProperty) for n in names):
            bits.append(divergence(after.probabilities(*names), before.probabilities(*names)))
        else:
            (name,) = names
            bits.append(divergence(after.masses(name)[1].sum(axis=0), before.masses(name)[1].sum(axis=0)))
    return bits


__all__ = ["EVERYTHING", "Oracle", "Posterior", "realised_gains"]
