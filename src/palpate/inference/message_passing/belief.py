"""The message-passing belief: a marginal per node, and whatever can be answered from marginals alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError, choices
from palpate.inference.belief import EVERYTHING, Gains, Objective, Observation
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.inference.message_passing.graph import Beliefs, Graph, read_graph
from palpate.inference.message_passing.marginals import UnsaidMarginal
from palpate.inference.message_passing.method import Method
from palpate.inference.message_passing.mixture_fit import scikit_learn_start
from palpate.inference.message_passing.settings import Settings
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.information import kl_bits
from palpate.network.admission import AdmittedOutcome, StateLikelihood, admit
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, DerivedProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.outcomes import Above, Below, Failed, Label, Outcome, Reading

__all__ = ["MessagePassingBelief"]

Array = NDArray[np.float64]


class MessagePassingBelief:
    """Marginals of all nodes of the published graph, changed by messages as in the paper.

    A pure function of network, settings, seed and evidence in its order: fits by EM draw from a
    generator that follows from the seed and the number of outcomes used. Nothing is known of how
    properties depend on each other, so several together are answered as if they were independent,
    or not at all (None).

    Source: Kruzliak et al., IROS 2024, doi 10.1109/IROS58592.2024.10802249.

    Parameters
    ----------
    network
        `household`, `household-filled`, or another one with the same properties and states.
    settings
        As the program was released, unless given.
    seed
        Of the samples for fits by EM.
    graph
        The graph and its tables; the published one unless given.

    Raises
    ------
    NetworkError
        The network does not fit the published graph.
    PalpateError
        scikit-learn is not installed.

    Examples
    --------
    >>> import palpate
    >>> belief = MessagePassingBelief(palpate.load_network("household"))
    >>> after = belief.update("cat-vision", palpate.Label("mug"))
    >>> round(float(after.probabilities("category").max()), 3)
    0.99
    """

    def __init__(
        self, network: Network, settings: Settings | None = None, seed: int = 0, graph: Graph | None = None
    ) -> None:
        scikit_learn_start()  # where it is missing, say so before anything is measured
        known = read_graph(network) if graph is None else graph
        self._fill(Method(network, known, settings or Settings.as_released(), seed), (), known.prior, 0)

    def _fill(self, method: Method, evidence: tuple[Observation, ...], beliefs: Beliefs, used: int) -> None:
        self.method = method
        self.network = method.network
        self.graph = method.graph
        self.evidence = evidence
        self.beliefs = beliefs
        self._used = used  # outcomes that changed something
        self._expected: dict[str, Mapping[str, float]] = {}

    # -- evidence ---------------------------------------------------------------------------

    def update(self, action: str, outcome: Outcome | AdmittedOutcome) -> Self:
        """The belief after one more outcome.

        Raises
        ------
        EvidenceError
            The outcome does not fit the action, or the method has no use for it.
        ImpossibleEvidenceError
            The outcome leaves no probability anywhere.
        """
        admitted = admit(self.network, action, outcome).outcome
        beliefs = self.method.after(self.beliefs, self._used, action, admitted)
        after = type(self).__new__(type(self))
        evidence = (*self.evidence, Observation(action, admitted))
        if beliefs is None:
            after._fill(self.method, evidence, self.beliefs, self._used)
        else:
            after._fill(self.method, evidence, beliefs, self._used + 1)
        return after

    # -- the belief -------------------------------------------------------------------------

    def probabilities(self, *properties: str) -> Array:
        """Probabilities of categorical properties, an axis each in the order given; they sum to one.

        Of several the product of their probabilities: the method keeps no joint.

        Raises
        ------
        EvidenceError
            If the network has no such property, or one is not categorical.
        """
        joint = np.ones(())
        for name in properties:
            if not isinstance(self.network.property(name), CategoricalProperty):
                raise EvidenceError(
                    f"property {name!r} is not categorical and has no table of probabilities: "
                    f"{choices(self.graph.states)}"
                )
            joint = np.multiply.outer(joint, self.beliefs[name])
        return joint

    def marginal(self, property: str) -> CategoricalMarginal | ContinuousMarginal:
        """The belief about one property; of a derived one nothing is said (`UnsaidMarginal`)."""
        known = self.network.property(property)
        if isinstance(known, CategoricalProperty):
            return CategoricalMarginal(property, known.states, self.beliefs[property])
        if property not in self.graph.mixtures:
            return UnsaidMarginal(property, known.unit)
        grid = self.graph.mixtures[property].grid
        return ContinuousMarginal(property, known.unit, grid, grid.masses(self.beliefs[property]))

    # -- questions --------------------------------------------------------------------------

    def expected_gains(
        self, objectives: Sequence[Objective] | None = None, actions: Sequence[str] | None = None
    ) -> Gains:
        """Entropy now less expected entropy [bits] of actions about objectives; it can be negative.

        Of several categorical properties, or of several continuous ones, the sum of their gains.
        None for properties that are no nodes, for categorical and continuous ones together, and for
        everything.
        """
        wanted = (*self.network.properties, EVERYTHING) if objectives is None else tuple(objectives)
        parts = {objective: self._summands(objective) for objective in wanted}
        return {
            action: {objective: self._gain(action, nodes) for objective, nodes in parts.items()}
            for action in (self.network.actions if actions is None else actions)
        }

    def _summands(self, objective: Objective) -> tuple[str, ...]:
        """The nodes whose gains make up that of an objective; none where it has no gain."""
        names = tuple(dict.fromkeys((objective,) if isinstance(objective, str) else objective))
        if not names:
            raise EvidenceError(f"an objective names no property: {choices([*self.network.properties, EVERYTHING])}")
        known = [name for name in names if name != EVERYTHING and self.network.property(name)]
        alike = set(known) <= set(self.graph.states) or set(known) <= set(self.graph.mixtures)
        return names if alike and len(known) == len(names) else ()

    def _gain(self, action: str, nodes: Sequence[str]) -> float | None:
        if not nodes:
            return None
        if action not in self._expected:
            self._expected[action] = self.method.expected_entropies(self.beliefs, self._used, action)
        expected = self._expected[action]
        if not expected:
            return None
        return sum(self.graph.entropy_bits(node, self.beliefs[node]) - expected[node] for node in nodes)

    def realised_gain(self, after: Self, objective: Objective) -> float | None:
        """KL(after || this belief) of one property [bits]; None for several, whose joint is not known."""
        names = (objective,) if isinstance(objective, str) else objective
        if len(names) != 1 or names[0] not in self.beliefs:
            self._summands(objective)  # an unknown property is an error here too
            return None
        name = names[0]
        if name in self.graph.states:
            return kl_bits(after.beliefs[name], self.beliefs[name])
        grid = self.graph.mixtures[name].grid
        return kl_bits(grid.masses(after.beliefs[name]), grid.masses(self.beliefs[name]))

    def predict(self, action: str, sd: float | None = None) -> LabelPrediction | NumberPrediction:
        """The distribution of an action's outcome, from the belief of the node it measures.

        Raises
        ------
        EvidenceError
            The action measures a property for which the method has no belief.
        """
        sensor = self.network.action(action).sensor
        if isinstance(sensor, ConfusionSensor):
            return LabelPrediction(sensor.outcomes, np.asarray(sensor.table @ self.beliefs[sensor.property]))
        if sensor.property not in self.graph.mixtures:
            raise EvidenceError(
                f"action {action!r}: message passing has no belief about {sensor.property!r} to predict a reading "
                f"from, only about {', '.join(self.graph.nodes)}"
            )
        grid = self.graph.mixtures[sensor.property].grid
        masses = grid.masses(self.beliefs[sensor.property])
        return NumberPrediction(sensor.predictive([], grid.nodes, sd), masses, sensor.low, sensor.high)

    def log2_predictive(self, action: str, outcome: Outcome | AdmittedOutcome) -> float | None:
        """None: the method's evidence depends on its order and has no probability."""
        admit(self.network, action, outcome)
        return None

    def surprise(self, action: str, outcome: Outcome | AdmittedOutcome) -> float | None:
        """Predictive probability of an outcome at least as unlikely as this one.

        None for vectors, failures, and readings of derived properties.
        """
        admitted = admit(self.network, action, outcome).outcome
        sensor = self.network.action(action).sensor
        if isinstance(sensor, NumberSensor) and sensor.property not in self.graph.mixtures:
            return None
        if isinstance(admitted, Failed | StateLikelihood):
            return None
        prediction = self.predict(action, None if isinstance(admitted, Label) else admitted.sd)
        if isinstance(prediction, LabelPrediction):
            assert isinstance(admitted, Label)
            p = prediction.probabilities
            return float(min(1.0, p[p <= p[prediction.outcomes.index(admitted.label)] * (1 + 1e-9)].sum()))
        assert not isinstance(admitted, Label)
        return _two_sided(prediction, admitted)

    def sample(self, n: int, rng: np.random.Generator) -> Mapping[str, Array | NDArray[np.str_]]:
        """n draws of every node on its own, and derived properties of them, in the network's order."""
        drawn = {name: mixture.grid.draw(self.beliefs[name], n, rng) for name, mixture in self.graph.mixtures.items()}
        found: dict[str, Array | NDArray[np.str_]] = {}
        for name, known in self.network.properties.items():
            if isinstance(known, CategoricalProperty):
                found[name] = np.array(known.states)[rng.choice(len(known.states), size=n, p=self.beliefs[name])]
            else:
                found[name] = known.formula.evaluate(drawn) if isinstance(known, DerivedProperty) else drawn[name]
        return found


def _two_sided(prediction: NumberPrediction, outcome: Reading | Above | Below) -> float:
    """Twice the smaller tail, saturated readings ranking outermost."""
    at = np.array([outcome.value if isinstance(outcome, Reading) else outcome.bound])
    below = float(prediction.masses @ prediction.kernel.cdf(at)[:, 0])
    above = float(prediction.masses @ prediction.kernel.survival(at)[:, 0])
    tails = {Reading: min(below, above), Above: above, Below: below}
    return min(1.0, 2 * tails[type(outcome)])
