"""Objectives as inference sees them: which tables and which axes stand for a set of properties."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from palpate.errors import EvidenceError, choices
from palpate.inference.belief import EVERYTHING, Objective
from palpate.inference.group import Group
from palpate.inference.readings import GroupBelief
from palpate.network.model import Network

__all__ = ["Target"]


class Target:
    """An objective taken apart.

    Attributes
    ----------
    categorical
        Its categorical properties.
    partial
        Members of groups of which it fixes some only: axes of one chart of their group.
    whole
        Groups of which it fixes all members.
    fixed
        All properties that it fixes, named or not.
    """

    def __init__(self, network: Network, groups: Sequence[Group], objective: Objective) -> None:
        names = (objective,) if isinstance(objective, str) else objective
        wanted = set(network.properties) if EVERYTHING in names else {network.property(n).name for n in names}
        if not wanted:
            raise EvidenceError(f"an objective names no property: {choices([*network.properties, EVERYTHING])}")
        self.categorical = tuple(p.name for p in network.categorical if p.name in wanted)
        self.partial: tuple[str, ...] = ()
        self.whole: tuple[int, ...] = ()
        self.fixed = set(self.categorical)
        for number, group in enumerate(groups):
            self._take(number, group, tuple(m for m in group.members if m in wanted))

    def _take(self, number: int, group: Group, names: tuple[str, ...]) -> None:
        """Take in what the objective names of a group."""
        if not names:
            return
        rank = group.rank(names)
        if rank == len(group.bases):
            self.whole += (number,)
            self.fixed |= set(group.members)
            return
        chosen = next((c for c in combinations(names, rank) if group.frame(c) is not None), None)
        if chosen is None:
            raise EvidenceError(
                f"an objective of {', '.join(names)} together cannot be worked out, as their formulas cannot be "
                "solved for each other: choose fewer of them"
            )
        self.partial += chosen
        self.fixed |= {m for m in group.members if group.rank((*names, m)) == rank}

    def members(self, groups: Sequence[GroupBelief]) -> tuple[str, ...]:
        """The axes that stand for its continuous properties, in charts that suit the groups' evidence."""
        return (*self.partial, *(axis for number in self.whole for axis in groups[number].sure_frame().axes))
