from math import inf
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from palpate.errors import EvidenceError
from palpate.network.families import LogNormal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.selection.stopping import (
    AnyOf,
    CostBudget,
    EntropyBelow,
    GainBelow,
    NetGainBelow,
    NothingLeft,
    SdBelow,
    Situation,
    StepBudget,
    StoppingRule,
)

COSTS = {"look": 1.0, "weigh": 15.0}
NETWORK = Network(
    "toy",
    {
        "stuff": CategoricalProperty("stuff", ("oak", "clay"), (), np.full(2, 0.5)),
        "weight": ContinuousProperty("weight", "g", (), LogNormal(np.array(50.0), np.array(0.5))),
    },
    {},
)


def situation(gains: Any = None, *, entropy: Any = 1.0, sd: Any = 10.0, **rest: Any) -> Any:
    marginals = {"stuff": SimpleNamespace(entropy_bits=entropy), "weight": SimpleNamespace(entropy_bits=3.0, sd=sd)}
    belief = SimpleNamespace(network=NETWORK, marginal=marginals.__getitem__)
    return Situation(belief, {"look": 0.2, "weigh": 0.4} if gains is None else gains, COSTS, **rest)


@pytest.mark.parametrize(
    ("rule", "goes_on", "stops"),
    [
        (GainBelow(0.3), situation(), situation({"look": 0.2, "weigh": 0.29})),
        (GainBelow(), situation({"look": 0.05}), situation({"look": 0.04999})),
        (NetGainBelow(0.02), situation(), situation({"look": 0.02, "weigh": 0.3})),
        (EntropyBelow("stuff", 0.5), situation(), situation(entropy=0.5)),
        (SdBelow("weight", 5.0), situation(), situation(sd=5.0)),
        (CostBudget(20.0), situation(spent_s=19.0), situation({}, spent_s=19.0, too_dear=("weigh",))),
        (StepBudget(2), situation(taken=("look",)), situation(taken=("look", "look"))),
        (NothingLeft(), situation(), situation({})),
    ],
)
def test_each_rule_stops_when_it_should(rule: Any, goes_on: Any, stops: Any) -> None:
    """A rule goes on on one side of its threshold and stops, with a reason, on the other."""
    assert rule.reason(goes_on) is None
    assert isinstance(rule.reason(stops), str)


def test_gain_rules_say_nothing_where_nothing_is_left() -> None:
    """Without any action left there is no best gain to compare."""
    assert GainBelow().reason(situation({})) is None
    assert NetGainBelow(1.0).reason(situation({})) is None


def test_targets_are_for_their_kind_of_property() -> None:
    """Entropy targets are for categorical properties and SD targets for continuous ones."""
    with pytest.raises(EvidenceError, match="'weight' has an SD target"):
        EntropyBelow("weight", 1.0).reason(situation())
    with pytest.raises(EvidenceError, match="'stuff' has an entropy target"):
        SdBelow("stuff", 1.0).reason(situation())
    with pytest.raises(EvidenceError, match="unknown property 'colour'"):
        SdBelow("colour", 1.0).reason(situation())


def test_rules_compose() -> None:
    """Rules joined by | stop with the first reason, in one flat rule with the smallest budget."""
    rule = GainBelow(0.01) | CostBudget(60.0) | (StepBudget(1) | CostBudget(30.0))
    assert rule == AnyOf((GainBelow(0.01), CostBudget(60.0), StepBudget(1), CostBudget(30.0)))
    assert rule.budget_s == 30.0
    assert rule.reason(situation()) is None
    assert rule.reason(situation(taken=("look",))) == "the budget of 1 steps is used up"
    assert GainBelow().budget_s == inf


def test_a_rule_of_ones_own_needs_one_method() -> None:
    """Whoever inherits from StoppingRule and says a reason can be composed."""

    class Never(StoppingRule):
        def reason(self, situation: Situation) -> Any:
            return None

    assert (Never() | StepBudget(0)).reason(situation()) == "the budget of 0 steps is used up"


def test_budgets_of_steps_compose() -> None:
    """The smallest number of steps counts; other rules leave it open."""
    assert GainBelow().most_steps == inf
    assert (GainBelow() | StepBudget(4) | StepBudget(3) | CostBudget(9.0)).most_steps == 3
    assert AnyOf(()).most_steps == inf
