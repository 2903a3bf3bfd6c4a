"""The household network in pyAgrum, every number cut into bins of equal width."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.special import ndtr

from palpate.network.families import Normal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor

Array = NDArray[np.float64]
HIGHS = {"elasticity": 200.0, "density": 10_000.0, "volume": 260.0, "mass": 2_560.0}
READINGS = {"squeezing": (-30.0, 95.0), "weighing": (-20.0, 2_580.0)}


def pyagrum() -> Any:
    """Import the rival library, or skip; its wrapper warns on import, which must not be an error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip("pyagrum", reason="the comparison needs the bench extra")


class Rival:
    """Exact inference by junction tree on the network discretised to `bins` bins."""

    def __init__(self, network: Network, bins: int = 64) -> None:
        gum = pyagrum()
        self.network, self.bins = network, bins
        self.edges = {name: np.linspace(0.0, high, bins + 1) for name, high in HIGHS.items()}
        self.bn: Any = gum.BayesNet(network.name)
        for name, prop in network.properties.items():
            size = len(prop.states) if isinstance(prop, CategoricalProperty) else bins
            self.bn.add(gum.LabelizedVariable(name, name, size))
        for name, action in network.actions.items():
            size = len(action.sensor.outcomes) if isinstance(action.sensor, ConfusionSensor) else bins + 1
            self.bn.add(gum.LabelizedVariable(name, name, size))
        for child, parents, table in [*self._properties(), *self._actions()]:
            for parent in parents:
                self.bn.addArc(parent, child)
            rows = table.reshape(-1, table.shape[-1])
            shape = [self.bn.variable(p).domainSize() for p in parents]
            for at, row in zip(np.ndindex(*shape), rows, strict=True):
                self.bn.cpt(child)[dict(zip(parents, map(int, at), strict=True))] = row.tolist()
        # An engine per question, its targets named once: naming them again would cost a new junction tree.
        self.marginals, self.joints = (gum.LazyPropagation(self.bn) for _ in range(2))
        for name in network.properties:
            self.marginals.addTarget(name)
        for parent in {action.sensor.property for action in network.actions.values()}:
            for name in network.properties:
                if name == parent:
                    self.joints.addTarget(name)
                else:
                    self.joints.addJointTarget({name, parent})
        self.channels = {name: table for name, _, table in self._actions()}

    def _properties(self) -> Iterator[tuple[str, Sequence[str], Array]]:
        for prop in self.network.properties.values():
            if isinstance(prop, CategoricalProperty):
                yield prop.name, prop.parents, prop.table
            elif isinstance(prop, ContinuousProperty):
                assert isinstance(prop.family, Normal)
                z = (self.edges[prop.name] - prop.family.mean[:, None]) / prop.family.sd[:, None]
                mass = np.diff(ndtr(z), axis=1) + 1e-12
                yield prop.name, prop.parents, mass / mass.sum(axis=1, keepdims=True)
            else:
                yield prop.name, ("density", "volume"), self._mass()

    def _mass(self) -> Array:
        density, volume = (self.edges[n][:-1] + np.diff(self.edges[n]) / 2 for n in ("density", "volume"))
        mass = np.outer(density, volume) / 1000
        at = np.clip(np.searchsorted(self.edges["mass"], mass) - 1, 0, self.bins - 1)
        return np.asarray(np.eye(self.bins)[at])

    def _actions(self) -> Iterator[tuple[str, Sequence[str], Array]]:
        for name, action in self.network.actions.items():
            sensor = action.sensor
            if isinstance(sensor, ConfusionSensor):
                yield name, (sensor.property,), sensor.table.T
                continue
            assert isinstance(sensor, NumberSensor)
            edges = self.edges[sensor.property]
            ends = np.concatenate([[-np.inf], np.linspace(*READINGS[name], self.bins), [np.inf]])
            centre = edges[:-1] + np.diff(edges) / 2
            yield name, (sensor.property,), np.diff(ndtr((ends - centre[:, None]) / sensor.sd), axis=1)

    def observed(self, action: str, value: str | float) -> int:
        """The index of a label or of the bin of a reading."""
        sensor = self.network.actions[action].sensor
        if isinstance(sensor, ConfusionSensor):
            return sensor.outcomes.index(str(value))
        return int(np.searchsorted(np.linspace(*READINGS[action], self.bins), float(value)))

    def update(self, evidence: Mapping[str, str | float]) -> dict[str, Array]:
        """All marginals given the evidence."""
        self.marginals.setEvidence({a: self.observed(a, v) for a, v in evidence.items()})
        self.marginals.makeInference()
        return {name: self.marginals.posterior(name).toarray() for name in self.network.properties}

    def decide(self, evidence: Mapping[str, str | float]) -> dict[tuple[str, str], float]:
        """Mutual information of every property and a second outcome of every action [bits].

        A second outcome of an action is one more node; here its joint with a property follows
        from the joint of the property and what the action measures.
        """
        measured = {a: action.sensor.property for a, action in self.network.actions.items()}
        self.joints.setEvidence({a: self.observed(a, v) for a, v in evidence.items()})
        self.joints.makeInference()
        gains = {}
        for action, parent in measured.items():
            for name in self.network.properties:
                gains[action, name] = bits(self._joint(name, parent) @ self.channels[action])
            gains[action, "everything"] = gains[action, parent]
        return gains

    def _joint(self, name: str, parent: str) -> Array:
        if name == parent:
            return np.diag(self.joints.posterior(name).toarray())
        joint = self.joints.jointPosterior({name, parent})
        table = np.asarray(joint.toarray())
        # The axes of a tensor stand in the reverse order of its variables' names.
        return table if joint.names[0] == parent else table.T


def bits(joint: Array) -> float:
    """Mutual information of a table [bits]."""
    apart = joint.sum(axis=1, keepdims=True) * joint.sum(axis=0)
    on = (joint > 0) & (apart > 0)
    return float((joint[on] * np.log2(joint[on] / apart[on])).sum())
