"""All curves of one gripper, as arrays."""

from __future__ import annotations

from collections.abc import Iterator
from uuid import UUID

from sqlalchemy import select

from palpate.store import schema
from palpate.store.arrays import unpack_series
from palpate.store.database import as_of_one_moment
from palpate.store.fetching import from_row_or_blob, parsed_layout
from palpate.store.legible import reading
from palpate.store.records import Series
from palpate.store.store import Store

__all__ = ["curves_of_gripper"]

AT_ONCE = 1000


def curves_of_gripper(store: Store, gripper: str, *, action: str | None = None) -> Iterator[tuple[UUID, Series]]:
    """Each series recorded with a gripper, with the id of its recording, in the order of recording.

    Parameters
    ----------
    store
        Where to look.
    gripper
        Name of the gripper of the setup.
    action
        Only recordings of this action.

    Raises
    ------
    DamagedError
        If bytes are missing or cannot be read.
    """
    recordings, series, layouts = schema.recordings.c, schema.series.c, schema.layouts.c
    asked = (
        select(recordings.uuid, series.name, layouts.digest, layouts.document, series.data, series.blob)
        .join(schema.series, series.recording_id == recordings.id)
        .join(schema.layouts, layouts.id == series.layout_id)
        .where(recordings.gripper == gripper)
        .order_by(recordings.recorded_us, recordings.id, series.position)
    )
    if action is not None:
        asked = asked.where(recordings.action == action)
    with (
        reading(as_of_one_moment(store.engine)) as connection,
        # closed also where one does not read to the end, as PostgreSQL holds the rest
        connection.execution_options(yield_per=AT_ONCE).execute(asked) as found,
    ):
        for part in found.partitions():
            for uuid, name, digest, layout, data, blob in part:
                packed = from_row_or_blob(data, blob, store.blobs) or b""
                yield UUID(bytes=uuid), unpack_series(name, parsed_layout(digest, layout), packed)
