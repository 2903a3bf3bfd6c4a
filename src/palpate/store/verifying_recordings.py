"""Whether recordings are what was put, and the rows that queries use are theirs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Select, delete, insert, inspect, select, update

from palpate.store import schema
from palpate.store.database import changing
from palpate.store.errors import DamagedError
from palpate.store.faults import Fault, Remedy
from palpate.store.fetching import Broken, id_chunks, read_each
from palpate.store.known_units import is_known_unit
from palpate.store.records import Recording
from palpate.store.rows import counted, entry_rows, gripper_of, microseconds
from palpate.store.seals import seal_of
from palpate.store.store import Store
from palpate.store.units import deciding_units

__all__ = ["mend_recording", "recording_faults"]

AT_ONCE = 200
Row = Mapping[Any, Any]


def recording_faults(connection: Connection, store: Store, left_out: Collection[int]) -> Iterator[Fault]:
    """Recordings that are not what was put, and rows for queries that are not theirs; some row numbers are left out."""
    # without these two tables the rest can be looked at still
    has_entries = all(inspect(connection).has_table(table.name) for table in (schema.entries, schema.properties))
    units = deciding_units(connection) if has_entries else {}
    for chunk in id_chunks(connection, AT_ONCE):
        ids = [row for row in chunk if row not in left_out]
        found = dict(zip(ids, read_each(connection, store.blobs, ids), strict=True))
        whole = {row: one for row, one in found.items() if isinstance(one, Recording)}
        heads = {head["id"]: head for head in connection.execute(_heads(list(whole))).mappings()}
        entries = _entries_there(connection, list(whole)) if has_entries else {}
        for row, one in found.items():
            if isinstance(one, Broken):
                yield Fault(one.where, one.what)
            elif _is_stale(one, heads[row], units, entries[row] if has_entries else None):
                yield Fault(f"recording {one.id}", "rows for queries are not those of its content", Remedy.REINDEX)


def mend_recording(store: Store, key: UUID) -> None:
    """Make the rows that queries use again."""
    recording, columns = store.get(key), schema.recordings.c
    with changing(store.engine) as connection:
        row = connection.execute(select(columns.id).where(columns.uuid == key.bytes)).scalar_one()
        head = connection.execute(_heads([row])).mappings().one()
        connection.execute(update(schema.recordings).where(columns.id == row).values(**_head_wanted(recording)))
        there = _entries_there(connection, [row])[row]
        entries = _entries_wanted(recording, head, deciding_units(connection), there)
        connection.execute(delete(schema.entries).where(schema.entries.c.recording_id == row))
        if entries:
            connection.execute(insert(schema.entries), entries)


def _is_stale(recording: Recording, head: Row, units: Mapping[str, str], entries: Sequence[Row] | None) -> bool:
    """Whether columns or entries repeat something else than the content; None for entries that cannot be looked at."""
    if dict(head) != {**head, **_head_wanted(recording)}:
        return True
    return entries is not None and list(entries) != _entries_wanted(recording, head, units, entries)


def _heads(ids: Sequence[int]) -> Select[*tuple[Any, ...]]:
    names = ("id", "thing_id", "setup_id", "gripper", "recorded_us", "action", "owner", "ground_truth", "seal")
    return select(*(schema.recordings.c[name] for name in names)).where(schema.recordings.c.id.in_(ids))


def _head_wanted(recording: Recording) -> dict[str, Any]:
    """What the columns of a recording repeat of its content."""
    return {
        "gripper": gripper_of(recording),
        "recorded_us": microseconds(recording.recorded_at),
        "action": recording.action,
        "owner": recording.owner,
        "ground_truth": recording.ground_truth,
        "seal": seal_of(bytes.fromhex(recording.digest), recording.document),
    }


def _entries_wanted(
    recording: Recording, head: Row, units: Mapping[str, str], there: Sequence[Row]
) -> list[dict[str, Any]]:
    """The entries that there should be; in SI units as they are there where the unit is not known here."""
    wanted = [counted(row, units) for row in entry_rows(recording, {**head, **_head_wanted(recording)})]
    return [row if row["unit"] is None or is_known_unit(row["unit"]) else _as_kept(row, there) for row in wanted]


def _as_kept(row: dict[str, Any], there: Sequence[Row]) -> dict[str, Any]:
    same = ("position", "unit", "value", "sd")
    found = next((one for one in there if all(name in one and one[name] == row[name] for name in same)), row)
    return {**row, "value_si": found["value_si"], "sd_si": found["sd_si"]}


def _entries_there(connection: Connection, ids: Sequence[int]) -> Mapping[int, list[dict[str, Any]]]:
    """The entries of recordings; where one cannot be read, something that is none."""
    table = schema.entries
    found: dict[int, list[dict[str, Any]]] = defaultdict(list)
    asked = select(table).where(table.c.recording_id.in_(ids)).order_by(table.c.recording_id, table.c.position)
    try:
        for row in connection.execute(asked).mappings():
            found[row["recording_id"]].append(dict(row))
    except DamagedError:
        if len(ids) == 1:
            return {ids[0]: [{}]}
        return {row: _entries_there(connection, [row])[row] for row in ids}
    return found
