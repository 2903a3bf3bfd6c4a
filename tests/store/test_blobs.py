from hashlib import sha256
from pathlib import Path

import pytest

from palpate.store.blobs import Blobs
from palpate.store.bucket import BucketBlobs
from palpate.store.errors import DamagedError, StoreError
from tests.store.places import S3, blobs_of, check_services, new_bucket

DATA = b"a picture"
DIGEST = sha256(DATA).hexdigest()


@pytest.fixture(params=["sqlite", "bucket", "s3"])
def blobs(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Blobs:
    check_services(request.param)
    return blobs_of(request.param, tmp_path, monkeypatch)


def test_bytes_come_back(blobs: Blobs, tmp_path: Path) -> None:
    """Bytes and files come back under their digest; putting again changes nothing."""
    path = tmp_path / "picture.png"
    path.write_bytes(b"another")
    other = sha256(b"another").hexdigest()
    blobs.put(DIGEST, DATA)
    blobs.put(DIGEST, DATA)
    blobs.put(other, path)
    assert (blobs.get(DIGEST), blobs.get(other)) == (DATA, b"another")
    assert {digest for digest, _ in blobs.all()} == {DIGEST, other}


def test_what_is_missing_or_set_aside_is_never_returned(blobs: Blobs) -> None:
    """Missing bytes are an error; after setting damaged ones aside the right ones can be put again."""
    with pytest.raises(DamagedError, match=f"blob {DIGEST}: is missing"):
        blobs.get(DIGEST)
    blobs.put(DIGEST, DATA)
    blobs.set_aside(DIGEST)
    assert not list(blobs.all())
    blobs.put(DIGEST, DATA)
    assert blobs.get(DIGEST) == DATA
    blobs.remove(DIGEST)
    assert not list(blobs.all())


def test_other_bytes_are_never_returned(blobs: Blobs) -> None:
    """Bytes that are not those of the digest are an error that names it."""
    wrong = sha256(b"other").hexdigest()
    blobs.put(wrong, DATA)
    with pytest.raises(DamagedError, match=f"blob {wrong}: 9 bytes in .* are not the ones that were written"):
        blobs.get(wrong)


def test_a_file_that_changed_is_not_kept(blobs: Blobs, tmp_path: Path) -> None:
    """A file that is no longer what its digest was taken of is refused, and nothing is kept."""
    path = tmp_path / "picture.png"
    path.write_bytes(b"changed")
    with pytest.raises(DamagedError, match="changed while it was read"):
        blobs.put(DIGEST, path)
    assert not list(blobs.all())
    assert not [left for left in (tmp_path / "blobs").glob("*/*") if left.is_file()]


@pytest.mark.parametrize("url", ["ftp://lab/blobs", "s3:/lab", "nonsense://x"])
def test_other_addresses_are_an_error(url: str) -> None:
    """What is no address of a bucket is told in one sentence."""
    with pytest.raises(StoreError, match=r"blobs '.*'.*expected a bucket") as told:
        BucketBlobs(url)
    assert "\n" not in str(told.value)


def test_a_bucket_that_is_not_there_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bytes cannot be put into a bucket that nobody made."""
    check_services("s3")
    new_bucket(monkeypatch)
    blobs = BucketBlobs("s3://nobody-made-this/blobs")
    with pytest.raises(StoreError, match="no such bucket"):
        blobs.put(DIGEST, DATA)
    with pytest.raises(StoreError, match="expected a bucket that answers"):
        list(blobs.all())


def test_a_service_that_does_not_answer_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing listens, each use is one sentence after some tries."""
    check_services("s3")
    new_bucket(monkeypatch)
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:9")
    with pytest.raises(StoreError, match="error sending request") as told:
        BucketBlobs("s3://lab/blobs").get(DIGEST)
    assert S3 is not None
    assert "\n" not in str(told.value)
