from typing import Any

import numpy as np
import pytest

from palpate.selection.objectives import Everything
from palpate.selection.policies import Choice, FixedOrder, Greedy, GreedyPerCost, Random

COSTS = {"look": 1.0, "knock": 8.0, "weigh": 15.0, "think": 0.0}


def choice(gains: Any, taken: Any = (), seed: int = 0) -> Any:
    belief: Any = None
    return Choice(belief, Everything(), gains, COSTS, np.random.default_rng(seed), taken)


def test_greedy_takes_the_largest_gain() -> None:
    """Greedy takes the largest gain and, among equals, the first in order."""
    assert Greedy().choose(choice({"look": 0.2, "weigh": 1.5, "knock": 1.0})) == "weigh"
    assert Greedy().choose(choice({"look": 0.5, "weigh": 0.5})) == "look"


def test_greedy_per_cost_takes_the_largest_rate() -> None:
    """Gain per second decides, so that a cheap look comes before a dear weighing."""
    assert GreedyPerCost().choose(choice({"look": 0.2, "weigh": 1.5, "knock": 1.0})) == "look"
    assert GreedyPerCost().choose(choice({"weigh": 1.5, "knock": 0.7})) == "weigh"


def test_what_costs_nothing_comes_first_if_it_tells_anything() -> None:
    """An action without cost is worth more than any other as long as its gain is above zero."""
    assert GreedyPerCost().choose(choice({"look": 0.9, "think": 0.01})) == "think"
    assert GreedyPerCost().choose(choice({"look": 0.9, "think": 0.0})) == "look"


def test_random_is_repeatable_and_even() -> None:
    """The same seed gives the same choices; all actions are as likely."""
    gains = dict.fromkeys(COSTS, 0.1)
    first, again = choice(gains), choice(gains)
    drawn = [Random().choose(first) for _ in range(4000)]
    assert drawn[:50] == [Random().choose(again) for _ in range(50)]
    assert np.array([drawn.count(action) for action in COSTS]) == pytest.approx(1000, abs=150)


def test_fixed_order_passes_over_what_cannot_be_taken() -> None:
    """The order is followed; what is not to be had is passed over; at the end it wants nothing."""
    order = FixedOrder(["weigh", "look", "weigh"])
    everything = dict.fromkeys(COSTS, 0.1)
    assert order.choose(choice(everything)) == "weigh"
    assert order.choose(choice(everything, ("weigh",))) == "look"
    assert order.choose(choice(everything, ("weigh", "look"))) == "weigh"
    assert order.choose(choice(everything, ("weigh", "look", "weigh"))) is None
    assert order.choose(choice({"look": 0.1})) == "look"
