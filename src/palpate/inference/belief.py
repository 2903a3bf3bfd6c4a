"""What every engine answers: the belief of an object's properties given evidence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, Self

import numpy as np
from numpy.typing import NDArray

from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.network.admission import AdmittedOutcome
from palpate.network.model import Network
from palpate.outcomes import Outcome

__all__ = ["EVERYTHING", "Belief", "Gains", "Objective", "Observation"]

EVERYTHING = "everything"
"""The objective of all properties together."""

Objective = str | tuple[str, ...]
"""A property, several together, or `EVERYTHING`."""

Gains = Mapping[str, Mapping[Objective, float | None]]
"""Action to objective to expected information gain [bits]; None where an engine cannot say."""


@dataclass(frozen=True, eq=False)
class Observation:
    """One piece of evidence: an action and what it returned, admitted."""

    action: str
    outcome: AdmittedOutcome


class Belief(Protocol):
    """A belief is a value: updating gives a new one and leaves the old one as it was."""

    @property
    def network(self) -> Network:
        """The network believed in."""

    @property
    def evidence(self) -> tuple[Observation, ...]:
        """All outcomes so far, failed ones too."""

    def update(self, action: str, outcome: Outcome | AdmittedOutcome) -> Self:
        """The belief after one more outcome."""

    def probabilities(self, *properties: str) -> NDArray[np.float64]:
        """Joint probabilities of categorical properties, an axis each in the order given; they sum to one."""

    def marginal(self, property: str) -> CategoricalMarginal | ContinuousMarginal:
        """The belief about one property."""

    def expected_gains(
        self, objectives: Sequence[Objective] | None = None, actions: Sequence[str] | None = None
    ) -> Gains:
        """Expected information gain of actions about objectives [bits]."""

    def realised_gain(self, after: Self, objective: Objective) -> float | None:
        """KL(after || this belief) of the objective [bits], `after` being this belief and one outcome more."""

    def predict(self, action: str, sd: float | None = None) -> LabelPrediction | NumberPrediction:
        """The distribution of an action's outcome before it is taken."""

    def log2_predictive(self, action: str, outcome: Outcome | AdmittedOutcome) -> float | None:
        """log2 of the probability, or density per unit of the property, of an outcome before it is used."""

    def surprise(self, action: str, outcome: Outcome | AdmittedOutcome) -> float | None:
        """Predictive probability of an outcome at least as unlikely as this one; None for vectors and failures."""

    def sample(self, n: int, rng: np.random.Generator) -> Mapping[str, NDArray[np.float64] | NDArray[np.str_]]:
        """n draws of all properties together."""
