"""Worlds draw the same objects and outcomes however the work is divided."""

import pickle

import numpy as np
import pytest

import palpate
from palpate.experiments.comparison.worlds import World, dealt_costs, drawn_objects, worlds

NETWORK = palpate.load_network("household-filled")


@pytest.mark.parametrize("world", worlds(), ids=lambda world: world.name)
def test_tapes_do_not_depend_on_the_division_of_work(world: World) -> None:
    """Objects 2 and 3 are the same whether they are drawn alone or with the others, also in another process."""
    whole = world.tapes(4, seed=7, start=0, stop=4)
    again = pickle.loads(pickle.dumps(world)).tapes(4, seed=7, start=2, stop=4)
    assert again == whole[2:]
    assert set(whole[0].outcomes) == set(NETWORK.actions)


def test_drawn_objects_follow_the_prior() -> None:
    """Frequencies of drawn states are those of the prior within four standard errors."""
    things = drawn_objects(NETWORK, 4000, seed=1)
    prior = palpate.ExactBelief(NETWORK).probabilities("material")
    for state, p in zip(NETWORK.categorical[1].states, prior, strict=True):
        share = np.mean([thing.truth["material"].value == state for thing in things])
        assert abs(share - p) < 4 * np.sqrt(p * (1 - p) / 4000)


def test_a_tenth_of_the_outcomes_are_outliers() -> None:
    """Against the tapes without outliers, at most a tenth of the outcomes differ, and some do."""
    plain = World("w", "").tapes(150, seed=3, start=0, stop=150)
    strange = World("w", "", outliers=0.1).tapes(150, seed=3, start=0, stop=150)
    differ = [
        a.outcomes[action] != b.outcomes[action] for a, b in zip(plain, strange, strict=True) for action in a.outcomes
    ]
    assert 0.03 < np.mean(differ) < 0.13
    assert [tape.truth for tape in plain] == [tape.truth for tape in strange]


def test_stand_ins_are_not_truths() -> None:
    """Of known objects only what is known is scored, and tricks are marked."""
    (known,) = (world for world in worlds() if world.known_objects)
    tapes = {tape.object: tape for tape in known.tapes(17, seed=0, start=0, stop=17)}
    assert "material" not in tapes["banana"].truth
    assert tapes["banana_ycb"].trick
    assert not tapes["banana"].trick


def test_dealt_costs_are_the_same_costs() -> None:
    """Costs are dealt anew, none is new, and what tells most is dearest."""
    costs = dealt_costs(NETWORK)
    assert sorted(costs.values()) == sorted(action.cost_s for action in NETWORK.actions.values())
    gains = palpate.ExactBelief(NETWORK).expected_gains([("category", "material")])
    best = max(gains, key=lambda action: gains[action]["category", "material"] or 0.0)
    assert costs[best] == max(costs.values())
