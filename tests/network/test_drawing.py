"""The graph of a network as edges and as Graphviz text."""

import re
from dataclasses import replace

import pytest

from palpate.network.drawing import dot, edges
from palpate.network.reading import load_network, shipped_networks
from palpate.network.sensors import NumberSensor


def test_edges_of_the_household() -> None:
    """Parents, inputs of formulas and measured properties are the edges, and nothing else is."""
    assert set(edges(load_network("household"))) == {
        ("category", "material"),
        ("category", "volume"),
        ("material", "elasticity"),
        ("material", "density"),
        ("density", "mass"),
        ("volume", "mass"),
        ("category", "action:cat-vision"),
        ("material", "action:mat-vision"),
        ("material", "action:mat-sound"),
        ("elasticity", "action:squeezing"),
        ("mass", "action:weighing"),
    }


@pytest.mark.parametrize("name", shipped_networks())
def test_every_edge_and_node_stands_in_the_text(name: str) -> None:
    """The text has a line for each node and each edge, and its braces close."""
    network = load_network(name)
    lines = dot(network).splitlines()
    assert (lines[0], lines[-1]) == ("digraph {", "}")
    assert sum(" -> " in line for line in lines) == len(edges(network))
    nodes = {match[1] for line in lines if (match := re.match(r'  "([^"]*)" \[', line))}
    assert nodes == {*network.properties, *(f"action:{action}" for action in network.actions)}


def test_names_are_escaped() -> None:
    """Quotes and backslashes in a name cannot break out of its string."""
    network = load_network("household")
    odd = 'a "b" \\'
    action = replace(network.actions["weighing"], name=odd, sensor=NumberSensor("mass", sd=1.0))
    text = dot(network.with_action(action))
    assert '"mass" -> "action:a \\"b\\" \\\\";' in text
