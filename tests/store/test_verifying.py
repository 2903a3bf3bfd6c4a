import errno
import os
from functools import partial
from hashlib import sha256
from pathlib import Path

import pytest
from sqlalchemy import event

from palpate.store import verifying
from palpate.store.blobs import FolderBlobs
from palpate.store.describing import change_thing, keep_image
from palpate.store.errors import DamagedError, UnavailableError
from palpate.store.faults import Fault, Remedy
from palpate.store.records import FileItem, Recording
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.undoing import undo
from palpate.store.verifying import repair, verify
from tests.store.made_up import squeeze

DATA = b"picture"
PICTURE = FileItem("cam0.png", "image/png", DATA)


@pytest.fixture
def recording(local: Store) -> Recording:
    made = squeeze(files=(PICTURE,))
    local.put_many([squeeze(1), made, squeeze(2)])
    return made


def blob_path(store: Store, file: FileItem = PICTURE) -> Path:
    assert isinstance(store.blobs, FolderBlobs)
    return store.blobs.folder / file.sha256[:2] / file.sha256[2:]


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
    (fault,) = verify(local)
    assert (fault.where, f"needed by recording {recording.id}" in fault.what) == (f"blob {PICTURE.sha256}", True)
    with pytest.raises(DamagedError, match=PICTURE.sha256):
        local.get(recording.id)
    (fault,) = repair(local)
    assert (fault.done, fault.mended) == (True, False)
    assert not local.put(recording).new
    assert local.get(recording.id) == recording
    assert list(verify(local)) == []


def test_a_blob_that_may_not_be_read_holds_up_nothing(
    local: Store, recording: Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is a fault with the recording that needs it, what is lost besides is found too, and it stays where it is."""
    lost, closed = FileItem("cam1.png", "image/png", b"another"), blob_path(local)
    later = squeeze(3, files=(lost,))
    local.put(later)
    blob_path(local, lost).unlink()
    read = Path.read_bytes

    def refuse(path: Path) -> bytes:
        # nothing is closed to root
        if path == closed:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return read(path)

    monkeypatch.setattr(Path, "read_bytes", refuse)
    for faults in (list(verify(local)), repair(local)):
        found = {fault.where: fault for fault in faults}
        assert set(found) == {f"blob {PICTURE.sha256}", f"blob {lost.sha256}"}
        fault = found[f"blob {PICTURE.sha256}"]
        assert "Permission denied" in fault.what
        assert f"needed by recording {recording.id}" in fault.what
        assert (fault.remedy, fault.done) == (None, False)
    assert closed.exists()


@pytest.mark.skipif(os.geteuid() == 0, reason="nothing is closed to root")
@pytest.mark.parametrize("level", ["file", "folder", "all"])
def test_what_the_system_closes_is_told(local: Store, recording: Recording, level: str) -> None:
    """Whether the file, its folder or all of them may not be read."""
    path = {"file": blob_path(local), "folder": blob_path(local).parent, "all": blob_path(local).parent.parent}[level]
    before = path.stat().st_mode
    path.chmod(0)
    try:
        (fault,) = verify(local)
    finally:
        path.chmod(before)
    assert (fault.where, "Permission denied" in fault.what) == (f"blob {PICTURE.sha256}", True)


def test_a_missing_blob_is_named(local: Store, recording: Recording) -> None:
    """A missing blob is named, and nothing that is safe can be done but to put the recording again."""
    blob_path(local).unlink()
    assert [(fault.where, fault.done) for fault in repair(local)] == [(f"blob {PICTURE.sha256}", False)]
    local.put(recording)
    assert list(verify(local)) == []


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE entries SET value = 1 WHERE recording_id = 2",
        "DELETE FROM entries WHERE recording_id = 2",
        "UPDATE recordings SET action = 'weighing' WHERE id = 2",
        "UPDATE recordings SET recorded_us = 5 WHERE id = 2",
        "UPDATE recordings SET seal = NULL WHERE id = 2",
        "UPDATE entries SET value_si = 'mug' WHERE recording_id = 2",
    ],
)
def test_rows_for_queries_are_made_again(local: Store, recording: Recording, statement: str) -> None:
    """Rows that disagree with the content are found and mended."""
    change(local, statement)
    assert [(fault.where, fault.mended) for fault in repair(local)] == [(f"recording {recording.id}", True)]
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


def old_blob(store: Store, data: bytes) -> Path:
    """A blob that was written long ago and that nothing refers to."""
    digest = sha256(data).hexdigest()
    store.blobs.put(digest, data)
    assert isinstance(store.blobs, FolderBlobs)
    path = store.blobs.folder / digest[:2] / digest[2:]
    os.utime(path, (0, 0))
    return path


def test_pictures_that_an_undo_needs_are_kept(local: Store, recording: Recording) -> None:
    """A picture that was replaced is in no table of pictures, and an undo shows it again: repair leaves it."""
    for data in (b"first", b"second"):
        image = keep_image(local, "front.png", "image/png", data)
        change_thing(local, recording.thing, partial(Thing.showing, image=image))
    path = old_blob(local, b"first")
    assert repair(local) == []
    undo(local, recording.thing)
    assert list(verify(local)) == []
    path.unlink()
    assert [fault.what.partition("; ")[2] for fault in verify(local)] == ["needed by object made_up/object0"]


def test_a_picture_that_only_an_undo_needs_is_verified(local: Store, recording: Recording) -> None:
    """Where it is lost, the fault says what for it is needed."""
    for data in (b"first", b"second"):
        image = keep_image(local, "front.png", "image/png", data)
        change_thing(local, recording.thing, partial(Thing.showing, image=image))
    old_blob(local, b"first").unlink()
    assert [fault.what.partition("; ")[2] for fault in verify(local)] == [
        "needed by an undo for object made_up/object0"
    ]


@pytest.mark.parametrize("is_committed", [True, False])
def test_a_blob_that_a_put_relies_on_is_not_removed(
    local: Store, monkeypatch: pytest.MonkeyPatch, is_committed: bool
) -> None:
    """Whoever puts an old blob again makes it young, also between verifying and removing; so it stays."""
    path = old_blob(local, DATA)
    found = list(verify(local))
    assert [fault.remedy for fault in found] == [Remedy.REMOVE]

    def meanwhile(store: Store) -> list[Fault]:
        if is_committed:
            local.put(squeeze(files=(PICTURE,)))
        else:
            local.blobs.put(PICTURE.sha256, DATA)
        return found

    monkeypatch.setattr(verifying, "verify", meanwhile)
    assert [fault.done for fault in repair(local)] == [False]
    assert path.read_bytes() == DATA


def test_a_blob_that_was_put_right_meanwhile_is_not_set_aside(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Verifying takes its time: what somebody has mended by then stays where it is needed."""
    local.put(made := squeeze(files=(PICTURE,)))
    blob_path(local).write_bytes(b"pictuse")
    found = list(verify(local))
    local.blobs.set_aside(PICTURE.sha256)
    local.put(made)
    monkeypatch.setattr(verifying, "verify", lambda store: found)
    assert [fault.done for fault in repair(local)] == [False]
    assert local.get(made.id) == made


def test_rows_that_cannot_be_written_are_told_in_one_sentence(local: Store, recording: Recording) -> None:
    """Where the database takes no changes, it is told so and nothing is changed."""
    change(local, f"UPDATE recordings SET action = 'other' WHERE uuid = x'{recording.id.hex}'")
    event.listen(local.engine, "begin", lambda connection: connection.exec_driver_sql("PRAGMA query_only = ON"))
    with pytest.raises(UnavailableError, match=r"store .*: attempt to write a readonly database; nothing was changed"):
        repair(local)


def test_what_is_referred_to_by_now_is_not_removed(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """References are looked up again before anything is removed, however old it is."""
    path = old_blob(local, DATA)
    found = list(verify(local))
    local.put(squeeze(files=(PICTURE,)))
    os.utime(path, (0, 0))
    monkeypatch.setattr(verifying, "verify", lambda store: found)
    assert [fault.done for fault in repair(local)] == [False]
    assert path.exists()


def test_nothing_is_removed_where_the_audit_cannot_be_read(local: Store, recording: Recording) -> None:
    """Where it is not known what is referred to, no blob is a left-over one."""
    change_thing(local, recording.thing, lambda thing: thing.described(maker="somebody"))
    path = old_blob(local, b"perhaps of an undo")
    change(local, "UPDATE audit SET detail = '[{'")
    faults = repair(local)
    assert any("the audit of object made_up/object0: cannot be read" in fault.what for fault in faults)
    assert not any(fault.done for fault in faults)
    assert path.exists()


def test_one_fault_does_not_hide_another(local: Store, recording: Recording) -> None:
    """Each part of a store is looked at, whatever is wrong with the others."""
    change(local, "UPDATE setups SET document = '{'")
    change(local, "DROP TABLE entries")
    change(local, "UPDATE recordings SET document = '[]' WHERE id = 2")
    change(local, "UPDATE things SET attributes = '3' WHERE name = 'object1'")
    old_blob(local, b"left over")
    told = [f"{fault.where}: {fault.what}" for fault in verify(local)]
    for part in (
        "database: the table entries is missing",
        "its content is not the one of its digest",
        f"recording {recording.id}: ",
        "object made_up/object1: thing.attributes: found int",
        "nothing refers to it",
    ):
        assert any(part in one for one in told), (part, told)
