"""Objects that look alike and are not: which of the two was it, and where did it show."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from palpate.experiments.comparison.contest import objective_of
from palpate.experiments.running import Row
from palpate.experiments.tapes import Tape, TapeRobot
from palpate.explore import explore
from palpate.inference.exact import ExactBelief
from palpate.network.admission import AdmittedOutcome, admit
from palpate.network.model import KnownObject, Network
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Above, Below, Label, Outcome, Reading
from palpate.selection.policies import GreedyPerCost
from palpate.selection.stopping import NothingLeft

__all__ = ["PAIRS", "evidence_bits", "partner_of", "telling_rows"]

PAIRS = "pairs"
"""The world of rows about telling look-alikes apart."""


def partner_of(network: Network, thing: str) -> KnownObject | None:
    """The object that one looks like, or that looks like it; None where there is none.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> partner_of(load_network("household"), "wineglass").name
    'wineglass_ycb'
    """
    known = network.object(thing)
    if known.looks_like is not None:
        return network.object(known.looks_like)
    return next((other for other in network.objects.values() if other.looks_like == thing), None)


def evidence_bits(network: Network, action: str, outcome: Outcome, thing: KnownObject, other: KnownObject) -> float:
    """log2 of how much more probable an outcome is of one object than of another, by the sensor model.

    0 where the action failed, or what it measures is not known of both.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> network = load_network("household")
    >>> glass, plastic = (network.object(name) for name in ("wineglass", "wineglass_ycb"))
    >>> evidence_bits(network, "weighing", Reading(133.0), plastic, glass) > 5
    True
    """
    measured = network.action(action).sensor.property
    values = [one.truth.get(measured) for one in (thing, other)]
    admitted = admit(network, action, outcome).outcome
    if any(value is None or not value.scored for value in values):
        return 0.0
    own, others = (_log_p(network, action, admitted, value.value) for value in values if value is not None)
    return (own - others) / math.log(2)


def _log_p(network: Network, action: str, outcome: AdmittedOutcome, truth: str | float) -> float:
    sensor = network.action(action).sensor
    if isinstance(sensor, ConfusionSensor):
        states = network.property(sensor.property)
        assert isinstance(states, CategoricalProperty)
        if not isinstance(outcome, Label):
            return 0.0
        return math.log(max(float(sensor.likelihood([outcome.label])[states.states.index(str(truth))]), 1e-12))
    if not isinstance(outcome, Reading | Above | Below):
        return 0.0
    return float(sensor.log_likelihood([outcome], np.array([float(truth)]))[0])


def telling_rows(network: Network, tape: Tape) -> Iterator[Row]:
    """A row for each step of an exploration: how surprising it was, and what it says for the right of the two.

    Actions are chosen by their gain per cost, so that a robot looks before it touches: it is then that a trick works.
    """
    thing, other = network.object(tape.object), partner_of(network, tape.object)
    assert other is not None
    about: Row = {"world": PAIRS, "method": "exact-per-cost", "object": tape.object, "repetition": tape.repetition}
    steps = explore(
        ExactBelief(network),
        TapeRobot(tape),
        objective=objective_of(network),
        policy=GreedyPerCost(),
        stopping=NothingLeft(),
    )
    for step in steps:
        if step.action is not None:
            bits = evidence_bits(network, step.action, tape.outcomes[step.action], thing, other)
            told: Row = {"used": step.action, "surprise": step.surprise, "pair_bits": bits}
            yield {**about, "weight": 1.0, "trick": tape.trick, "step": step.index, **told}
