"""Message passing given its best case: for a label the vector of how probable each state makes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from palpate.inference.belief import Belief
from palpate.inference.message_passing.belief import MessagePassingBelief
from palpate.inference.message_passing.settings import Settings
from palpate.network.admission import AdmittedOutcome, admit
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Label, Likelihood, Outcome

__all__ = ["VectorFed", "VectorFedBelief"]


class VectorFedBelief(MessagePassingBelief):
    """A message-passing belief that reads a label as the row of the confusion matrix, C[o, :] / sum.

    As published, the outcome vector of a label is one-hot: the method then takes its classifier for
    right. The row is what the label says of the states, so this is the best that it can be given.

    Examples
    --------
    >>> import palpate
    >>> belief = VectorFedBelief(palpate.load_network("household"))
    >>> after = belief.update("cat-vision", palpate.Label("mug"))
    >>> bool(after.probabilities("category").max() < 0.9)
    True
    """

    def update(self, action: str, outcome: Outcome | AdmittedOutcome) -> Self:
        """The belief after one more outcome."""
        admitted = admit(self.network, action, outcome).outcome
        if isinstance(admitted, Label):
            return super().update(action, self._row(action, admitted.label))
        return super().update(action, admitted)

    def _row(self, action: str, label: str) -> Likelihood:
        sensor = self.network.action(action).sensor
        assert isinstance(sensor, ConfusionSensor)
        measured = self.network.property(sensor.property)
        assert isinstance(measured, CategoricalProperty)
        row = sensor.table[sensor.outcomes.index(label)]
        return Likelihood(dict(zip(measured.states, row.tolist(), strict=True)))


@dataclass(frozen=True)
class VectorFed:
    """The engine of `VectorFedBelief`."""

    settings: Settings

    @property
    def name(self) -> str:
        """What stands in tables."""
        return "best-case"

    @property
    def order_matters(self) -> bool:
        """True, as for all message passing."""
        return True

    def prior(self, network: Network, seed: int) -> Belief:
        """The belief without evidence."""
        return VectorFedBelief(network, self.settings, seed)
