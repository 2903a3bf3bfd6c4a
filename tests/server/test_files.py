"""Files of any size: in part, only where they are others, in pieces, and from the bucket that has them."""

import hashlib
import socket
from collections.abc import Iterator
from http.client import IncompleteRead
from pathlib import Path
from urllib.parse import parse_qs, urlsplit
from urllib.request import Request, urlopen

import botocore.session  # type: ignore[import-untyped]
import pytest
from botocore.config import Config  # type: ignore[import-untyped]
from fastapi.testclient import TestClient

from palpate.cli import main
from palpate.server.app import application
from palpate.server.settings import Settings
from palpate.store.blobs import PIECE_BYTES
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from palpate.store.signing import signed_again
from palpate.store.store import Store
from tests.server.serving import free_port, listening, served
from tests.store.made_up import squeeze
from tests.store.places import check_services, damage, new_bucket

API = "/api/v1/recordings"
PNG = b"\x89PNG\r\n\x1a\n" + bytes(range(256))
LARGE = bytes(range(251)) * (3 * PIECE_BYTES // 251)
SECRET = "wJalrXUtnFEMI/K7MDENG/bPxRfiCYEXAMPLEKEY"


def kept(store: Store, data: bytes, name: str = "scan.bin", kind: str = "application/pdf", **more: str) -> str:
    """Put a recording with a file, and give the file's address."""
    recording = squeeze(visibility=more.get("visibility", "public"), files=(FileItem(name, kind, data),))
    store.put(recording)
    return f"{API}/{recording.id}/files/0"


@pytest.mark.parametrize("data", [PNG, LARGE], ids=["small", "large"])
def test_ranges_are_parts_of_the_file(client: TestClient, store: Store, data: bytes) -> None:
    """Each range is what Python's slices say, also over the ends of pieces."""
    address, size = kept(store, data), len(data)
    assert client.get(address).content == data
    for start, end in [(0, 1), (5, 9), (size - 1, size), (0, size), (size // 2, size // 2 + PIECE_BYTES % size + 1)]:
        part = client.get(address, headers={"Range": f"bytes={start}-{end - 1}"})
        assert (part.status_code, part.content) == (206, data[start:end])
        assert part.headers["content-range"] == f"bytes {start}-{min(end, size) - 1}/{size}"
        assert int(part.headers["content-length"]) == len(part.content)


def test_only_what_is_asked_for_is_read(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """A range of a large file, and the headers alone, do not read the file."""
    address = kept(store, LARGE)
    read = list[tuple[int, int]]()
    pieces = store.blobs.pieces

    def noted(digest: str, start: int, end: int) -> Iterator[bytes]:
        read.append((start, end))
        return pieces(digest, start, end)

    monkeypatch.setattr(store.blobs, "pieces", noted)
    monkeypatch.setattr(store.blobs, "get", lambda _: pytest.fail("the whole file is read"))
    assert client.get(address, headers={"Range": "bytes=2000000-2000009"}).content == LARGE[2000000:2000010]
    assert int(client.head(address).headers["content-length"]) == len(LARGE)
    assert client.get(address, headers={"If-None-Match": f'"{hashlib.sha256(LARGE).hexdigest()}"'}).status_code == 304
    # the rest is a look at how it begins, for its type
    assert sum(end - start for start, end in read) < 200


def test_conditions(client: TestClient, store: Store) -> None:
    """Who has it gets nothing, and who has a part of another one gets all."""
    address = kept(store, PNG)
    etag = client.get(address).headers["etag"]
    for known in (etag, f"W/{etag}", f'"other", {etag}', "*"):
        found = client.get(address, headers={"If-None-Match": known})
        assert (found.status_code, found.content, found.headers["etag"]) == (304, b"", etag)
    assert client.get(address, headers={"If-None-Match": '"other"'}).content == PNG
    part = {"Range": "bytes=1-2"}
    assert client.get(address, headers={**part, "If-Range": etag}).content == PNG[1:3]
    for other in ('"other"', f"W/{etag}", "Wed, 21 Oct 2015 07:28:00 GMT"):
        assert client.get(address, headers={**part, "If-Range": other}).content == PNG


def test_a_large_file_that_is_damaged_never_arrives_whole(store: Store) -> None:
    """Its last piece is not sent, so that whoever asks knows."""
    address = kept(store, LARGE)
    damage(store.blobs, hashlib.sha256(LARGE).hexdigest(), LARGE[:-1] + b"?")
    with listening(application(store, Settings())) as there:
        with urlopen(f"{there}{address}") as found, pytest.raises(IncompleteRead) as ended:
            found.read()
        with urlopen(Request(f"{there}{address}", headers={"Range": "bytes=0-9"})) as found:
            assert found.read() == LARGE[:10]
    assert 0 < len(ended.value.partial) < len(LARGE)


def test_a_large_file_takes_little_memory(tmp_path: Path) -> None:
    """While 128 MiB are sent the server grows by far less; the digest of what came is that of the file."""
    place, path = tmp_path / "store.sqlite", tmp_path / "scan.bin"
    with path.open("wb") as opened:
        for number in range(128):
            opened.write(number.to_bytes(4, "big") * (PIECE_BYTES // 4))
    with open_store(place) as store:
        item = FileItem("scan.bin", "application/pdf", path)
        recording = squeeze(visibility="public", files=(item,))
        store.put(recording)
    with served(place) as (address, process):
        url = f"{address}{API}/{recording.id}/files/0"
        urlopen(Request(url, headers={"Range": "bytes=0-1"})).read()
        before, hashed = peak_mb(process.pid), hashlib.sha256()
        with urlopen(url) as found:
            while piece := found.read(PIECE_BYTES):
                hashed.update(piece)
        assert hashed.hexdigest() == item.sha256
        assert peak_mb(process.pid) - before < 32


def peak_mb(process: int) -> float:
    """The most memory that a process has had [MB]."""
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmHWM")) / 1024


def test_signatures_are_those_of_amazon() -> None:
    """botocore signs the same parameters of the same address to the same signature."""
    session = botocore.session.Session()
    session.set_credentials("AKIAIOSFODNN7EXAMPLE", SECRET)
    there = Config(signature_version="s3v4", s3={"addressing_style": "path"})
    client = session.create_client("s3", "eu-west-1", endpoint_url="https://s3.example.org:9000", config=there)
    plain = {"Bucket": "lab", "Key": "ab/cd"}
    more = {
        "ResponseContentType": "text/plain",
        "ResponseContentDisposition": "attachment; filename*=UTF-8''a%20b~.bin",
    }
    expected = client.generate_presigned_url("get_object", {**plain, **more}, ExpiresIn=60)
    bare = client.generate_presigned_url("get_object", plain, ExpiresIn=60)
    found = signed_again(
        bare.replace(query(bare)["X-Amz-Date"][0], query(expected)["X-Amz-Date"][0]),
        {
            "response-content-type": more["ResponseContentType"],
            "response-content-disposition": more["ResponseContentDisposition"],
        },
        SECRET,
    )
    assert query(found) == query(expected)
    assert urlsplit(found)[:3] == urlsplit(expected)[:3]


def query(url: str) -> dict[str, list[str]]:
    """The parameters of an address."""
    return parse_qs(urlsplit(url).query, strict_parsing=True)


@pytest.fixture
def bucket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Store]:
    """A store with its blobs in S3."""
    check_services("s3")
    with open_store(tmp_path / "store.sqlite", new_bucket(monkeypatch)) as store:
        yield store


def test_the_bucket_answers_for_a_while(bucket: Store) -> None:
    """Who may see a file is sent to the bucket, where it is a download of no type under its name."""
    address = kept(bucket, b"<html>", "cam/evil page.html", "text/html")
    hidden = kept(bucket, LARGE, visibility="private")
    picture = kept(bucket, PNG, "front.png", "image/png", visibility="public")
    with TestClient(application(bucket, Settings(signed_urls=True)), follow_redirects=False) as client:
        sent = client.get(address)
        assert (sent.status_code, sent.headers["cache-control"]) == (307, "no-store")
        url = sent.headers["location"]
        assert query(url)["X-Amz-Expires"] == ["60"]
        with urlopen(Request(url, headers={"Range": "bytes=1-4"})) as found:
            assert (found.status, found.read()) == (206, b"html")
            assert found.headers["content-type"] == "application/octet-stream"
            assert found.headers["content-disposition"] == "attachment; filename*=UTF-8''evil%20page.html"
        assert client.head(address).status_code == 200
        assert client.get(hidden).status_code == 404
        assert client.get(picture).content == PNG


def test_without_leave_the_server_answers(bucket: Store) -> None:
    """Nobody is sent anywhere unless whoever runs it says so."""
    address = kept(bucket, LARGE)
    with TestClient(application(bucket, Settings()), follow_redirects=False) as client:
        assert client.get(address).content == LARGE
        assert client.get(address, headers={"Range": "bytes=2000000-2000009"}).content == LARGE[2000000:2000010]


def test_addresses_need_a_bucket_and_a_key(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Where there is none, the server does not begin, and says what would be right, before it looks at its port."""
    monkeypatch.delenv("AWS_SECRET_ACCESS_KEY", raising=False)
    monkeypatch.setenv("AWS_REGION", "eu-west-1")
    with socket.create_server(("127.0.0.1", 0)) as other:
        for port in (free_port(), other.getsockname()[1]):
            command = ["serve", "--signed-urls", "--store", str(tmp_path / "store.sqlite"), "--port", str(port)]
            assert "the blobs are in a folder, expected a bucket such as" in told_by(command, capsys)
            keyless = told_by([*command, "--blobs", "s3://lab/b"], capsys)
            assert "expected a bucket of S3 and AWS_SECRET_ACCESS_KEY" in keyless
    assert list(tmp_path.iterdir()) == []


def told_by(command: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    """What a command that is refused says."""
    with pytest.raises(SystemExit) as ended:
        main(command)
    assert ended.value.code == 2
    return capsys.readouterr().err
