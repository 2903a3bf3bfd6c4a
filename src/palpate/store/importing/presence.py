"""Which recordings a store has whole, as far as an import can mend them: with all their blobs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from uuid import UUID

from sqlalchemy import select

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.legible import reading
from palpate.store.store import Store

__all__ = ["Presence", "ids_of_others"]


def ids_of_others(store: Store, ids: Mapping[str, UUID]) -> set[str]:
    """Which recordings a store would refuse, as it has another one under the same id.

    Parameters
    ----------
    ids
        Ids of recordings, by digest.
    """
    columns, found = schema.recordings.c, dict[bytes, str]()
    with reading(store.engine) as connection:
        for some in chunks([id.bytes for id in ids.values()]):
            asked = select(columns.uuid, columns.digest).where(columns.uuid.in_(some))
            found |= {row.uuid: row.digest.hex() for row in connection.execute(asked)}
    return {digest for digest, id in ids.items() if found.get(id.bytes, digest) != digest}


class Presence:
    """What a store has, while something is imported into it.

    Parameters
    ----------
    store
        Its blobs are listed when the first recording with blobs is asked for, and again where one is missing.
    """

    def __init__(self, store: Store) -> None:
        self.store = store
        self._listed = set[bytes]()

    def known(self, digests: Iterable[str]) -> tuple[set[str], set[str]]:
        """Which recordings of these digests are there: those with all their blobs, and those that lack one."""
        known = self.store.known(digests)
        needed = self._blobs_of(sorted(known))
        if any(blob not in self._listed for _, blob in needed):
            # what came since it was listed is none that was lost
            self._listed = {bytes.fromhex(digest) for digest, _ in self.store.blobs.all()}
        broken = {digest for digest, blob in needed if blob not in self._listed}
        return known - broken, broken

    def _blobs_of(self, digests: list[str]) -> list[tuple[str, bytes]]:
        """Each recording with each of its blobs."""
        recordings, series, files = schema.recordings.c, schema.series.c, schema.files.c
        found: list[tuple[str, bytes]] = []
        with reading(self.store.engine) as connection:
            for some in chunks(digests):
                these = recordings.digest.in_([bytes.fromhex(one) for one in some])
                for asked in (
                    select(recordings.digest, series.blob).join(schema.series, series.recording_id == recordings.id),
                    select(recordings.digest, files.blob).join(schema.files, files.recording_id == recordings.id),
                    select(recordings.digest, recordings.log_blob),
                ):
                    blob = asked.selected_columns[1]
                    rows = connection.execute(asked.where(these, blob.is_not(None)))
                    found += [(digest.hex(), data) for digest, data in rows]
        return found
