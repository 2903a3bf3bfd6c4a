import os
from pathlib import Path

import pytest

from palpate.store.blobs import FolderBlobs
from palpate.store.errors import DamagedError
from palpate.store.records import FileItem, Recording
from palpate.store.store import Store
from palpate.store.verifying import repair, verify
from tests.store.made_up import squeeze

PICTURE = FileItem("cam0.png", "image/png", b"picture")


@pytest.fixture
def recording(local: Store) -> Recording:
    made = squeeze(files=(PICTURE,))
    local.put_many([squeeze(1), made, squeeze(2)])
    return made


def blob_path(store: Store) -> Path:
    assert isinstance(store.blobs, FolderBlobs)
    return store.blobs.folder / PICTURE.sha256[:2] / PICTURE.sha256[2:]


def change(store: Store, statement: str) -> None:
    with store.engine.begin() as connection:
        connection.exec_driver_sql(statement)


def test_a_whole_store_has_no_faults(store: Store) -> None:
    """What was put and not touched verifies; repairing it does nothing."""
    store.put_many([squeeze(1), squeeze(2, files=(PICTURE,), log="said")])
    assert list(verify(store)) == []
    assert repair(store) == []


def test_a_flipped_bit_of_a_blob_is_named_and_can_be_put_right(local: Store, recording: Recording) -> None:
    """A damaged blob is named, with its recording; set aside, it comes back when the recording is put again."""
    blob_path(local).write_bytes(b"pictuse")
    assert [fault.where for fault in verify(local)] == [f"recording {recording.id}", f"blob {PICTURE.sha256}"]
    with pytest.raises(DamagedError, match=PICTURE.sha256):
        local.get(recording.id)
    repair(local)
    assert not local.put(recording).new
    assert local.get(recording.id) == recording
    assert list(verify(local)) == []


def test_a_missing_blob_is_named(local: Store, recording: Recording) -> None:
    """A missing blob is named, and nothing that is safe can be done but to put the recording again."""
    blob_path(local).unlink()
    assert {fault.where for fault in repair(local)} == {f"recording {recording.id}", f"blob {PICTURE.sha256}"}
    local.put(recording)
    assert list(verify(local)) == []


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE entries SET value = 1 WHERE recording_id = 2",
        "DELETE FROM entries WHERE recording_id = 2",
        "UPDATE recordings SET action = 'weighing' WHERE id = 2",
        "UPDATE recordings SET recorded_us = 5 WHERE id = 2",
    ],
)
def test_rows_for_queries_are_made_again(local: Store, recording: Recording, statement: str) -> None:
    """Rows that disagree with the content are found and mended."""
    change(local, statement)
    assert [fault.where for fault in repair(local)] == [f"recording {recording.id}"]
    assert list(verify(local)) == []


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE recordings SET thing_id = (SELECT max(id) FROM things) WHERE id = 2",
        "UPDATE recordings SET document = replace(document, 'squeezing', 'weighing') WHERE id = 2",
        "UPDATE series SET data = (SELECT data FROM series WHERE recording_id = 1) WHERE recording_id = 2",
        "UPDATE series SET data = x'00' WHERE recording_id = 2",
        "DELETE FROM series WHERE recording_id = 2",
    ],
)
def test_changed_content_is_named_and_left_alone(local: Store, recording: Recording, statement: str) -> None:
    """A recording that is not what was put is named, never returned, and never overwritten by repair."""
    change(local, statement)
    faults = repair(local)
    assert [(fault.where, fault.remedy) for fault in faults] == [(f"recording {recording.id}", None)]
    assert len(list(verify(local))) == 1


def test_a_changed_setup_is_named(local: Store, recording: Recording) -> None:
    """A setup whose content is not the one of its digest is named."""
    change(local, "UPDATE setups SET document = replace(document, 'two_finger', 'one_finger')")
    assert any(fault.where == f"setups {recording.setup.digest}" for fault in verify(local))


def test_only_old_blobs_without_a_recording_are_removed(local: Store, recording: Recording) -> None:
    """A blob that nothing refers to is removed a day after it was written, as it may be of a recording on its way."""
    orphan = FileItem("a", "x/y", b"orphan")
    local.blobs.put(orphan.sha256, b"orphan")
    assert list(verify(local)) == []
    assert isinstance(local.blobs, FolderBlobs)
    path = local.blobs.folder / orphan.sha256[:2] / orphan.sha256[2:]
    os.utime(path, (0, 0))
    os.utime(blob_path(local), (0, 0))
    assert [fault.where for fault in repair(local)] == [f"blob {orphan.sha256}"]
    assert not path.exists()
    assert local.get(recording.id) == recording
