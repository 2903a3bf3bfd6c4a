"""Receiving a recording from somebody who may send anything."""

from __future__ import annotations

import struct
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import ExitStack, asynccontextmanager
from pathlib import Path
from tempfile import SpooledTemporaryFile, TemporaryDirectory
from typing import IO

from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from starlette.requests import ClientDisconnect

from palpate.server.problems import problem, problem_of_store
from palpate.server.security.accounts import Account, Role
from palpate.server.state import State
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.importing.package import unpack
from palpate.store.records import Receipt, Recording

__all__ = ["check_owner", "check_parts", "receive", "spooled", "unpacked", "wrong_owner"]

IN_MEMORY = 4 << 20
MOST_PARTS = 10_000
"""Files in a package."""
LARGEST_JOURNAL_BYTES = 8 << 20
"""A recording of the largest size has less, as the journal has each part of it with some words."""
END, END_BYTES = b"PK\x05\x06", 22
LONGEST_END = END_BYTES + 65_535
LARGE = b"PK\x06\x07"
"""Stands before the end of a zip file whose numbers are elsewhere, as they are too large for it."""


@asynccontextmanager
async def spooled(request: Request) -> AsyncIterator[IO[bytes]]:
    """The body of a request as a file, on the disk where it is large."""
    with SpooledTemporaryFile(max_size=IN_MEMORY) as body:
        size = 0
        try:
            async for piece in request.stream():
                size += len(piece)
                if size > IN_MEMORY:
                    await run_in_threadpool(body.write, piece)
                else:
                    body.write(piece)
        except ClientDisconnect:
            raise problem(400, "the body ended early") from None
        body.seek(0)
        yield body


def receive(state: State, who: Account, digest: str, package: IO[bytes]) -> Receipt:
    """Keep the recording of a package, once it is what it says and whose it says."""
    with ExitStack() as stack:
        folders = list[str]()

        def folder() -> Path:
            folders.append(stack.enter_context(TemporaryDirectory(prefix="palpate-upload-")))
            return Path(folders[-1])

        try:
            recording = unpacked(state, package, folder)
            _check(recording, who, digest)
            return state.store.put(recording, uploader=who.name)
        except UnavailableError:
            raise
        except DamagedError as error:
            # it is what was sent that is damaged, and not what is stored
            raise problem_of_store(_told(error, folders)) from None
        except StoreError as error:
            raise problem_of_store(_told(error, folders)) from None
        except (MemoryError, RecursionError, OverflowError):
            raise problem(
                422, "package: holds numbers that are too large or values that are nested too deeply"
            ) from None


def unpacked(state: State, package: IO[bytes], folder: Callable[[], Path]) -> Recording:
    """The recording of a package, within the limits of the server; StoreError where it is none, or beyond them."""
    check_parts(package)
    return unpack(
        package,
        folder,
        largest_bytes=state.settings.largest_unpacked_bytes,
        largest_journal_bytes=LARGEST_JOURNAL_BYTES,
    )


def _told(error: StoreError, folders: Sequence[str]) -> StoreError:
    """The same without the names of folders of this server."""
    said = str(error)
    for folder in folders:
        said = said.replace(folder + "/", "").replace(folder, "package")
    return StoreError(said)


def _check(recording: Recording, who: Account, digest: str) -> None:
    if recording.digest != digest:
        raise StoreError(f"digest: the package holds the recording {recording.digest}, expected {digest}")
    check_owner(recording, who)


def check_owner(recording: Recording | StoredEpisode, who: Account) -> None:
    """Refuse what is sent in the name of somebody else."""
    wrong = wrong_owner(recording, who)
    if wrong is not None:
        raise StoreError(wrong)


def wrong_owner(recording: Recording | StoredEpisode, who: Account) -> str | None:
    """What is wrong where something is sent in the name of somebody else; administrators move whole stores.

    What states no owner is seen, where it is private, by who has sent it.
    """
    if who.role >= Role.ADMIN or recording.owner in (None, who.name):
        return None
    return (
        f"owner: found {recording.owner!r}, expected {who.name!r}, in whose name this is sent, or leave the owner out"
    )


def check_parts(package: IO[bytes]) -> None:
    """Refuse a package of very many files before its directory is read into memory."""
    size = package.seek(0, 2)
    package.seek(max(0, size - LONGEST_END))
    tail = package.read()
    package.seek(0)
    # as the library that unpacks it looks for the end
    bare = tail[-END_BYTES:]
    at = len(tail) - END_BYTES if bare[:4] == END and bare[-2:] == b"\0\0" else tail.rfind(END)
    if at < 0 or at + END_BYTES > len(tail):
        raise StoreError("package: is no zip file, expected that of one recording")
    (parts, length) = struct.unpack("<HI", tail[at + 10 : at + 16])
    is_large = tail[max(0, at - 20) : at].startswith(LARGE)
    # each part takes 46 bytes of the directory or more, whatever count is stated
    if is_large or parts > MOST_PARTS or length > MOST_PARTS * 1024:
        raise StoreError(f"package: holds more than {MOST_PARTS} files, expected fewer")
