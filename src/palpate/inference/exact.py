"""The exact belief: enumerate the categorical properties, integrate the continuous ones by quadrature."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError, ImpossibleEvidenceError, choices
from palpate.inference.belief import EVERYTHING, Gains, Objective, Observation
from palpate.inference.chart import Frame
from palpate.inference.compiled import Compiled, compiled
from palpate.inference.gains import expected_gains
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.inference.mesh import Mesh
from palpate.inference.predicting import predict, surprise
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.inference.readings import GroupBelief
from palpate.inference.realised import realised_gain
from palpate.inference.sampling import sample
from palpate.inference.tensors import Table, contract
from palpate.inference.view import per_mass
from palpate.inference.window import Readings
from palpate.network.admission import AdmittedOutcome, StateLikelihood, admit
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor, NumberOutcome
from palpate.outcomes import Above, Below, Failed, Label, Outcome, Reading

__all__ = ["ExactBelief"]

Array = NDArray[np.float64]


class ExactBelief:
    """The posterior of all properties given evidence; a pure function of network and evidence.

    Source: Bayes' rule over the joint of the categorical properties, with the evidence of each
    group of continuous properties integrated by Gauss-Legendre quadrature.

    Parameters
    ----------
    network
        The network; the belief is its prior.

    Examples
    --------
    >>> import palpate
    >>> belief = palpate.ExactBelief(palpate.load_network("household"))
    >>> belief = belief.update("cat-vision", palpate.Label("mug")).update("weighing", palpate.Reading(118.0))
    >>> belief.marginal("category").states[int(belief.probabilities("category").argmax())]
    'mug'
    """

    def __init__(self, network: Network) -> None:
        parts = compiled(network)
        self._fill(network, parts, (), {}, parts.priors, parts.log_prior)
        self.normalise()

    def _fill(
        self,
        network: Network,
        parts: Compiled,
        evidence: tuple[Observation, ...],
        factors: Mapping[str, Array],
        groups: tuple[GroupBelief, ...],
        log_joint: Array,
    ) -> None:
        self.network = network
        self.parts = parts
        self.evidence = evidence
        self.groups = groups
        self._factors = factors  # action -> likelihood of its labels and vectors over its property's states
        self.log_joint = log_joint  # of the categorical properties and all evidence [nats]
        self._latest: tuple[str, AdmittedOutcome, Self] | None = None

    @cached_property
    def _joints(self) -> dict[tuple[str, ...], Table]:
        return {}

    @cached_property
    def _axis_masses(self) -> dict[tuple[tuple[str, ...], str], Array]:
        return {}

    def normalise(self) -> None:
        """Make a distribution of the log joint.

        Raises
        ------
        ImpossibleEvidenceError
            If the evidence has probability zero.
        """
        peak = float(self.log_joint.max())
        if peak == -np.inf:
            raise _impossible(self.evidence[-1], len(self.evidence))
        joint = np.exp(self.log_joint - peak)
        total = float(joint.sum())
        self.settle(joint / total, peak + math.log(total))

    def settle(self, joint: Array, log_evidence: float) -> None:
        """Take over the log joint made a distribution, and the log of its sum [nats]."""
        self.joint, self.log_evidence = Table(joint, self.parts.axes), log_evidence

    # -- evidence ---------------------------------------------------------------------------

    def update(self, action: str, outcome: Outcome | AdmittedOutcome) -> Self:
        """The belief after one more outcome.

        Raises
        ------
        EvidenceError
            If the outcome does not fit the action.
        ImpossibleEvidenceError
            If the network gives the outcome probability zero after the evidence so far.
        """
        admitted = admit(self.network, action, outcome).outcome
        if self._latest and not isinstance(admitted, StateLikelihood) and self._latest[:2] == (action, admitted):
            return self._latest[2]  # asked for its predictive probability just before
        after = self.unsettled(action, admitted)
        after.normalise()
        self._latest = (action, admitted, after)
        return after

    def unsettled(self, action: str, admitted: AdmittedOutcome, first: GroupBelief | None = None) -> Self:
        """The belief after one more outcome, its log joint not yet made a distribution.

        Parameters
        ----------
        first
            The measured property's group given this outcome, where it is the group's first.
        """
        evidence = (*self.evidence, Observation(action, admitted))
        factors, groups, log_joint = self._factors, self.groups, self.log_joint
        measured = self.network.actions[action].sensor.property
        if isinstance(admitted, Label) and action not in factors:
            factor, log_factor = self.parts.first_label(self.network.actions[action], admitted.label)
            factors, log_joint = {**factors, action: factor}, log_joint + log_factor
        elif isinstance(admitted, Label | StateLikelihood):
            factors = {**factors, action: self._factor(action, evidence)}
            log_joint = self._from_scratch(factors, groups)
        elif not isinstance(admitted, Failed):
            home = self.parts.home[measured]
            seen = groups[home].touched
            own = first or GroupBelief(
                groups[home].group, {**groups[home].readings, measured: self.readings(measured, evidence)}
            )
            groups = (*groups[:home], own, *groups[home + 1 :])
            log_joint = self._from_scratch(factors, groups) if seen else log_joint + self.parts.along(own.log_evidence)
        after = type(self).__new__(type(self))
        after._fill(self.network, self.parts, evidence, factors, groups, log_joint)
        return after

    def _from_scratch(self, factors: Mapping[str, Array], groups: Sequence[GroupBelief]) -> Array:
        """Log of the prior and all evidence over the joint table: an old term cannot be taken out of a -inf."""
        log_joint = self.parts.log_prior
        with np.errstate(divide="ignore"):
            for action, factor in factors.items():
                measured = self.network.actions[action].sensor.property
                log_joint = log_joint + self.parts.along(Table(np.log(factor), (measured,)))
        for group in groups:
            if group.touched:
                log_joint = log_joint + self.parts.along(group.log_evidence)
        return log_joint

    def _factor(self, action: str, evidence: Sequence[Observation]) -> Array:
        sensor = self.network.actions[action].sensor
        assert isinstance(sensor, ConfusionSensor)
        outcomes = [o.outcome for o in evidence if o.action == action]
        labels = [o.label for o in outcomes if isinstance(o, Label)]
        factor = sensor.likelihood(labels)
        for outcome in outcomes:
            if isinstance(outcome, StateLikelihood):
                factor = factor * outcome.values
        return factor

    def readings(self, measured: str, evidence: Sequence[Observation] | None = None) -> Readings:
        """The readings of a property, per action the sensor and the outcomes."""
        by_action: dict[str, list[NumberOutcome]] = {}
        for seen in self.evidence if evidence is None else evidence:
            if isinstance(seen.outcome, Reading | Above | Below):
                by_action.setdefault(seen.action, []).append(seen.outcome)
        actions = ((self.network.actions[name], outcomes) for name, outcomes in by_action.items())
        return [
            (a.sensor, o)
            for a, o in actions
            if not isinstance(a.sensor, ConfusionSensor) and a.sensor.property == measured
        ]

    def outcomes_of(self, action: str) -> list[NumberOutcome]:
        """The readings and bounds of one action so far."""
        return [
            o.outcome for o in self.evidence if o.action == action and isinstance(o.outcome, Reading | Above | Below)
        ]

    def labels_of(self, action: str) -> list[str]:
        """The labels of one action so far."""
        return [o.outcome.label for o in self.evidence if o.action == action and isinstance(o.outcome, Label)]

    @property
    def log_evidence_bits(self) -> float:
        """log2 of the probability of all evidence; densities per unit of the property, vectors scaled to maximum 1."""
        return self.log_evidence / float(np.log(2))

    # -- the belief -------------------------------------------------------------------------

    def probabilities(self, *properties: str) -> Array:
        """Joint probabilities of categorical properties, an axis each in the order given; they sum to one.

        Raises
        ------
        EvidenceError
            If the network has no such property, or one is not categorical.

        Examples
        --------
        >>> import palpate
        >>> belief = palpate.ExactBelief(palpate.load_network("household"))
        >>> belief.probabilities("category", "material").shape
        (10, 8)
        """
        for name in properties:
            if not isinstance(self.network.property(name), CategoricalProperty):
                categorical = choices(p.name for p in self.network.categorical)
                raise EvidenceError(
                    f"property {name!r} is not categorical and has no table of probabilities: {categorical}"
                )
        return self.categorical(properties).values

    def categorical(self, names: tuple[str, ...]) -> Table:
        """The joint table of some categorical properties."""
        if names not in self._joints:
            self._joints[names] = self.joint.sum_to(names)
        return self._joints[names]

    @cached_property
    def _marginals(self) -> dict[str, CategoricalMarginal | ContinuousMarginal]:
        return {}

    def marginal(self, property: str) -> CategoricalMarginal | ContinuousMarginal:
        """The belief about one property.

        Raises
        ------
        EvidenceError
            If the network has no such property.
        """
        if property not in self._marginals:
            known = self.network.property(property)
            if isinstance(known, CategoricalProperty):
                table = self.categorical((property,)).values
                self._marginals[property] = CategoricalMarginal(property, known.states, table)
            else:
                mesh, masses = self.mesh(property), self.masses(property)
                self._marginals[property] = ContinuousMarginal(property, known.unit, mesh, masses)
        return self._marginals[property]

    def mesh(self, name: str) -> Mesh:
        """The mesh of a continuous property in the chart that `masses` uses."""
        group = self.groups[self.parts.home[name]]
        return group.chart(group.sure_frame(name)).meshes[name]

    def masses(self, name: str) -> Array:
        """Probability at each node of a continuous property's mesh (K,)."""
        group = self.groups[self.parts.home[name]]
        return self.axis_masses(group, group.sure_frame(name), name)

    def axis_masses(self, group: GroupBelief, frame: Frame, name: str) -> Array:
        """Probability at each node of an axis of a chart (K,)."""
        key = (frame.axes, name)
        if key not in self._axis_masses:
            weights = per_mass(self.categorical(group.group.parents), group.mass(frame))
            self._axis_masses[key] = contract((weights, *group.reduced(frame, name)), (name,)).values
        return self._axis_masses[key]

    # -- questions --------------------------------------------------------------------------

    def expected_gains(
        self, objectives: Sequence[Objective] | None = None, actions: Sequence[str] | None = None
    ) -> Gains:
        """Expected information gain [bits] of actions about objectives.

        Mutual information of the action's outcome and the objective under the belief; never
        negative, the same for any unit.

        Parameters
        ----------
        objectives
            Properties, tuples of properties (all of them together) or ``"everything"``; every
            property and ``"everything"`` where None.
        actions
            Names of actions; all where None.

        Examples
        --------
        >>> import palpate
        >>> belief = palpate.ExactBelief(palpate.load_network("household"))
        >>> gains = belief.expected_gains(["material"])
        >>> max(gains, key=lambda action: gains[action]["material"])
        'mat-sound'
        """
        wanted = (*self.network.properties, EVERYTHING) if objectives is None else tuple(objectives)
        named = tuple(self.network.actions) if actions is None else tuple(actions)
        return expected_gains(self, wanted, named)

    def realised_gain(self, after: Self, objective: Objective) -> float | None:
        """KL(after || this belief) of the objective [bits], `after` being this belief and one outcome more."""
        return realised_gain(self, after, objective)

    def predict(self, action: str, sd: float | None = None) -> LabelPrediction | NumberPrediction:
        """The distribution of an action's outcome before it is taken; `sd` replaces the sensor's noise."""
        return predict(self, action, sd)

    def log2_predictive(self, action: str, outcome: Outcome | AdmittedOutcome) -> float:
        """log2 of the probability, or density per unit of the property, of an outcome; 0 for a failed one."""
        return self.update(action, outcome).log_evidence_bits - self.log_evidence_bits

    def surprise(self, action: str, outcome: Outcome | AdmittedOutcome) -> float | None:
        """Predictive probability of an outcome at least as unlikely as this one.

        None for vectors and failed readings. Labels: the sum over labels no more probable.
        Readings: min(1, 2 min(P(Y <= y), P(Y >= y))), saturated readings ranking outermost.
        """
        return surprise(self, action, outcome)

    def sample(self, n: int, rng: np.random.Generator) -> dict[str, Array | NDArray[np.str_]]:
        """n draws of all properties together; derived ones follow from the others."""
        return sample(self, n, rng)


def _impossible(last: Observation, number: int) -> ImpossibleEvidenceError:
    return ImpossibleEvidenceError(
        f"observation {number} ({last.action}: {last.outcome}) has probability zero under the network "
        "after the evidence before it: check the outcome, or the zeros in the tables it goes through"
    )
