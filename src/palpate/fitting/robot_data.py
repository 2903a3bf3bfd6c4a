"""Data from a robot: what its actions gave on objects that a network knows."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256

from palpate.errors import EvidenceError, choices
from palpate.evidence import format_item
from palpate.fitting.data import Data, Source
from palpate.fitting.errors import FittingError
from palpate.fitting.gathering import Gathered
from palpate.network.admission import admit
from palpate.network.model import KnownObject, Network
from palpate.outcomes import Failed, Label, Likelihood, Outcome, Posterior

__all__ = ["Measured", "most_probable", "read_outcomes"]


@dataclass(frozen=True, slots=True)
class Measured:
    """What an action gave on an object."""

    thing: str
    action: str
    outcome: Outcome


def most_probable(outcome: Outcome) -> Outcome:
    """The outcome with the most probable label in place of a vector: sensor models are about labels.

    Examples
    --------
    >>> most_probable(Posterior({"glass": 0.7, "paper": 0.3}))
    Label(label='glass')
    """
    match outcome:
        case Posterior(values) | Likelihood(values) if values:
            return Label(max(values, key=values.__getitem__))
    return outcome


def read_outcomes(
    network: Network, known: Mapping[str, KnownObject], measured: Iterable[Measured], source: str
) -> Data:
    """Make data of what a robot measured.

    The truth is that of known objects, without stand-ins. What an action that sees the appearance gave on an object
    that looks like another one is left out: it saw the other one. What cannot be used is told in the notices.

    Parameters
    ----------
    network
        Whose sensors are to be fitted.
    known
        Objects by name.
    source
        Which robot measured, in words.

    Raises
    ------
    FittingError
        An object is not known.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> from palpate.outcomes import Reading
    >>> household = load_network("household")
    >>> weighed = Measured("banana", "weighing", Reading(118.0))
    >>> data = read_outcomes(household, household.objects, [weighed], "a scale")
    >>> data.specimens[0].truth["mass"], data.specimens[0].readings
    (120.0, {'weighing': (Reading(value=118.0, sd=None, unit=None),)})
    """
    gathered, lines, things = Gathered(network), list[str](), dict[str, KnownObject]()
    outcomes: dict[str, list[Outcome]] = {}
    for one in measured:
        if one.thing not in known:
            raise FittingError(f"object {one.thing!r} is not known; {choices(known)}")
        things[one.thing] = known[one.thing]
        lines.append(json.dumps({"object": one.thing, **format_item(one.action, one.outcome)}, sort_keys=True))
        outcomes.setdefault(one.action, []).append(one.outcome)
        _take(gathered, known[one.thing], one.action, one.outcome)
    for action, found in outcomes.items():
        _tell_failures(gathered, action, found)
    hashed = sha256("\n".join(sorted(lines)).encode()).hexdigest()
    for name, thing in things.items():
        truth = {key: true.value for key, true in thing.truth.items() if true.scored and key in network.properties}
        gathered.know(name, truth)
    return gathered.data([Source("robot", source, hashed, len(lines))])


def _tell_failures(gathered: Gathered, action: str, outcomes: Sequence[Outcome]) -> None:
    """Say why an action failed that mostly did: something about it, and not about an object, is wrong."""
    failed = [outcome for outcome in outcomes if isinstance(outcome, Failed)]
    if 2 * len(failed) > len(outcomes):
        gathered.tell(f"{action}: failed {len(failed)} of {len(outcomes)} times, at first with: {failed[0].reason}")


def _take(gathered: Gathered, thing: KnownObject, action: str, outcome: Outcome) -> None:
    network = gathered.network
    if action not in network.actions:
        gathered.tell(f"results of action {action!r}, which the network has not; left out")
        return
    if network.actions[action].sees_appearance and thing.looks_like is not None:
        gathered.tell(f"{action}: {thing.name} looks like {thing.looks_like}; left out")
        return
    try:
        admitted = admit(network, action, most_probable(outcome)).outcome
    except EvidenceError as error:
        gathered.tell(f"{error}; left out")
        return
    gathered.measure(thing.name, action, admitted)
