"""Messages and expected entropies on graphs of two and three nodes, worked out by hand."""

import math

import numpy as np
import pytest

from palpate.inference.message_passing.emulation import blurred, confused, expected_entropies
from palpate.inference.message_passing.graph import Graph
from palpate.inference.message_passing.messages import propagate
from palpate.inference.message_passing.mixture_fit import Mixture

TABLE = np.array([[0.9, 0.2], [0.1, 0.8]])
WIDE = np.array([[0.5, 0.2, 0.0], [0.5, 0.8, 1.0]])
CONFUSION = np.array([[0.8, 0.4], [0.2, 0.6]])
# so far apart that the components do not overlap
APART = Mixture.on_own_grid(np.array([0.0, 40.0]), np.array([1.0, 1.0]))


def h(p: float) -> float:
    """Entropy of a coin [bits]."""
    return float(-p * np.log2(p) - (1 - p) * np.log2(1 - p))


def no_fit(mixture: Mixture, density: np.ndarray) -> np.ndarray:
    raise AssertionError("no density sends a message here")


def pair() -> Graph:
    return Graph({"kind": ("stuff",)}, {"kind": 2, "stuff": 2}, {("kind", "stuff"): TABLE}, {})


def test_categorical_to_categorical_by_hand() -> None:
    """The message is T @ belief, the receiver its old belief x message, normalised."""
    (sent,) = propagate(pair(), {"kind": np.array([0.99, 0.01]), "stuff": np.array([0.25, 0.75])}, "kind", no_fit)
    assert (sent.sender, sent.receiver) == ("kind", "stuff")
    assert sent.message == pytest.approx([0.893, 0.107])
    assert sent.belief == pytest.approx([0.893 / (0.893 + 3 * 0.107), 3 * 0.107 / (0.893 + 3 * 0.107)])


def test_categorical_to_continuous_by_hand() -> None:
    """The message is the mixture with the sender's weights; times the prior it halves variances and keeps weights."""
    graph = Graph({"kind": ("length",)}, {"kind": 2}, {}, {"length": APART})
    (sent,) = propagate(graph, {**graph.prior, "kind": np.array([0.9, 0.1])}, "kind", no_fit)
    x, masses = APART.grid.nodes, APART.grid.masses(sent.belief)
    mean = masses @ x
    assert mean == pytest.approx(0.1 * 40, abs=1e-6)
    assert masses @ (x - mean) ** 2 == pytest.approx(0.5 + 0.9 * 0.1 * 40**2, rel=1e-6)


def test_continuous_to_categorical_by_hand() -> None:
    """The message is T @ weights of the fit to the sender's density."""
    graph = Graph({"stuff": ("length",)}, {"stuff": 2}, {("length", "stuff"): TABLE}, {"length": APART})
    beliefs = {"stuff": np.array([0.5, 0.5]), "length": graph.prior["length"]}
    (sent,) = propagate(graph, beliefs, "length", lambda mixture, density: np.array([0.6, 0.4]))
    assert sent.message == pytest.approx([0.62, 0.38])
    assert sent.belief == pytest.approx([0.62, 0.38])


def test_messages_go_breadth_first_over_children_then_parents_and_to_each_node_once() -> None:
    """The order is that of the graph, an edge that stands at both its ends is used once."""
    states = dict.fromkeys("abcd", 2)
    children = {"a": ("b",), "b": ("c", "a"), "d": ("b",)}
    edges = [("b", "c"), ("b", "a"), ("b", "d"), ("a", "b"), ("c", "b"), ("d", "b")]
    graph = Graph(children, states, dict.fromkeys(edges, TABLE), {})
    for start, order in (("b", "bc ba bd"), ("a", "ab bc bd"), ("d", "db bc ba")):
        assert " ".join(s.sender + s.receiver for s in propagate(graph, graph.prior, start, no_fit)) == order


def test_a_receiver_passes_on_its_new_belief() -> None:
    """Two steps away the message is made from the belief after the first message."""
    graph = Graph(
        {"a": ("b",), "b": ("c",)}, dict.fromkeys("abc", 2), {("a", "b"): TABLE, ("b", "c"): TABLE}, {}
    )  # fmt: skip
    first, second = propagate(graph, {**graph.prior, "a": np.array([1.0, 0.0])}, "a", no_fit)
    assert first.belief == pytest.approx([0.9, 0.1])
    assert second.message == pytest.approx([0.9 * 0.9 + 0.2 * 0.1, 0.1 * 0.9 + 0.8 * 0.1])


def test_expected_entropies_of_a_label_by_hand() -> None:
    """At the measured node the confusion's columns weighted by C b; at the receiver the table's by the message."""
    emulated = confused(CONFUSION, np.array([0.5, 0.5]))
    assert emulated[0] == pytest.approx([0.6, 0.4])
    found = expected_entropies(pair(), pair().prior, "kind", emulated, no_fit)
    assert found["kind"] == pytest.approx(0.6 * h(0.8) + 0.4 * h(0.4))
    assert found["stuff"] == pytest.approx(0.62 * h(0.9) + 0.38 * h(0.2))


def test_a_table_that_is_not_square_is_squared_for_its_entropies() -> None:
    """A 2 x 3 table is replaced by T T^t with columns scaled to one: the entropies are then one per receiver state."""
    graph = Graph({"kind": ("stuff",)}, {"kind": 3, "stuff": 2}, {("kind", "stuff"): WIDE}, {})
    # T T^t = [[0.29, 0.41], [0.41, 1.89]]
    assert graph.column_entropies("kind", "stuff") == pytest.approx([h(0.29 / 0.7), h(0.41 / 2.3)])
    found = expected_entropies(graph, graph.prior, "kind", (np.full(3, 1 / 3), 0.0), no_fit)
    first = 0.7 / 3
    assert found["stuff"] == pytest.approx(first * h(0.29 / 0.7) + (1 - first) * h(0.41 / 2.3))


@pytest.mark.parametrize(("times_belief", "variance"), [(False, 1 + 9.0), (True, 10.0 / 11)])
def test_expected_entropy_of_a_reading_by_hand(times_belief: bool, variance: float) -> None:
    """A normal of variance 1 blurred by one of 9 has variance 10; times itself before, 1 x 10 / 11."""
    single = Mixture.on_own_grid(np.array([0.0, 40.0]), np.array([4.0, 4.0]))
    graph = Graph({"kind": ("length",)}, {"kind": 2}, {}, {"length": single})
    density = np.exp(-0.5 * (single.grid.nodes - 20) ** 2) / np.sqrt(2 * np.pi)
    emulated, bits = blurred(graph, "length", density, 3.0, times_belief)
    assert bits == pytest.approx(0.5 * np.log2(2 * np.pi * math.e * variance), abs=1e-6)
    assert single.grid.integral(emulated) == pytest.approx(1)


def test_the_prior_lacks_what_lies_beyond_its_grid() -> None:
    """Uniform probabilities, and uniform mixtures as they are on the grid: a wide component is cut and not made up."""
    cut = Mixture.on_own_grid(np.array([0.0, 1.0]), np.array([1.0, 10.0]))
    graph = Graph({"kind": ("length",)}, {"kind": 2}, {}, {"length": cut})
    assert graph.prior["kind"] == pytest.approx([0.5, 0.5])
    below = 0.5 * 0.2742531  # of N(1, 10^2) below -5
    assert cut.grid.integral(graph.prior["length"]) == pytest.approx(1 - below, abs=1e-4)
