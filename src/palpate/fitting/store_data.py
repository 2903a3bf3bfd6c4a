"""Data from a store: known properties of its objects, and what was measured on them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path
from typing import Any

from sqlalchemy import Row, Select, case, false, select

from palpate.errors import EvidenceError
from palpate.fitting.data import Data, Source
from palpate.fitting.errors import FittingError
from palpate.fitting.gathering import Gathered
from palpate.fitting.known import known_properties, truth_of
from palpate.network.admission import admit
from palpate.network.model import Network
from palpate.outcomes import Above, Below, Failed, Label, Outcome, Reading
from palpate.robots.simulated_truth import LOOKS_LIKE
from palpate.store import schema
from palpate.store.content import entry_plain, to_json
from palpate.store.database import as_of_one_moment
from palpate.store.filters import Filter
from palpate.store.legible import legible, reading
from palpate.store.rows import moment_at
from palpate.store.seals import recording_name
from palpate.store.store import Store

__all__ = ["read_store"]


def read_store(store: Store, network: Network, wanted: Filter | None = None) -> Data:
    """Read what a network can be fitted to.

    What is known of objects is the truth; recordings marked as ground truth are part of it. All other recordings of
    actions that the network has are readings of their sensors. Of a distribution over labels the most probable label
    counts, as sensor models are about labels. What an action that sees the appearance gave on an object whose attribute
    ``looks_like`` names another one is left out: it saw the other one. What cannot be used is told in the notices.

    Parameters
    ----------
    wanted
        Which recordings are readings, as those of one gripper; all unless given. Of a dataset the objects too.

    Raises
    ------
    FittingError
        Nothing is known of any object.
    """
    gathered, hashed = Gathered(network), sha256()
    names, look_like, wanted = _names(store), _look_like(store), wanted or Filter()
    known = [one for one in known_properties(store) if _of_dataset(names[one.thing], wanted)]
    for line in sorted(f"{names[one.thing]}\n{to_json(entry_plain(one.entry))}\n" for one in known):
        hashed.update(line.encode())
    truth = truth_of(gathered, known)
    if not truth:
        raise FittingError(
            f"store {store.engine.url!r}: found no known properties of any object; expected recordings marked as "
            "ground truth, or objects with known properties, as told by: palpate store object know OBJECT PROPERTY "
            "VALUE --source WHERE"
        )
    for thing, values in sorted(truth.items(), key=lambda item: names[item[0]]):
        gathered.know(names[thing], values)
    recordings, moments = set(), []
    for row in _readings(store, wanted):
        if _sees_another(gathered, row, names, look_like):
            continue
        if _take(gathered, row, names):
            recordings.add(row.digest)
            moments.append(row.recorded_us)
    for digest in sorted(recordings):
        hashed.update(digest)
    ends = [moment_at(us).isoformat() for us in (min(moments), max(moments))] if moments else []
    source = Source("store", _place(store), hashed.hexdigest(), len(recordings), *ends)
    return gathered.data([source])


def _place(store: Store) -> str:
    """The name of the file, or the address without its password."""
    url = store.engine.url
    if url.get_backend_name() == "sqlite" and url.database:
        return Path(url.database).name
    return url.render_as_string(hide_password=True)


def _names(store: Store) -> dict[int, str]:
    """The name of the object that each row of an object counts as: its dataset and its name there."""
    things = schema.things.c
    with reading(store.engine) as connection:
        rows = connection.execute(select(things.id, things.dataset, things.name, things.merged_into)).all()
    own = {row.id: f"{row.dataset}/{row.name}" for row in rows}
    return {row.id: own[row.merged_into or row.id] for row in rows}


def _look_like(store: Store) -> dict[int, str]:
    """What each object that looks like another one looks like, by its row."""
    things = schema.things.c
    with reading(store.engine) as connection:
        rows = connection.execute(select(things.id, things.attributes)).all()
    found = {row.id: json.loads(row.attributes).get(LOOKS_LIKE) for row in rows}
    return {row: str(other) for row, other in found.items() if other}


def _sees_another(
    gathered: Gathered, row: Row[*tuple[Any, ...]], names: dict[int, str], look_like: dict[int, str]
) -> bool:
    """Whether a row is of an action that saw what the object looks like, and not what it is; that is told."""
    action = gathered.network.actions.get(row.action)
    if action is None or not action.sees_appearance or row.thing_id not in look_like:
        return False
    gathered.tell(f"{row.action}: {names[row.thing_id]} looks like {look_like[row.thing_id]}; left out")
    return True


def _of_dataset(name: str, wanted: Filter) -> bool:
    return wanted.dataset is None or name.startswith(f"{wanted.dataset}/")


def _readings(store: Store, wanted: Filter) -> Iterator[Row[*tuple[Any, ...]]]:
    # what comes in parts needs a transaction
    with reading(as_of_one_moment(store.engine)) as connection:
        yield from connection.execution_options(stream_results=True).execute(_asked(wanted))


def _asked(wanted: Filter) -> Select[*tuple[Any, ...]]:
    entries, recordings = schema.entries.c, schema.recordings
    own = [entries[name] for name in ("kind", "property", "value", "low", "high", "unit", "label", "thing_id")]
    columns = [recordings.c[name] for name in ("action", "digest", "recorded_us", "uuid")]
    failure = case((entries.kind == "failed", recordings.c.document)).label("failure")
    return (
        select(*columns, *own, entries.position, failure)
        .join(recordings, recordings.c.id == entries.recording_id)
        .where(recordings.c.ground_truth.is_(false()), *wanted.conditions())
        .order_by(recordings.c.digest, entries.position)
    )


def _take(gathered: Gathered, row: Row[*tuple[Any, ...]], names: dict[int, str]) -> bool:
    """Take a row as a reading of its action's sensor; False where it is none."""
    network = gathered.network
    if row.action not in network.actions:
        gathered.tell(f"results of action {row.action!r}, which the network has not; left out")
        return False
    action = network.actions[row.action]
    if row.property not in (None, action.sensor.property):
        gathered.tell(
            f"results of {row.property!r} by {row.action!r}, which measures {action.sensor.property!r}; left out"
        )
        return False
    outcome = _outcome(row)
    if isinstance(outcome, str):
        gathered.tell(f"{row.action}: {outcome}; left out")
        return False
    try:
        admitted = admit(network, row.action, outcome).outcome
    except EvidenceError as error:
        gathered.tell(f"{error}; left out")
        return False
    gathered.measure(names[row.thing_id], row.action, admitted)
    return True


def _reason(row: Row[*tuple[Any, ...]]) -> str:
    """Why a measurement failed, which only its document says."""
    with legible(recording_name(row.uuid)):
        return str(json.loads(row.failure)["entries"][row.position]["reason"])


def _outcome(row: Row[*tuple[Any, ...]]) -> Outcome | str:
    """The outcome that a row stands for, or why it is none."""
    if row.kind == "failed":
        return Failed(_reason(row))
    if row.kind == "distribution":
        return Label(row.label)
    if row.kind == "interval":
        return "an interval, which no sensor model gives"
    if row.unit is None:
        return "a number without a unit"
    if row.kind == "value":
        return Reading(row.value, unit=row.unit)
    return Above(row.low, unit=row.unit) if row.low is not None else Below(row.high, unit=row.unit)
