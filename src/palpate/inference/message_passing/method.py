"""The method itself: new beliefs after an outcome, expected entropies before an action."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError, ImpossibleEvidenceError, choices
from palpate.inference.message_passing import emulation, measuring
from palpate.inference.message_passing.graph import Beliefs, Graph
from palpate.inference.message_passing.messages import FitWeights, propagate
from palpate.inference.message_passing.mixture_fit import fit_weights, weights_of
from palpate.inference.message_passing.settings import Settings
from palpate.network.admission import AdmittedOutcome, StateLikelihood
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, DerivedProperty
from palpate.network.sensors import ConfusionSensor, NumberOutcome
from palpate.outcomes import Failed, Label, Reading

__all__ = ["Method"]

Array = NDArray[np.float64]
MEASURING, SENDING, EMULATING = range(3)
"""What chance is used for: each has its own, so that none shifts another's."""


@dataclass(frozen=True, eq=False)
class Method:
    """What stays the same from belief to belief; a belief is a mapping of nodes and `used` outcomes.

    Parameters
    ----------
    seed
        All chance follows from it, from the number of outcomes used, and from what it is for.
    """

    network: Network
    graph: Graph
    settings: Settings
    seed: int

    def after(self, beliefs: Beliefs, used: int, action: str, outcome: AdmittedOutcome) -> Beliefs | None:
        """Beliefs after an outcome: at the node it is about, then by messages at all others.

        Returns
        -------
        mapping or None
            None where the measurement counts as failed: then nothing changes.

        Raises
        ------
        EvidenceError
            The method has no use for the outcome.
        ImpossibleEvidenceError
            The outcome leaves no probability anywhere.
        """
        if isinstance(outcome, Failed):
            return None
        node = self.network.action(action).sensor.property
        if isinstance(outcome, Label | StateLikelihood):
            vector = self._vector(action, node, outcome)
            belief: Array | None = beliefs[node] * measuring.softened(vector, self.settings.outcome_error)
        elif node in self.graph.mixtures:
            number = self._unbiased(action, outcome)
            belief = measuring.seen(self.graph.mixtures[node].grid, beliefs[node], number, self._sd(action, number))
        else:
            node, belief = self._divided(beliefs, used, action, self._unbiased(action, outcome))
        if belief is None:
            return None
        if not belief.any():
            raise ImpossibleEvidenceError(
                f"action {action!r}: {outcome} leaves {node!r} no probability after the evidence before it: "
                "check the outcome"
            )
        # one that a reading had no effect on stays as it is, to the last digit
        unchanged = belief is beliefs[node]
        found = {**beliefs, node: belief if unchanged else self.graph.normalised(node, belief)}
        sent = propagate(self.graph, found, node, self._fit(self._rng(used, SENDING)))
        return {**found, **{message.receiver: message.belief for message in sent}}

    def _rng(self, used: int, *purpose: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, used, *purpose])

    def _fit(self, rng: np.random.Generator) -> FitWeights:
        return partial(weights_of, settings=self.settings, rng=rng)

    def _vector(self, action: str, node: str, outcome: Label | StateLikelihood) -> Array:
        """The outcome vector (S,); a label is one at its state and zero elsewhere."""
        if isinstance(outcome, StateLikelihood):
            return outcome.values
        known = self.network.property(node)
        assert isinstance(known, CategoricalProperty)
        if outcome.label not in known.states:
            raise EvidenceError(
                f"action {action!r}: label {outcome.label!r} is no state of {node!r}, and message passing reads a "
                f"label as a state; {choices(known.states)}"
            )
        return np.array([float(state == outcome.label) for state in known.states])

    def _unbiased(self, action: str, outcome: NumberOutcome) -> NumberOutcome:
        """The outcome less the sensor's bias."""
        sensor = self.network.action(action).sensor
        assert not isinstance(sensor, ConfusionSensor)
        if isinstance(outcome, Reading):
            return replace(outcome, value=outcome.value - sensor.bias)
        return replace(outcome, bound=outcome.bound - sensor.bias)

    def _sd(self, action: str, outcome: NumberOutcome) -> float:
        """Noise of a number: its own, or the sensor's there."""
        sensor = self.network.action(action).sensor
        assert not isinstance(sensor, ConfusionSensor)
        at = outcome.value if isinstance(outcome, Reading) else outcome.bound
        return float(sensor.scale(np.array([at]), outcome.sd)[0])

    def _divided(self, beliefs: Beliefs, used: int, action: str, outcome: NumberOutcome) -> tuple[str, Array | None]:
        """The node that a reading of a derived property is about, and its belief; None for a failed one."""
        derived = self.network.action(action).sensor.property
        if derived not in self.graph.quotients or not isinstance(outcome, Reading):
            raise EvidenceError(
                f"action {action!r}: message passing has no use for {type(outcome).__name__} of {derived!r}, "
                f"expected a Reading of one of {', '.join((*self.graph.mixtures, *self.graph.quotients))}"
            )
        known = self.network.property(derived)
        assert isinstance(known, DerivedProperty)
        settings, target, rng = self.settings, self.graph.quotients[derived].target, self._rng(used, MEASURING)
        mixture, reading = self.graph.mixtures[target], Reading(outcome.value, self._sd(action, outcome))
        samples = measuring.divided(self.graph, beliefs, derived, known.formula, reading, settings, rng)
        if len(samples) < len(mixture.means):
            return target, None
        if not settings.quotient_counts:
            return target, beliefs[target]
        weights, _ = fit_weights(samples, mixture.means, settings.quotient_iterations, settings.tolerance, rng)
        return target, beliefs[target] * mixture.density(weights)

    def expected_entropies(self, beliefs: Beliefs, used: int, action: str) -> Mapping[str, float]:
        """Expected entropy of every node [bits]; empty for an action that the method has no use for."""
        emulated = self._emulated(beliefs, action)
        if emulated is None:
            return {}
        rng = self._rng(used, EMULATING, list(self.network.actions).index(action))
        return emulation.expected_entropies(self.graph, beliefs, *emulated, self._fit(rng))

    def _emulated(self, beliefs: Beliefs, action: str) -> tuple[str, tuple[Array, float]] | None:
        """The node an action measures, and its emulated belief with the expected entropy."""
        sensor = self.network.action(action).sensor
        node = sensor.property
        if isinstance(sensor, ConfusionSensor):
            # C[:, o] has a meaning, if a strange one, only where each outcome is a state
            square = sensor.table.shape[0] == sensor.table.shape[1]
            return (node, emulation.confused(sensor.table, beliefs[node])) if square else None
        sd = sensor.sd
        if node in self.graph.quotients:
            node, sd = self.graph.quotients[node].target, self.graph.quotients[node].sd
        if node not in self.graph.mixtures:
            return None
        times_belief = self.settings.emulation_times_belief
        return node, emulation.blurred(self.graph, node, beliefs[node], sd, times_belief)
