"""Sending many recordings: as many in a request as is quick, and none that the server has."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from palpate.client.connection import Connection
from palpate.client.errors import RefusedError
from palpate.client.receiver import check_sendable, receipt_of
from palpate.store.implausible import implausible
from palpate.store.importing.lines import line_of
from palpate.store.records import FileItem, Receipt, Recording

__all__ = ["chunks", "is_large", "known", "send"]

AT_ONCE = 200
LARGEST_CHUNK_BYTES = 8 << 20
LARGE_BYTES = 4 << 20
"""A recording that is sent by itself, as a package."""


def chunks(recordings: Iterable[Recording]) -> Iterator[list[tuple[Recording, RefusedError | None]]]:
    """As many as go into one request, each with the reason why it cannot be sent, where there is one."""
    found, size_bytes = list[tuple[Recording, RefusedError | None]](), 0
    for recording in recordings:
        flaw = _flaw(recording)
        found.append((recording, flaw))
        size_bytes += 0 if flaw else _size_bytes(recording)
        if len(found) >= AT_ONCE or size_bytes >= LARGEST_CHUNK_BYTES:
            yield found
            found, size_bytes = [], 0
    if found:
        yield found


def _flaw(recording: Recording) -> RefusedError | None:
    try:
        check_sendable(recording)
    except RefusedError as error:
        return error
    return None


def is_large(recording: Recording) -> bool:
    """Whether it is sent by itself."""
    return _size_bytes(recording) >= LARGE_BYTES


def known(connection: Connection, recordings: Sequence[Recording]) -> dict[str, Receipt]:
    """Receipts of those that the server has, by digest."""
    if not recordings:
        return {}
    asked = {recording.digest: recording for recording in recordings}
    headers = {"Content-Type": "application/json"}
    answer = connection.ask_plain("POST", "/recordings/known", json.dumps({"digests": list(asked)}).encode(), headers)
    return {
        digest: replace(
            receipt_of(connection, {"id": item, "digest": digest, "new": False}, digest),
            # as the server would tell it of one that is sent
            notices=implausible(asked[digest]),
        )
        for digest, item in _dictionary(connection, answer, "known").items()
        if digest in asked
    }


def send(connection: Connection, recordings: Sequence[Recording]) -> dict[str, Receipt | RefusedError]:
    """Send them in one request; what became of each, by digest."""
    body = "".join(line_of(recording) + "\n" for recording in recordings).encode()
    answer = connection.ask_plain("POST", "/recordings", body, {"Content-Type": "application/x-ndjson"})
    items = answer.get("items") if isinstance(answer, dict) else None
    if not isinstance(items, list) or len(items) != len(recordings):
        raise connection.strange(f"not about {len(recordings)} recordings")
    pairs = zip(recordings, items, strict=True)
    return {recording.digest: _became(connection, item, recording) for recording, item in pairs}


def _became(connection: Connection, item: Any, recording: Recording) -> Receipt | RefusedError:
    if isinstance(item, dict) and item.get("status") == 422:
        return RefusedError(f"{connection.url}: refused: {item.get('detail')}")
    return receipt_of(connection, item, recording.digest)


def _dictionary(connection: Connection, answer: Any, name: str) -> Mapping[str, Any]:
    found = answer.get(name) if isinstance(answer, dict) else None
    if not isinstance(found, dict):
        raise connection.strange(f"without {name!r}")
    return found


def _size_bytes(recording: Recording) -> int:
    arrays = sum(channel.values.nbytes for series in recording.series for channel in series.channels)
    return arrays + len(recording.log) + sum(_file_bytes(item) for item in recording.files)


def _file_bytes(item: FileItem) -> int:
    return len(item.data) if isinstance(item.data, bytes) else item.data.stat().st_size
