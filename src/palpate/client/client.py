"""A store behind a server, to read from and to write to."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from tempfile import SpooledTemporaryFile, TemporaryDirectory
from typing import Any
from urllib.parse import quote, urlencode
from uuid import UUID

from palpate.client.batches import chunks, is_large, known, send
from palpate.client.episodes import begin, put_line
from palpate.client.errors import RefusedError
from palpate.client.filters import Asked, parameters
from palpate.client.receiver import IN_MEMORY, HttpReceiver
from palpate.store.episodes import StoredEpisode, StoredStep
from palpate.store.errors import StoreError
from palpate.store.importing.package import unpack
from palpate.store.records import FileItem, Receipt, Recording

__all__ = ["Client"]

Row = Mapping[str, Any]
ROWS = 200
"""Of a page."""


class Client(HttpReceiver):
    """A store behind a server: lists, whole recordings, and uploads.

    What lists give are dictionaries, as the service's OpenAPI document tells them. Filters are those of the service,
    by their names there; one that there is not is a `RefusedError`, before anything is asked.

    Parameters
    ----------
    url, token, timeout_s, patience
        As of `HttpReceiver`. What is public needs no token.

    Examples
    --------
    >>> client = Client("https://measurements.example.org")
    >>> client.url
    'https://measurements.example.org/api/v1'
    """

    def objects(self, *, limit: int | None = None, **filters: Asked) -> Iterator[Row]:
        """Objects with what is known of them, page by page as they are asked for; `limit` of them at most."""
        return self._rows("/objects", limit, filters)

    def recordings(self, *, limit: int | None = None, **filters: Asked) -> Iterator[Row]:
        """Recordings without their samples, the last one first unless ``sort`` and ``order`` say otherwise."""
        return self._rows("/recordings", limit, filters)

    def entries(self, *, limit: int | None = None, **filters: Asked) -> Iterator[Row]:
        """Results, a row for each, with the filters of recordings."""
        return self._rows("/entries", limit, filters)

    def episodes(self, *, limit: int | None = None, **filters: Asked) -> Iterator[Row]:
        """Explorations without their steps, the last one first."""
        return self._rows("/episodes", limit, filters)

    def episode(self, id: UUID | str) -> Row:
        """An exploration with its steps.

        Raises
        ------
        NotThereError
            If there is none, or none that this token may see.
        """
        found = self._connection.ask_plain("GET", f"/episodes/{quote(str(id), safe='')}")
        if not isinstance(found, dict):
            raise self._connection.strange("no exploration")
        return found

    def begin_episode(self, episode: StoredEpisode) -> int:
        """Send the beginning of an exploration, without its lines, and return how many of them the server has.

        It is for explorations that go on; `put_episode` sends one that is over. The same again does no harm.

        Raises
        ------
        UnreachableError, NotAllowedError
            As `put`.
        RefusedError
            If the server will not have it, or has another one under its id.
        """
        return begin(self._connection, episode)

    def put_line(self, episode: UUID, position: int, step: StoredStep) -> int:
        """Send a line of an exploration that was begun, the first one at 1; how many lines the server has then.

        Its recording is sent before. The same line again does no harm.

        Raises
        ------
        UnreachableError, NotAllowedError
            As `put`.
        RefusedError
            If another line stands there, those in front of it are missing, or it is no line of a log.
        """
        return put_line(self._connection, episode, position, step)

    def put_episode(self, episode: StoredEpisode) -> int:
        """Send those lines of an exploration that the server lacks, and return how many these were.

        Raises
        ------
        UnreachableError, NotAllowedError, RefusedError
            As `begin_episode` and `put_line`; what was sent before is kept.
        """
        known = self.begin_episode(episode)
        missing = list(enumerate(episode.steps, 1))[known:]
        for position, step in missing:
            self.put_line(episode.id, position, step)
        return len(missing)

    def get(self, key: UUID | str) -> Recording:
        """One recording by its id or its digest, with its arrays and files; it is what was put, or an error.

        Raises
        ------
        NotThereError
            If there is none, or none that this token may see.
        UnreachableError
            If there is no answer, or another one than this recording.
        """
        path = f"/recordings/{quote(str(key), safe='')}/package"
        with SpooledTemporaryFile(max_size=IN_MEMORY) as package, TemporaryDirectory(prefix="palpate-") as folder:
            with self._connection.ask("GET", path, headers={"Accept": "application/zip"}) as answer:
                shutil.copyfileobj(answer, package)
            package.seek(0)
            try:
                found = unpack(package, lambda: Path(folder))
            except StoreError as error:
                raise self._connection.strange(f"no recording ({error})") from None
            if str(key).lower() not in (str(found.id), found.id.hex, found.digest):
                raise self._connection.strange(f"the recording {found.id}, and not {key}")
            # files are in a folder that goes now
            return replace(found, files=tuple(_in_memory(item) for item in found.files))

    def put_many(self, recordings: Iterable[Recording]) -> Iterator[tuple[Recording, Receipt | RefusedError]]:
        """Send many recordings, and tell of each what became of it, in their order.

        Those that the server has are not sent: after a break the same again goes on where it stopped.

        Yields
        ------
        tuple[Recording, Receipt | RefusedError]
            Each once it is kept, or refused.

        Raises
        ------
        UnreachableError, NotAllowedError
            As `put`; what was given before is kept.
        """
        for chunk in chunks(recordings):
            whole = [one for one, flaw in chunk if flaw is None]
            outcomes: dict[str, Receipt | RefusedError] = {**known(self._connection, whole)}
            outcomes |= self._sent([one for one in whole if one.digest not in outcomes])
            yield from ((one, flaw or outcomes[one.digest]) for one, flaw in chunk)

    def _sent(self, recordings: Sequence[Recording]) -> dict[str, Receipt | RefusedError]:
        small = [one for one in recordings if not is_large(one)]
        alone = [one for one in recordings if is_large(one)]
        found = dict[str, Receipt | RefusedError]()
        try:
            found |= send(self._connection, small) if small else {}
        except RefusedError:
            # of all, such as for their size: each may go by itself
            alone = list(recordings)
        return found | {one.digest: self._put_or_refused(one) for one in alone}

    def _put_or_refused(self, recording: Recording) -> Receipt | RefusedError:
        try:
            return self._put_checked(recording)
        except RefusedError as error:
            return error

    def _rows(self, path: str, limit: int | None, filters: Mapping[str, Asked]) -> Iterator[Row]:
        rows = ROWS if limit is None else max(1, min(limit, ROWS))
        return islice(self._all(path, [("limit", str(rows)), *parameters(path, filters)]), limit)

    def _all(self, path: str, query: Sequence[tuple[str, str]]) -> Iterator[Row]:
        cursor: str | None = None
        while True:
            of_page = [] if cursor is None else [("cursor", cursor)]
            page = self._connection.ask_plain("GET", f"{path}?{urlencode([*query, *of_page])}")
            if not (isinstance(page, dict) and isinstance(page.get("items"), list) and "next" in page):
                raise self._connection.strange("no page of a list")
            yield from page["items"]
            if page["next"] is None:
                return
            if page["next"] == cursor or not isinstance(page["next"], str):
                raise self._connection.strange("a page that does not lead on")
            cursor = page["next"]


def _in_memory(item: FileItem) -> FileItem:
    return item if isinstance(item.data, bytes) else replace(item, data=item.data.read_bytes())
