"""Sessions from a store: what was recorded of an object, to be replayed."""

from __future__ import annotations

from palpate.errors import LogError
from palpate.network.model import Network
from palpate.outcomes import Reading
from palpate.recording.results import outcome_in
from palpate.robots.session import Recording, Session
from palpate.store.filters import Filter, Sort
from palpate.store.matching import ids_matching
from palpate.store.records import Recording as StoredRecording
from palpate.store.store import Store
from palpate.store.things import find_thing

__all__ = ["stored_session"]


def stored_session(store: Store, name: str, network: Network) -> Session:
    """All outcomes that a store has of an object, of each action in the order of recording.

    What was recorded of objects merged into it counts. A recording that is known to be true is no measurement of a
    robot, and is left out, as is one without a usable outcome; the session says so.

    Parameters
    ----------
    store
        Where the recordings are.
    name
        The object: its name, common name, an alias, or ``DATASET/NAME``.
    network
        Tells which property an action measures.

    Raises
    ------
    StoreError
        There is no such object, or a recording is damaged.
    LogError
        None of its recordings has a usable outcome.
    """
    thing, used, decisions = find_thing(store, name), [], []
    for recording in map(store.get, ids_matching(store, Filter(thing=thing.path), Sort(descending=False))):
        found = _usable(recording, network)
        if isinstance(found, str):
            decisions.append(f"recording {recording.id} of {recording.action} is left out: {found}")
        else:
            used.append(found)
    if not used:
        raise LogError(f"object {name!r}: none of its {thing.recordings} recordings has an outcome to replay")
    return Session(thing.ref.id, f"the store, {thing.path}", tuple(used), decisions=tuple(decisions))


def _usable(recording: StoredRecording, network: Network) -> Recording | str:
    """What can be replayed, or why nothing can."""
    if recording.ground_truth:
        return "it is known to be true, and no robot measured it"
    if recording.action not in network.actions:
        return f"the network {network.name!r} has no such action"
    outcome, reason = outcome_in(recording, network.action(recording.action).sensor.property)
    if outcome is None:
        return reason or "it has no outcome"
    decisions = list(recording.notices)
    if isinstance(outcome, Reading) and outcome.sd is not None:
        decisions.append(f"its SD of {outcome.sd:g} takes the place of the sensor's")
    return Recording(str(recording.id), recording.action, outcome, tuple(decisions))
