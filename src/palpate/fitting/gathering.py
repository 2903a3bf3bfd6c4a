"""Gathers specimens while rows come in, and counts what was decided about them."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator

from palpate.errors import plural
from palpate.fitting.data import Data, Source, Specimen, Truth, completed
from palpate.network.admission import AdmittedOutcome
from palpate.network.model import Network
from palpate.outcomes import Failed

__all__ = ["Gathered"]

MOST_OBJECTS = 5
"""On so many objects the failures of an action are told one by one."""


class Gathered:
    """Specimens in the making."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self._truth: dict[str, Truth] = {}
        self._readings: dict[str, dict[str, list[AdmittedOutcome]]] = defaultdict(lambda: defaultdict(list))
        self._failed: dict[str, dict[str, list[str]]] = defaultdict(dict)
        self._told: Counter[str] = Counter()

    def tell(self, notice: str, times: int = 1) -> None:
        """Note a decision; decisions in the same words are counted."""
        self._told[notice] += times

    def know(self, name: str, truth: Truth) -> None:
        """What is known of an object."""
        self._truth[name], odd = completed(self.network, truth)
        for notice in odd:
            self.tell(notice)

    def measure(self, name: str, action: str, outcome: AdmittedOutcome) -> None:
        """What an action gave on an object."""
        if isinstance(outcome, Failed):
            self._failed[action].setdefault(name, []).append(outcome.reason)
        else:
            self._readings[name][action].append(outcome)

    def data(self, sources: Iterable[Source]) -> Data:
        """All specimens."""
        names = {*self._truth, *self._readings}
        readings = {name: {a: tuple(got) for a, got in self._readings[name].items()} for name in names}
        specimens = [Specimen(name, self._truth.get(name, {}), readings[name]) for name in names]
        told = [f"{notice} ({times} times)" if times > 1 else notice for notice, times in self._told.items()]
        return Data.of(specimens, sources, sorted([*told, *self._failures()]))

    def _failures(self) -> Iterator[str]:
        """Of each action, on which objects it failed, how often, and why at first."""
        for action, objects in self._failed.items():
            often = sorted(objects.items(), key=lambda item: -len(item[1]))
            for name, reasons in often[:MOST_OBJECTS]:
                first = next(filter(None, reasons), "no reason was given")
                many = f" {len(reasons)} times, at first" if len(reasons) > 1 else ""
                yield f"{action}: failed on {name}{many} with: {first}; left out"
            rest = often[MOST_OBJECTS:]
            if rest:
                times = sum(len(reasons) for _, reasons in rest)
                yield f"{action}: failed on {plural(len(rest), 'more object')}, {plural(times, 'time')}; left out"
