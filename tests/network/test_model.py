"""The network's own questions: names, counts, added actions."""

import pytest

from palpate.errors import EvidenceError, NetworkError
from palpate.network.model import Action, KnownObject, TrueValue
from palpate.network.reading import load_network
from palpate.network.sensors import NumberSensor


def test_properties_by_kind_keep_the_order_of_the_file() -> None:
    """Categorical, continuous and derived properties are listed in the order of the file."""
    network = load_network("household")
    assert [p.name for p in network.categorical] == ["category", "material"]
    assert [p.name for p in network.continuous] == ["elasticity", "density", "volume"]
    assert [p.name for p in network.derived] == ["mass"]
    assert network.joint_states == 80


@pytest.mark.parametrize("ask", ["action", "property", "object"])
def test_unknown_names_list_the_valid_ones(ask: str) -> None:
    """Asking for a name that is not there says which are."""
    network = load_network("pantry")
    with pytest.raises(EvidenceError, match=f"unknown {ask} 'nothing'.*choose from"):
        getattr(network, ask)("nothing")


def test_with_action_adds_one_and_leaves_the_network_alone() -> None:
    """A network with one more action is another network."""
    network = load_network("household")
    more = network.with_action(Action("tapping", 3.0, NumberSensor("elasticity", sd=20.0)))
    assert [*more.actions] == [*network.actions, "tapping"]
    assert "tapping" not in network.actions


def test_with_action_refuses_an_unknown_property() -> None:
    """An action that measures what the network does not have is an error with the valid choices."""
    with pytest.raises(NetworkError, match=r"unknown property 'hue'.*'elasticity'"):
        load_network("household").with_action(Action("look", 1.0, NumberSensor("hue", sd=1.0)))


def test_unknown_true_values_are_not_scored_and_look_alikes_are_tricks() -> None:
    """A stand-in is simulated and not scored; what looks like another object is a trick."""
    assert not TrueValue("foam", "unknown").scored
    assert TrueValue("foam", "assumed").scored
    assert KnownObject("a", "", {}, looks_like="b").is_trick
    assert not KnownObject("a", "", {}).is_trick
