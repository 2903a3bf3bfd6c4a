import errno
import os
import time
from hashlib import sha256
from pathlib import Path

import pytest

from palpate.store import blobs as store_blobs
from palpate.store import bucket, durable
from palpate.store.blobs import Blobs, FolderBlobs
from palpate.store.errors import DamagedError, StoreError, UnavailableError, UnreadableError
from tests.store.places import blobs_of, check_services, damage

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
    assert blobs.remove(DIGEST)
    assert not list(blobs.all())


def test_parts_come_back(blobs: Blobs) -> None:
    """Pieces are those from one place to another; what is missing or cut short is an error and no fewer bytes."""
    data = bytes(range(250)) * 10_000
    digest = sha256(data).hexdigest()
    with pytest.raises(DamagedError, match=f"blob {digest}: is missing"):
        blobs.size_bytes(digest)
    with pytest.raises(DamagedError, match=f"blob {digest}: is missing"):
        list(blobs.pieces(digest, 0, 3))
    blobs.put(digest, data)
    assert blobs.size_bytes(digest) == len(data)
    for start, end in ((0, len(data)), (5, 5), (1, 2), (store_blobs.PIECE_BYTES - 1, len(data))):
        pieces = list(blobs.pieces(digest, start, end))
        assert b"".join(pieces) == data[start:end]
        # a store in memory gives at once what it has there
        assert (
            getattr(blobs, "url", "").startswith("memory:")
            or max(map(len, pieces), default=0) <= 2 * store_blobs.PIECE_BYTES
        )
    damage(blobs, digest, data[:1000])
    with pytest.raises(DamagedError, match=f"blob {digest}: ends 10 bytes early"):
        list(blobs.pieces(digest, 990, 1010))


def test_only_what_is_old_is_removed(blobs: Blobs) -> None:
    """What was written after a time stays and can be read; what is not there cannot be removed."""
    blobs.put(DIGEST, DATA)
    ((_, written),) = blobs.all()
    assert not blobs.remove(DIGEST, written)
    assert blobs.get(DIGEST) == DATA
    assert blobs.remove(DIGEST, written + 1)
    assert not blobs.remove(DIGEST, written + 1)
    assert not list(blobs.all())


def test_putting_again_makes_an_old_blob_young(blobs: Blobs, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bytes that are there already count as written now: a program that is just putting them relies on them."""
    blobs.put(DIGEST, DATA)
    ((_, written),) = blobs.all()
    if isinstance(blobs, FolderBlobs):
        os.utime(blobs.folder / DIGEST[:2] / DIGEST[2:], (0, 0))
        blobs.put(DIGEST, DATA)
    else:
        time.sleep(1.1)  # services tell whole seconds
        blobs.put(DIGEST, DATA)
        assert dict(blobs.all()) == {DIGEST: written}, "what is hours old at most is not sent again"
        monkeypatch.setattr(bucket, "RENEWED_S", 0.0)
        blobs.put(DIGEST, DATA)
        assert dict(blobs.all())[DIGEST] > written
    ((_, again),) = blobs.all()
    assert again >= written - 1


def test_the_names_of_new_folders_are_on_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """When a blob is put, each new folder on the way to it is known to the disk by its parent."""
    synced = set[Path]()
    for module in (durable, store_blobs):
        monkeypatch.setattr(module, "sync_folder", synced.add)
    blobs = FolderBlobs(tmp_path / "lab" / "blobs")
    blobs.put(DIGEST, DATA)
    chain = {tmp_path, tmp_path / "lab", blobs.folder, blobs.folder / DIGEST[:2]}
    assert synced == chain
    synced.clear()
    # another process may have made them, and may not be done
    FolderBlobs(blobs.folder).put(other := DIGEST[:2] + "0" * 62, DATA)
    assert synced >= {blobs.folder.parent, blobs.folder, blobs.folder / other[:2]}


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


def test_only_blobs_are_listed(tmp_path: Path) -> None:
    """What else lies in the folder is not told, as what is told and referred to by nothing is removed."""
    blobs = FolderBlobs(tmp_path)
    blobs.put(DIGEST, DATA)
    (tmp_path / "ab").mkdir(exist_ok=True)
    for name in ("ab/README", f"ab/{DIGEST[2:].upper()}", "notes.txt"):
        (tmp_path / name).write_text("ours")
    assert [digest for digest, _ in blobs.all()] == [DIGEST]


def test_a_folder_that_cannot_be_written_to_is_an_error(tmp_path: Path) -> None:
    """Where there is a file in place of the folder, putting is refused in one sentence."""
    (tmp_path / "blobs").write_text("a file")
    with pytest.raises(UnavailableError, match=r"blobs '.*': (Not a directory|File exists), expected a folder"):
        FolderBlobs(tmp_path / "blobs").put(DIGEST, DATA)


def test_a_file_that_is_gone_is_named(tmp_path: Path) -> None:
    """A file that was removed since it was looked at is named, and nothing is kept."""
    blobs = FolderBlobs(tmp_path / "blobs")
    with pytest.raises(StoreError, match=r"cam0.png: No such file or directory, expected a file that can be read"):
        blobs.put(DIGEST, tmp_path / "cam0.png")
    assert [path for path in blobs.folder.rglob("*") if path.is_file()] == []


@pytest.mark.parametrize(
    ("number", "expected", "message"),
    [
        (errno.EIO, DamagedError, r"blob .*: cannot be read in .* \(Input/output error\), expected what was written"),
        (errno.EACCES, UnreadableError, r"blob .*: cannot be read in .* \(Permission denied\), expected a file"),
    ],
)
def test_a_disk_that_fails_is_told_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int, expected: type[StoreError], message: str
) -> None:
    """A spoilt file is a damaged blob, which verification names; one that may not be read is not."""
    blobs = FolderBlobs(tmp_path)
    blobs.put(DIGEST, DATA)

    def fail(path: Path) -> bytes:
        raise OSError(number, os.strerror(number), str(path))

    monkeypatch.setattr(Path, "read_bytes", fail)
    with pytest.raises(expected, match=message) as found:
        blobs.get(DIGEST)
    assert type(found.value) is expected


def test_a_folder_in_place_of_a_blob_is_damage(tmp_path: Path) -> None:
    """It is told as any other, and can be set aside."""
    blobs = FolderBlobs(tmp_path)
    (tmp_path / DIGEST[:2] / DIGEST[2:]).mkdir(parents=True)
    with pytest.raises(DamagedError, match=f"blob {DIGEST}: cannot be read"):
        blobs.get(DIGEST)
    blobs.set_aside(DIGEST)
    blobs.put(DIGEST, DATA)
    assert blobs.get(DIGEST) == DATA


def test_a_blob_that_goes_while_all_are_listed_is_left_out(tmp_path: Path) -> None:
    """Somebody may remove blobs at the same time."""
    blobs, others = FolderBlobs(tmp_path), [f"{digit}{DIGEST[1:]}" for digit in "012"]
    for digest in others:
        (tmp_path / digest[:2]).mkdir()
        (tmp_path / digest[:2] / digest[2:]).write_bytes(DATA)
    listed = blobs.all()
    first, _ = next(listed)
    blobs.remove(others[1])
    assert [first, *(digest for digest, _ in listed)] == [others[0], others[2]]
