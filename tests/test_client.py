import io
import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from palpate.client import HttpReceiver, NotAllowedError, ReceiverError, RefusedError, UnreachableError
from palpate.recording.spool import Spool
from palpate.recording.uploading import BackOff, upload
from palpate.store.importing.package import unpack
from tests.store.importing.invented import squeeze


class StubServer(ThreadingHTTPServer):
    """A server with a dictionary for a store; `answers` come first, one for each request."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.kept: dict[str, Any] = {}
        self.answers: list[tuple[int, bytes]] = []

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_address[1]}/api"


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
        assert self.path == f"/api/recordings/{found.digest}"
        new = found.digest not in self.server.kept
        self.server.kept[found.digest] = found
        answer = {"id": str(found.id), "digest": found.digest, "new": new}
        self.reply(201 if new else 200, json.dumps(answer).encode())

    def reply(self, code: int, body: bytes) -> None:
        self.send_response(code)
        self.send_header("Content-Length", str(len(body)))
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
        HttpReceiver(server.url, "right").put(squeeze())


def test_nobody_there(server: StubServer) -> None:
    """A server that does not answer is unreachable."""
    with pytest.raises(UnreachableError, match="no answer"):
        HttpReceiver("http://127.0.0.1:9/", "right").put(squeeze())


@pytest.mark.parametrize("url", ["", "measurements.example.org", "file:///etc/passwd", "https://"])
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
