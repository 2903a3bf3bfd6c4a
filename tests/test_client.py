import io
import json
import threading
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

import pytest

from palpate.client import (
    BackOff,
    BusyError,
    Client,
    HttpReceiver,
    NotAllowedError,
    Patience,
    ReceiverError,
    RefusedError,
    UnreachableError,
)
from palpate.recording.spool import Spool
from palpate.recording.uploading import upload
from palpate.store.importing.lines import recording_of
from palpate.store.importing.package import unpack
from tests.store.importing.invented import squeeze


class StubServer(ThreadingHTTPServer):
    """A server with a dictionary for a store; `answers` come first, one for each request."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.kept: dict[str, Any] = {}
        self.answers: list[tuple[Any, ...]] = []

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}/api/v1"


class Handler(BaseHTTPRequestHandler):
    server: StubServer

    def do_PUT(self) -> None:  # the name is http.server's
        body = self.rfile.read(int(self.headers["Content-Length"]))
        if self.server.answers:
            self.reply(*self.server.answers.pop(0))
        elif self.headers["Authorization"] != "Bearer right":
            self.reply(401, b'{"detail": "the token is not known"}')
        else:
            self.keep(body)

    def keep(self, body: bytes) -> None:
        with TemporaryDirectory() as folder:
            found = unpack(io.BytesIO(body), lambda: Path(folder))
        assert self.path == f"/api/v1/recordings/{found.digest}"
        new = found.digest not in self.server.kept
        self.server.kept[found.digest] = found
        answer = {"id": str(found.id), "digest": found.digest, "new": new}
        self.reply(201 if new else 200, json.dumps(answer).encode())

    def do_GET(self) -> None:
        self.reply(*(self.server.answers.pop(0) if self.server.answers else (200, b'{"items": [], "next": null}')))

    def do_POST(self) -> None:
        lines = self.rfile.read(int(self.headers["Content-Length"])).splitlines()
        if self.server.answers:
            self.reply(*self.server.answers.pop(0))
        elif self.path.endswith("/known"):
            self.reply(200, b'{"known": {}}')
        else:
            found = [recording_of(line) for line in lines]
            items = [{"id": str(one.id), "digest": one.digest, "new": True, "status": 201} for one in found]
            self.server.kept |= {one.digest: one for one in found}
            self.reply(200, json.dumps({"items": items}).encode())

    def reply(self, code: int, body: bytes, retry_after: str | None = None) -> None:
        self.send_response(code)
        self.send_header("Content-Length", str(len(body)))
        if retry_after is not None:
            self.send_header("Retry-After", retry_after)
        if code == 307:
            self.send_header("Location", "http://127.0.0.1:9/elsewhere")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: Any) -> None:
        """Say nothing."""


@pytest.fixture
def server() -> Iterator[StubServer]:
    with StubServer() as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def test_a_recording_arrives(server: StubServer) -> None:
    """The server has the recording to the digest, and the receipt is its answer."""
    receiver = HttpReceiver(server.url, "right")
    receipt = receiver.put(squeeze())
    assert (receipt.digest, receipt.new) == (squeeze().digest, True)
    assert server.kept[receipt.digest].entries == squeeze().entries


def test_the_same_again_is_no_second_one(server: StubServer) -> None:
    """Sending it twice keeps it once."""
    receiver = HttpReceiver(server.url, "right")
    recording = squeeze()
    assert [receiver.put(recording).new for _ in range(2)] == [True, False]
    assert len(server.kept) == 1


@pytest.mark.parametrize(
    ("code", "body", "error", "told"),
    [
        (401, b'{"detail": "the token is not known"}', NotAllowedError, "the token is not known"),
        (403, b"", NotAllowedError, "PALPATE_TOKEN"),
        (422, b'{"detail": "entries[0].unit: is odd"}', RefusedError, "is odd"),
        (500, b"<html>", UnreachableError, "answered 500"),
        (429, b"{}", UnreachableError, "answered 429"),
        (307, b"", UnreachableError, "answered 307"),
        (200, b"", UnreachableError, "no receipt"),
        (200, b"[]", UnreachableError, "no receipt"),
        (201, b'{"id": "x", "digest": "y", "new": true}', UnreachableError, "no receipt"),
        (
            201,
            b'{"id": "12345678-1234-5678-1234-567812345678", "digest": "abc", "new": true}',
            UnreachableError,
            "about the recording abc",
        ),
    ],
)
def test_only_a_receipt_acknowledges(
    server: StubServer, code: int, body: bytes, error: type[ReceiverError], told: str
) -> None:
    """Every answer but a receipt for this recording is an error of the right kind, in one sentence."""
    server.answers = [(code, body)]
    with pytest.raises(error, match=told):
        HttpReceiver(server.url, "right", patience=Patience(BackOff(attempts=1))).put(squeeze())


PRESENT = datetime(2026, 11, 27, 12, tzinfo=UTC)
BUSY = (503, b'{"detail": "the store cannot be used now"}')


@pytest.mark.parametrize(
    ("retry_after", "least_s", "most_s"),
    [
        ("3", 3.0, 3.0),
        ("Fri, 27 Nov 2026 12:00:08 GMT", 8.0, 8.0),
        ("Fri, 27 Nov 2026 11:59:00 GMT", 0.5, 1.0),
        ("0", 0.5, 1.0),
        ("soon", 0.5, 1.0),
        (None, 0.5, 1.0),
    ],
)
def test_a_busy_server_is_asked_again_when_it_says(
    server: StubServer, retry_after: str | None, least_s: float, most_s: float
) -> None:
    """After seconds or at a date; else after a wait of one's own: lists, packages and lines are whole then."""
    slept = list[float]()
    patience = Patience(BackOff(first_s=1.0, longest_s=30.0), slept.append, lambda: PRESENT)
    client = Client(server.url, "right", patience=patience)
    one, other = squeeze(), replace(squeeze(), recorded_at=squeeze().recorded_at.replace(second=7))
    server.answers = [(*BUSY, retry_after)]
    assert list(client.recordings()) == []
    server.answers = [(*BUSY, retry_after)]
    assert client.put(one).new
    server.answers = [(*BUSY, retry_after)]
    assert [sent.digest for sent, became in client.put_many([other])] == [other.digest]
    assert server.kept.keys() == {one.digest, other.digest}
    assert len(slept) == 3
    assert all(least_s <= wait_s <= most_s for wait_s in slept)


def test_a_server_that_stays_busy_is_let_be(server: StubServer) -> None:
    """After so many times, and at once where it asks for a longer wait than one has; then nothing was done."""
    slept = list[float]()
    client = Client(server.url, "right", patience=Patience(BackOff(attempts=4, longest_s=10.0), slept.append))
    server.answers = [(*BUSY, "2")] * 9
    with pytest.raises(BusyError, match="answered 503 the store cannot be used now, and asks to wait 2 s") as told:
        client.put(squeeze())
    assert (told.value.after_s, slept, len(server.answers)) == (2.0, [2.0] * 3, 5)
    for long in ("11", "9" * 400):
        server.answers = [(*BUSY, long)]
        with pytest.raises(BusyError):
            next(client.recordings())
    assert len(slept) == 3
    assert server.kept == {}


def test_a_spool_waits_as_long_as_a_server_asks(server: StubServer, tmp_path: Path) -> None:
    """Its own waits, which are longer each time, are no shorter than that; the client adds none of its own."""
    spool, slept = Spool(tmp_path, sync=False), list[float]()
    spool.add(squeeze())
    server.answers = [(*BUSY, "7"), (*BUSY, None)]
    receiver = Client(server.url, "right", patience=Patience(sleep=lambda wait_s: pytest.fail("it waited by itself")))
    sent = list(upload(spool, receiver, back_off=BackOff(first_s=0.1), sleep=slept.append))
    assert [one.state for one in sent] == ["sent"]
    assert slept[0] == 7.0
    assert 0.1 <= slept[1] <= 0.2


def test_nobody_there(server: StubServer) -> None:
    """A server that does not answer is unreachable."""
    with pytest.raises(UnreachableError, match="no answer"):
        HttpReceiver("http://127.0.0.1:9/", "right").put(squeeze())


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("http://touch.example.org/objects", "http://touch.example.org/api/v1"),
        ("http://touch.example.org:8000/api/v1/recordings/", "http://touch.example.org:8000/api/v1"),
        ("https://touch.example.org/api/", "https://touch.example.org/api/v1"),
        ("https://touch.example.org/api/v12", "https://touch.example.org/api/v1"),
        ("https://touch.example.org/rest/", "https://touch.example.org/api/v1"),
        ("https://example.org/touch/api/v1/episodes", "https://example.org/touch/api/v1"),
        ("http://127.0.0.1:8000/enter?key=abc", "http://127.0.0.1:8000/api/v1"),
        ("http://[::1]:8000/?next=/objects", "http://[::1]:8000/api/v1"),
        ("https://touch.example.org/#top", "https://touch.example.org/api/v1"),
    ],
)
def test_an_address_that_is_another_one_is_told_with_the_right_one(given: str, meant: str) -> None:
    """That of a page, or of something inside the service, would be answered by something else, or by nothing."""
    with pytest.raises(ReceiverError) as told:
        HttpReceiver(given)
    assert str(told.value) == f"{given!r} is no address of a service, which ends in /api/v1: expected {meant}"


def test_a_password_in_an_address_is_refused_and_not_shown() -> None:
    """It would go nowhere: the token says who asks."""
    with pytest.raises(ReceiverError, match="PALPATE_TOKEN") as told:
        HttpReceiver("https://ann:secret@touch.example.org/")
    assert "secret" not in str(told.value)


@pytest.mark.parametrize(
    ("code", "body"),
    [(404, b"<html>"), (405, b""), (501, b""), (400, b"<html>"), (200, b"<!doctype html>"), (409, b"no")],
)
def test_another_kind_of_site_is_told_by_its_answers(server: StubServer, code: int, body: bytes) -> None:
    """What waits to be sent goes on waiting, and the sentence tells what address is expected."""
    server.answers = [(code, body)]
    with pytest.raises(UnreachableError, match=r"expected the address of a palpate server, as https://host/"):
        HttpReceiver(server.url, "right").put(squeeze())
    server.answers = [(code, body)]
    with pytest.raises(UnreachableError, match=r"expected the address of a palpate server, as https://host/"):
        next(Client(server.url, "right").recordings())


def test_a_server_without_tls_is_told_from_one_that_is_away(server: StubServer) -> None:
    """The address without TLS is what was probably meant."""
    with pytest.raises(UnreachableError) as told:
        HttpReceiver(server.url.replace("http://", "https://"), "right").put(squeeze())
    assert str(told.value).endswith(f", expected {server.url} where the server does without TLS")


@pytest.mark.parametrize(
    "url", ["", "http://[::1", "http://host:port/", "measurements.example.org", "file:///etc/passwd", "https://"]
)
def test_what_is_no_address_is_refused(url: str) -> None:
    """Only http and https are sent to."""
    with pytest.raises(ReceiverError, match="no address"):
        HttpReceiver(url)


@pytest.mark.parametrize(
    ("given", "meant"),
    [
        ("https://touch.example.org", "https://touch.example.org/api/v1"),
        ("http://127.0.0.1:8000/", "http://127.0.0.1:8000/api/v1"),
        ("https://touch.example.org/api/v1/", "https://touch.example.org/api/v1"),
        ("https://example.org/touch/api/v1", "https://example.org/touch/api/v1"),
    ],
)
def test_an_address_without_a_path_is_that_of_its_service(given: str, meant: str) -> None:
    """What people see of a server is its first page: its service is where it always is."""
    assert HttpReceiver(given).url == meant


def test_a_spool_arrives_after_an_outage(server: StubServer, tmp_path: Path) -> None:
    """The spool is sent through errors of the server, each recording once."""
    spool = Spool(tmp_path, sync=False)
    for second in (1, 2, 3):
        spool.add(squeeze(recorded_at=squeeze().recorded_at.replace(second=second)))
    server.answers = [(503, b""), (201, b"{}")]
    receiver = HttpReceiver(server.url, "right")
    sent = list(upload(spool, receiver, back_off=BackOff(first_s=0.0)))
    assert [one.state for one in sent] == ["sent"] * 3
    assert len(server.kept) == 3
    assert spool.waiting() == []


def test_a_wrong_token_is_an_error_and_stays_queued(server: StubServer, tmp_path: Path) -> None:
    """With a wrong token nothing is sent and nothing is lost."""
    spool = Spool(tmp_path, sync=False)
    spool.add(squeeze())
    with pytest.raises(NotAllowedError):
        list(upload(spool, HttpReceiver(server.url, "wrong")))
    assert len(spool.waiting()) == 1
    assert not server.kept


def test_the_token_comes_from_the_environment(server: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """PALPATE_TOKEN is the token unless one is given."""
    monkeypatch.setenv("PALPATE_TOKEN", "right")
    assert HttpReceiver(server.url).put(squeeze()).new


def test_a_filter_that_there_is_not_is_a_sentence() -> None:
    """Which one, what was probably meant and what there is, before anything is asked; so is what no filter can be."""
    client = Client("http://127.0.0.1:9", "right")
    with pytest.raises(RefusedError) as told:
        client.recordings(grippr="two_finger")
    said = str(told.value)
    assert said.startswith("filter 'grippr': recordings have none of that name (did you mean 'gripper'?); choose from ")
    assert "'known', 'label'" in said
    odd: Any
    for odd in (1, ["material:wood", 2], {"material": "wood"}):
        with pytest.raises(RefusedError, match=r"filter 'known': found .* expected text, a list of texts"):
            client.objects(known=odd)


def test_a_recording_is_checked_once_before_it_is_sent(server: StubServer, monkeypatch: pytest.MonkeyPatch) -> None:
    """Alone, among many, and among many by itself as it is large."""
    checked = list[Any]()
    monkeypatch.setattr("palpate.client.receiver.check", lambda recording, **_: checked.append(recording.id))
    monkeypatch.setattr("palpate.client.batches.LARGE_BYTES", 100)
    client = Client(server.url, "right")
    one, large = squeeze(), replace(squeeze(), log="x" * 200, id=uuid4())
    client.put(one)
    assert checked == [one.id]
    list(client.put_many([one, large]))
    assert checked == [one.id, one.id, large.id]
