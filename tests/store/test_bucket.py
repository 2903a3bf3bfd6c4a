import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import obstore
import pytest

from palpate.cli import main
from palpate.store.bucket import BucketBlobs
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from tests.store.made_up import squeeze
from tests.store.places import check_services, new_bucket

DATA = b"a picture"
DIGEST = sha256(DATA).hexdigest()
USES: dict[str, Callable[[BucketBlobs], object]] = {
    "get": lambda blobs: blobs.get(DIGEST),
    "put": lambda blobs: blobs.put(DIGEST, DATA),
    "all": lambda blobs: list(blobs.all()),
    "remove": lambda blobs: blobs.remove(DIGEST),
    "set aside": lambda blobs: blobs.set_aside(DIGEST),
}
WRONG_KEY = b"<Error><Code>InvalidAccessKeyId</Code><Message>The key does not exist.</Message></Error>"


class NoOneIsLetIn(BaseHTTPRequestHandler):
    """A store to which no key fits."""

    def answer(self) -> None:
        self.send_response(403)
        self.send_header("Content-Length", str(len(WRONG_KEY)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(WRONG_KEY)

    do_GET = do_HEAD = do_PUT = do_POST = do_DELETE = answer  # noqa: N815

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


@contextmanager
def closed_store() -> Iterator[str]:
    with ThreadingHTTPServer(("127.0.0.1", 0), NoOneIsLetIn) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture
def keys(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """An environment with keys and without a store."""
    for name in [name for name in os.environ if name.startswith("AWS_")]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("AWS_ACCESS_KEY_ID", "somebody")
    monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
    return monkeypatch


def told_by(use: str, url: str) -> str:
    """The one sentence that a use of a bucket raises."""
    with pytest.raises(UnavailableError) as told:
        USES[use](BucketBlobs(url))
    assert "\n" not in str(told.value)
    return str(told.value)


@pytest.mark.parametrize("url", ["ftp://lab/blobs", "s3:/lab", "nonsense://x"])
def test_other_addresses_are_an_error(url: str) -> None:
    """What is no address of a bucket is told in one sentence."""
    with pytest.raises(StoreError, match=r"blobs '.*'.*expected a bucket") as told:
        BucketBlobs(url)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("use", ["get", "put", "all"])
def test_a_bucket_that_is_not_there_is_an_error(use: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A bucket that nobody made is said to be missing, and not what would be in it."""
    check_services("s3")
    new_bucket(monkeypatch)
    said = "blobs 's3://nobody-made-this/blobs': there is no such bucket, expected one that was made before"
    assert told_by(use, "s3://nobody-made-this/blobs") == said


@pytest.mark.parametrize("use", USES)
def test_wrong_keys_are_an_error(use: str, keys: pytest.MonkeyPatch) -> None:
    """Who is not let in is told so, with what the store says and which keys are meant, and without the secret."""
    with closed_store() as address:
        keys.setenv("AWS_ENDPOINT_URL", address)
        said = told_by(use, "s3://lab/blobs")
    assert said.startswith("blobs 's3://lab/blobs': access is denied")
    assert "AWS_ACCESS_KEY_ID" in said
    assert "secret" not in said
    assert use in ("put", "set aside", "remove") or "(InvalidAccessKeyId: The key does not exist.)" in said


@pytest.mark.parametrize("variable", ["AWS_ENDPOINT_URL", "AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT"])
def test_a_service_that_does_not_answer_is_an_error(variable: str, keys: pytest.MonkeyPatch) -> None:
    """Where nothing listens, each use is one sentence after some tries; each of the usual variables is heeded."""
    keys.setenv(variable, "http://127.0.0.1:9")
    said = told_by("get", "s3://lab/blobs")
    assert said.startswith(
        "blobs 's3://lab/blobs': no answer from http://127.0.0.1:9 (error sending request), expected"
    )


def test_only_blobs_are_listed() -> None:
    """Other objects in the bucket are not told, as what is told and referred to by nothing is removed."""
    blobs = BucketBlobs("memory:///")
    blobs.put(DIGEST, DATA)
    for key in (f"{DIGEST[:4]}/{DIGEST[4:]}", DIGEST, "photos/2024/mug.png", f"{DIGEST[:2]}/{DIGEST[2:]}.damaged"):
        obstore.put(blobs._store, key, b"ours")
    assert [digest for digest, _ in blobs.all()] == [DIGEST]


def test_two_prefixes_of_one_bucket_are_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was put under one prefix is not there under another."""
    check_services("s3")
    url = new_bucket(monkeypatch)
    one, other = BucketBlobs(url + "/one"), BucketBlobs(url + "/other")
    one.put(DIGEST, DATA)
    assert not list(other.all())
    with pytest.raises(DamagedError, match="is missing"):
        other.get(DIGEST)


def test_a_large_file_goes_up_in_parts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A file of more than one part comes back whole, and its digest is checked before."""
    check_services("s3")
    blobs, path = BucketBlobs(new_bucket(monkeypatch)), tmp_path / "video.mp4"
    path.write_bytes(bytes(range(256)) * (12 << 12))
    digest = sha256(path.read_bytes()).hexdigest()
    blobs.put(digest, path)
    assert blobs.get(digest) == path.read_bytes()
    with pytest.raises(DamagedError, match="changed while it was read"):
        blobs.put(DIGEST, path)
    assert [found for found, _ in blobs.all()] == [digest]


def test_the_command_line_finds_a_bucket_by_the_environment(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """PALPATE_BLOBS and the AWS variables are all that is needed; a bucket that is not there ends in one sentence."""
    check_services("s3")
    monkeypatch.setenv("PALPATE_BLOBS", new_bucket(monkeypatch))
    monkeypatch.setenv("PALPATE_STORE", str(tmp_path / "store.sqlite"))
    with open_store() as store:
        store.put(squeeze(files=(FileItem("cam0.png", "image/png", DATA),)))
    codes = [run("verify")]
    monkeypatch.setenv("PALPATE_BLOBS", "s3://nobody-made-this")
    codes.append(run("verify"))
    assert codes == [0, 2]
    out, err = capsys.readouterr()
    assert out == "all is as it was written\n"
    assert err.startswith("palpate: blobs 's3://nobody-made-this': there is no such bucket")


def run(command: str) -> object:
    with pytest.raises(SystemExit) as ended:
        main(["store", command])
    return ended.value.code
