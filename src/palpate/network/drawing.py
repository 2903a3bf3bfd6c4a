"""A network as a graph: nodes and edges, and their Graphviz text."""

from __future__ import annotations

from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, DerivedProperty, Property

__all__ = ["dot", "edges"]


def edges(network: Network) -> list[tuple[str, str]]:
    """The edges of the graph, from cause to effect, as names of nodes.

    Actions are nodes as ``action:NAME``, as an action may have the name of a property.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> edges(load_network("household"))[-2:]
    [('elasticity', 'action:squeezing'), ('mass', 'action:weighing')]
    """
    found = [(parent, p.name) for p in network.properties.values() for parent in _causes(p)]
    return found + [(a.sensor.property, f"action:{a.name}") for a in network.actions.values()]


def _causes(prop: Property) -> tuple[str, ...]:
    return prop.formula.variables if isinstance(prop, DerivedProperty) else prop.parents


def dot(network: Network) -> str:
    """The network in Graphviz' DOT language.

    Categorical properties are boxes, continuous ones ellipses, derived ones dashed ellipses,
    actions grey tabs with their cost.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> print(dot(load_network("household")).splitlines()[1])
      label="household";
    """
    lines = [f"  label={_quoted(network.name)};", "  node [fontname=sans];"]
    lines += [f"  {_quoted(p.name)} [{_style(p)}];" for p in network.properties.values()]
    for action in network.actions.values():
        node, label = _quoted(f"action:{action.name}"), _quoted(f"{action.name}\n{action.cost_s:g} s")
        lines.append(f"  {node} [label={label}, shape=tab, style=filled];")
    lines += [f"  {_quoted(start)} -> {_quoted(end)};" for start, end in edges(network)]
    return "\n".join(["digraph {", *lines, "}"])


def _style(prop: Property) -> str:
    if isinstance(prop, CategoricalProperty):
        label = _quoted(f"{prop.name}\n{len(prop.states)} states")
        return f"label={label}, shape=box"
    label = _quoted(f"{prop.name} [{prop.unit}]")
    return f"label={label}" + (", style=dashed" if isinstance(prop, DerivedProperty) else "")


def _quoted(text: str) -> str:
    """A quoted DOT string; a line break in the text is one in the label."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'
