"""What a belief says of an outcome: its distribution before it is seen, and how surprising it was."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from palpate.errors import ImpossibleEvidenceError
from palpate.inference.predictions import LabelPrediction, NumberPrediction
from palpate.network.admission import AdmittedOutcome, admit
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Above, Below, Label, Outcome, Reading

if TYPE_CHECKING:
    from palpate.inference.exact import ExactBelief

__all__ = ["predict", "surprise"]

SURE = 1 - 1e-6


def predict(belief: ExactBelief, action: str, sd: float | None) -> LabelPrediction | NumberPrediction:
    """The distribution of an action's outcome, as `ExactBelief.predict` gives it."""
    sensor = belief.network.action(action).sensor
    if isinstance(sensor, ConfusionSensor):
        table = sensor.predictive(belief.labels_of(action))
        return LabelPrediction(sensor.outcomes, np.asarray(table @ belief.categorical((sensor.property,)).values))
    mesh, masses = belief.mesh(sensor.property), belief.masses(sensor.property)
    nodes, finer = mesh.nodes, mesh.finer(sensor.scale(mesh.nodes, sd))
    if finer is not None:
        nodes, masses = finer.spread(masses)
    kernel = sensor.predictive(belief.outcomes_of(action), nodes, sd)
    return NumberPrediction(kernel, masses, sensor.low, sensor.high)


def surprise(belief: ExactBelief, action: str, outcome: Outcome | AdmittedOutcome) -> float | None:
    """How surprising an outcome is, as `ExactBelief.surprise` gives it."""
    admitted = admit(belief.network, action, outcome).outcome
    match admitted:
        case Label(label):
            prediction = belief.predict(action)
            assert isinstance(prediction, LabelPrediction)
            p = prediction.probabilities
            seen = p[prediction.outcomes.index(label)]
            return float(min(1.0, p[p <= seen * (1 + 1e-9)].sum()))
        case Reading(value, sd):
            below = _tail(belief, action, Below(value, sd))
            # The other tail by subtraction, but where that would cancel.
            above = 1 - below if below < SURE else _tail(belief, action, Above(value, sd))
            return min(1.0, 2 * min(below, above))
        case Above() | Below():
            return min(1.0, 2 * _tail(belief, action, admitted))
    return None


def _tail(belief: ExactBelief, action: str, bound: Above | Below) -> float:
    try:
        return float(2.0 ** belief.log2_predictive(action, bound))
    except ImpossibleEvidenceError:
        return 0.0
