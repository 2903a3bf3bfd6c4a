"""Recordings: lists, one of them, its files and its log; and uploading."""

from __future__ import annotations

from collections.abc import Iterator
from tempfile import SpooledTemporaryFile
from typing import IO, Annotated, Any

from fastapi import APIRouter, Depends, Path, Query, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import PlainTextResponse, Response, StreamingResponse
from starlette.datastructures import UploadFile

from palpate.errors import plural
from palpate.server.api import plain
from palpate.server.api.answers import answer, page
from palpate.server.api.downloads import stored_download
from palpate.server.api.models import Batch, Digests, File, KnownRecordings, Page, Receipt, Recording, RecordingRow
from palpate.server.api.parameters import Place, SeenRecording, StoreOf
from palpate.server.api.queries import RecordingQuery
from palpate.server.api.series import LARGEST_READ_BYTES, UNPACKED
from palpate.server.batches import keep_lines, keep_packages
from palpate.server.memory import Held, Memory
from palpate.server.packages import write_package
from palpate.server.problems import Problem, problem
from palpate.server.receiving import IN_MEMORY, receive, spooled
from palpate.server.security.accounts import Account, Role
from palpate.server.security.who import Who, needs
from palpate.server.state import state_of
from palpate.store.listing import list_recordings
from palpate.store.parts import Head, log_of
from palpate.store.visible_episodes import recordings_of_digests

__all__ = ["router"]

router = APIRouter(prefix="/recordings", tags=["recordings"])
UPLOAD = {"application/zip": {"schema": {"type": "string", "format": "binary"}}}
BATCH = {
    "application/x-ndjson": {"schema": {"type": "string"}},
    "multipart/form-data": {
        "schema": {"type": "object", "additionalProperties": {"type": "string", "format": "binary"}}
    },
}
MOST_PACKAGES = 1_000
PIECE_BYTES = 1 << 20
REFUSALS: dict[int | str, dict[str, Any]] = {status: {"model": Problem} for status in (409, 415)}


@router.get("", response_model=Page[RecordingRow])
def list_(request: Request, store: StoreOf, who: Who, query: Annotated[RecordingQuery, Query()]) -> Response:
    """Recordings, the last recorded first unless sorted otherwise."""
    wanted, sort = query.filter(who.viewer), query.sorting()
    found = list_recordings(store, wanted, sort, limit=query.limit, cursor=query.cursor)
    return page(request, query, map(plain.recording_row, found.rows), found.cursor)


@router.get("/{key}", response_model=Recording)
def get_recording(who: Who, head: SeenRecording) -> Response:
    """One recording by its id or its digest."""
    return answer(plain.recording(head, with_sender=who.role >= Role.READER))


@router.get("/{key}/files", response_model=Page[File])
def list_files(head: SeenRecording) -> Response:
    """All files of a recording."""
    return answer({"items": plain.files(head), "next": None})


@router.get(
    "/{key}/files/{position}",
    response_class=Response,
    responses={206: {"description": "A part of it."}, 307: {"description": "It is to be had there, for a minute."}},
)
def get_file(request: Request, head: SeenRecording, position: Place) -> Response:
    """What is in a file, or a part of it (header ``Range``).

    A server whose files are in a bucket may send one there.
    """
    if position >= len(head.files):
        raise problem(404, f"recording {head.id}: has {plural(len(head.files), 'file')}, and none at {position}")
    item = head.files[position]
    return stored_download(request, item.name, item.media_type, item.sha256)


@router.get("/{key}/package", response_class=Response, responses={200: {"content": UPLOAD}})
def get_package(store: StoreOf, who: Who, head: SeenRecording, memory: Memory) -> Response:
    """A recording whole, as a package: what a program that knows Palpate reads back to what was put.

    Where a series of it is larger than could be sent by itself, it is for those who have an account.
    """
    _take(memory, who, head)
    package = SpooledTemporaryFile(max_size=IN_MEMORY)  # noqa: SIM115 - closed once it is sent
    try:
        write_package(store, head, package)
    except BaseException:
        package.close()
        raise
    # it is on the disk from here on, however slowly it is read
    memory.give_back()
    headers = {
        "Content-Length": str(package.tell()),
        "Content-Disposition": f'attachment; filename="{head.id}.zip"',
    }
    package.seek(0)
    return StreamingResponse(_pieces(package), 200, headers, "application/zip")


@router.get("/{key}/log", response_class=PlainTextResponse)
def get_log(store: StoreOf, head: SeenRecording, memory: Memory) -> Response:
    """What the program printed."""
    log = log_of(store, head).encode()
    memory.take(len(log))
    return PlainTextResponse(log, headers={"Content-Security-Policy": "default-src 'none'; sandbox"})


@router.put(
    "/{key}",
    response_model=Receipt,
    responses={201: {"model": Receipt}, **REFUSALS},
    openapi_extra={"requestBody": {"required": True, "content": UPLOAD}},
)
async def put_recording(
    request: Request,
    key: Annotated[str, Path(pattern="^[0-9a-f]{64}$", description="Digest.")],
    who: Annotated[Account, Depends(needs(Role.OWNER))],
) -> Response:
    """Keep a recording: 201 where it is new, 200 where the store has it already.

    The body is its package, a zip of the folder that a spool holds; the digest is that of the recording.
    """
    state = state_of(request)
    async with spooled(request) as package:
        receipt = await run_in_threadpool(receive, state, who, key, package)
    found = {"id": str(receipt.id), "digest": receipt.digest, "new": receipt.new, "notices": list(receipt.notices)}
    return answer(found, 201 if receipt.new else 200, {"Location": f"{plain.ROOT}/recordings/{receipt.id}"})


@router.post("/known", response_model=KnownRecordings, responses=REFUSALS)
def post_known(store: StoreOf, who: Annotated[Account, Depends(needs(Role.OWNER))], asked: Digests) -> Response:
    """Which of these recordings are here, as far as one may see: what need not be sent again."""
    found = recordings_of_digests(store, who.viewer, asked.digests)
    return answer({"known": {digest: str(id) for digest, id in found.items()}})


@router.post(
    "",
    response_model=Batch,
    responses=REFUSALS,
    openapi_extra={"requestBody": {"required": True, "content": BATCH}},
)
async def post_recordings(request: Request, who: Annotated[Account, Depends(needs(Role.OWNER))]) -> Response:
    """Keep many recordings; the answer is 200, and has for each a status of its own, in the order in which they came.

    The body has a recording in each line (``application/x-ndjson``), or is a form of packages
    (``multipart/form-data``). What is sent again is known by its digest.
    """
    state, kind = state_of(request), request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind == "application/x-ndjson":
        async with spooled(request) as body:
            return answer({"items": await run_in_threadpool(keep_lines, state, who, body)})
    if kind == "multipart/form-data":
        async with request.form(max_files=MOST_PACKAGES, max_fields=0) as form:
            parts = [part.file for _, part in form.multi_items() if isinstance(part, UploadFile)]
            return answer({"items": await run_in_threadpool(keep_packages, state, who, parts)})
    raise problem(415, f"content-type: found {kind[:60]!r}, expected {' or '.join(BATCH)}")


def _take(memory: Held, who: Account, head: Head) -> None:
    """Take the memory that the largest series needs, of which one after the other is unpacked."""
    largest = max((one.size_bytes for one in head.series), default=0)
    if largest <= LARGEST_READ_BYTES:
        memory.take(UNPACKED * largest)
    elif who.role >= Role.READER:
        memory.take_alone(UNPACKED * largest)
    else:
        told = f"a series has {largest} bytes, expected {LARGEST_READ_BYTES} at most for those without an account"
        raise problem(403, f"recording {head.id}: {told}")


def _pieces(package: IO[bytes]) -> Iterator[bytes]:
    with package:
        while piece := package.read(PIECE_BYTES):
            yield piece
