"""Objectives as inference sees them: which tables and which axes stand for a set of properties."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from palpate.errors import EvidenceError, choices
from palpate.inference.belief import EVERYTHING, Objective
from palpate.inference.group import Group
from palpate.network.model import Network

__all__ = ["Target"]


class Target:
    """An objective taken apart: categorical properties, and per group the axes that stand for its members."""

    def __init__(self, network: Network, groups: Sequence[Group], objective: Objective) -> None:
        names = (objective,) if isinstance(objective, str) else objective
        self.everything = EVERYTHING in names
        wanted = set(network.properties) if self.everything else {network.property(n).name for n in names}
        if not wanted:
            raise EvidenceError(f"an objective names no property: {choices([*network.properties, EVERYTHING])}")
        self.categorical = tuple(p.name for p in network.categorical if p.name in wanted)
        self.members: tuple[str, ...] = ()
        self.fixed = set(self.categorical)
        for group in groups:
            chosen, fixed = _reduced(group, tuple(m for m in group.members if m in wanted))
            self.members += chosen
            self.fixed |= fixed


def _reduced(group: Group, names: tuple[str, ...]) -> tuple[tuple[str, ...], set[str]]:
    """Members of a group that say as much as the named ones, and all members that they fix."""
    full = [m for m in group.members if m in names]
    for count in range(len(full), 0, -1):
        chosen = _independent(group, tuple(full), count)
        if chosen is not None:
            fixed = set(group.members) if count == len(group.bases) else _followers(group, set(full))
            return chosen, fixed
    return (), set()


def _independent(group: Group, names: tuple[str, ...], count: int) -> tuple[str, ...] | None:
    return next((c for c in combinations(names, count) if group.frame(c) is not None), None)


def _followers(group: Group, known: set[str]) -> set[str]:
    return known | {name for name, d in group.derived.items() if set(d.formula.variables) <= known}
