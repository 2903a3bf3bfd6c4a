import re
from dataclasses import replace

import numpy as np
import pytest

from palpate.errors import NetworkError
from palpate.inference.message_passing.graph import read_graph
from palpate.network.families import LogNormal
from palpate.network.properties import CategoricalProperty, ContinuousProperty, Property
from palpate.network.reading import load_network


def test_tables_are_shaped_by_their_ends_and_sum_to_one() -> None:
    """Each table is receiver x sender and its columns sum to one."""
    graph = read_graph(load_network("household"))
    size = {**graph.states, **{name: len(m.means) for name, m in graph.mixtures.items()}}
    assert len(graph.tables) == 4
    for (sender, receiver), table in graph.tables.items():
        assert table.shape == (size[receiver], size[sender])
        assert table.sum(axis=0) == pytest.approx(1)


def test_one_table_is_the_networks_own() -> None:
    """The table from category to material is P(material | category) of the network."""
    network = load_network("household")
    material = network.property("material")
    assert isinstance(material, CategoricalProperty)
    found = read_graph(network).tables["category", "material"].T
    assert found == pytest.approx(material.table, abs=1e-12)


def test_every_edge_that_messages_take_has_what_it_needs() -> None:
    """Between categorical neighbours, and from each density, there is a table."""
    graph = read_graph(load_network("household-filled"))
    for sender in graph.nodes:
        for receiver in graph.neighbours(sender):
            if receiver in graph.states and (sender in graph.states or receiver == "material"):
                assert (sender, receiver) in graph.tables


def coin(name: str) -> CategoricalProperty:
    return CategoricalProperty(name, ("heads", "tails"), (), np.array([0.5, 0.5]))


ONE = np.array(1.0)
HOUSEHOLD = load_network("household")
(DENSITY,) = (p for p in HOUSEHOLD.continuous if p.name == "density")
ODD = "property 'height' is not a mixture of normals over the states of its neighbour in the graph"


@pytest.mark.parametrize(
    ("odd", "found"),
    [
        (coin("category"), "property 'category' has other states than the tables"),
        (coin("colour"), "property 'colour' has other states than the tables"),
        (replace(DENSITY, unit="g/cm^3"), "property 'density' is not in kg/m^3"),
        (ContinuousProperty("height", "cm", (), LogNormal(ONE, ONE)), ODD),
        (replace(HOUSEHOLD.property("mass"), name="volume"), "property 'volume' is of another kind than its node"),
    ],
)
def test_a_network_with_another_graph_is_refused(odd: Property, found: str) -> None:
    """The error names the network, what differs, and the networks that fit."""
    network = replace(HOUSEHOLD, properties={**HOUSEHOLD.properties, odd.name: odd})
    expected = f"network 'household': {re.escape(found)}.*, but .* expected the network 'household' or"
    with pytest.raises(NetworkError, match=expected):
        read_graph(network)


def test_a_network_that_lacks_a_property_is_refused() -> None:
    """Another network is refused for the first property it lacks."""
    with pytest.raises(NetworkError, match="network 'pantry': it has no property 'category', but"):
        read_graph(load_network("pantry"))


def test_more_derived_properties_are_no_matter() -> None:
    """A network that only adds a derived property still fits the graph, which has no node for it."""
    loading = replace(HOUSEHOLD.property("mass"), name="loading")
    network = replace(HOUSEHOLD, properties={**HOUSEHOLD.properties, "loading": loading})
    assert set(read_graph(network).nodes) == {"category", "material", "elasticity", "density", "volume"}
