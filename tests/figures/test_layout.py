"""The layered layout, on random graphs without cycles."""

from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.figures.layout import layered


@st.composite
def graphs(draw: st.DrawFn) -> tuple[list[str], list[tuple[str, str]]]:
    nodes = [f"n{i}" for i in range(draw(st.integers(1, 9)))]
    pairs = [(a, b) for i, a in enumerate(nodes) for b in nodes[i + 1 :]]
    edges = draw(st.lists(st.sampled_from(pairs), unique=True)) if pairs else []
    return nodes, edges


@settings(max_examples=15, deadline=None)
@given(graphs())
def test_effects_lie_below_causes_and_nodes_apart(graph: tuple[list[str], list[tuple[str, str]]]) -> None:
    """Every edge goes down, and nodes of a layer are at least 1 apart."""
    nodes, edges = graph
    layout = layered(nodes, edges)
    assert set(layout.nodes) == set(nodes)
    assert all(layout.nodes[start][1] < layout.nodes[end][1] for start, end in edges)
    for layer in {y for _, y in layout.nodes.values()}:
        row = sorted(x for x, y in layout.nodes.values() if y == layer)
        assert all(right - left > 1 - 1e-9 for left, right in pairwise(row))


@settings(max_examples=15, deadline=None)
@given(graphs())
def test_edges_run_from_node_to_node(graph: tuple[list[str], list[tuple[str, str]]]) -> None:
    """An edge's points begin and end at its nodes and go down one layer at a time."""
    nodes, edges = graph
    layout = layered(nodes, edges)
    assert set(layout.edges) == set(edges)
    for (start, end), points in layout.edges.items():
        assert (points[0], points[-1]) == (layout.nodes[start], layout.nodes[end])
        assert all(below[1] == above[1] + 1 for above, below in pairwise(points))
