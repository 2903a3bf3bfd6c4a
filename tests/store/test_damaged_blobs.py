"""Blobs that are missing or changed, in folders and in buckets: named, and never returned as data."""

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
from pyarrow.parquet import read_table
from sqlalchemy import event

from palpate.store.archive import Archive, export_archive
from palpate.store.curves import curves_of_gripper
from palpate.store.describing import change_thing, keep_image
from palpate.store.errors import DamagedError
from palpate.store.exporting.publication import Terms
from palpate.store.exporting.tables import Tables
from palpate.store.exporting.writing import export
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.opening import open_store
from palpate.store.records import Channel, FileItem, Recording, Series
from palpate.store.store import Store
from palpate.store.things import find_thing
from palpate.store.verifying import repair, verify
from tests.store.made_up import squeeze
from tests.store.places import damage

PICTURE = b"a picture"
NOISE = np.random.default_rng(0).integers(0, 255, 100_000, dtype=np.uint8)
DAMAGES: dict[str, Callable[[bytes], bytes | None]] = {
    "missing": lambda data: None,
    "empty": lambda data: b"",
    "cut": lambda data: data[:-1],
    "longer": lambda data: data + b"\0",
    "first bit": lambda data: bytes([data[0] ^ 1, *data[1:]]),
    "last bit": lambda data: bytes([*data[:-1], data[-1] ^ 128]),
}


def put_large(store: Store) -> tuple[Recording, dict[str, str]]:
    """A recording with a blob of each kind, among others without; the blobs by what they hold."""
    sound = Series("microphone", (Channel("sound", "level", None, NOISE, rate_hz=44100.0),))
    log = "".join(map(chr, NOISE.astype(int) + 300))
    store.put(squeeze(1))
    recording = squeeze(2, series=(sound,), log=log, files=(FileItem("cam0.png", "image/png", PICTURE),))
    store.put(recording)
    store.put(squeeze(3))
    blobs = {digest: store.blobs.get(digest) for digest, _ in store.blobs.all()}
    picture = sha256(PICTURE).hexdigest()
    packed = sorted(set(blobs) - {picture}, key=lambda digest: len(blobs[digest]))
    assert len(packed) == 2
    return recording, {"file": picture, "series": packed[0], "log": packed[1]}


@pytest.mark.parametrize("what", ["file", "series", "log"])
@pytest.mark.parametrize("how", DAMAGES)
def test_a_damaged_blob_is_named_and_never_returned(store: Store, tmp_path: Path, what: str, how: str) -> None:
    """Whatever became of a blob, it is named with its recording, and neither reading nor exporting gives it."""
    recording, digests = put_large(store)
    digest = digests[what]
    damage(store.blobs, digest, DAMAGES[how](store.blobs.get(digest)))
    (fault,) = verify(store)
    assert fault.where == f"blob {digest}"
    assert fault.what.endswith(f"needed by recording {recording.id}")
    with pytest.raises(DamagedError, match=digest):
        store.get(recording.id)
    with pytest.raises(DamagedError, match=digest):
        export_archive(store, tmp_path / "archive")
    assert not (tmp_path / "archive").exists()
    written = export(store, Archive(), tmp_path / "archive", leave_out_damaged=True)
    assert written.recordings == 2
    assert any(f"recording {recording.id}: blob {digest}" in notice for notice in written.notices)
    if what == "series":
        with pytest.raises(DamagedError, match=digest):
            list(curves_of_gripper(store, "two_finger"))
    # what is whole is given as before
    assert store.get(squeeze(1).digest).digest == squeeze(1).digest


@pytest.mark.parametrize("how", DAMAGES)
def test_putting_again_restores_what_was_set_aside(store: Store, how: str) -> None:
    """After repair, putting the same recording brings its blobs back, and the store is whole."""
    recording, digests = put_large(store)
    for digest in digests.values():
        damage(store.blobs, digest, DAMAGES[how](store.blobs.get(digest)))
    repair(store)
    assert not store.put(recording).new
    assert store.get(recording.id) == recording
    assert list(verify(store)) == []


def test_an_export_names_all_that_is_damaged_and_offers_a_way_on(local: Store, tmp_path: Path) -> None:
    """By default nothing is exported; what is left out when that is asked for is in no count and no table."""
    pictures = [FileItem("cam0.png", "image/png", b"%d" % number) for number in range(6)]
    recordings = [squeeze(number, files=(picture,), owner="ann") for number, picture in enumerate(pictures)]
    local.put_many(recordings)
    for picture in pictures[1:]:
        damage(local.blobs, picture.sha256, None)
    form = Tables(Terms(include_private=True, licence="CC-BY-4.0"))
    with pytest.raises(DamagedError) as error:
        export(local, form, tmp_path / "tables")
    told = str(error.value)
    assert told.startswith(f"export: 5 recordings not as written: recording {recordings[1].id}: blob ")
    assert "and 2 more; nothing was exported (leave_out_damaged, --leave-out-damaged, exports the rest)" in told
    assert not (tmp_path / "tables").exists()
    written = export(local, form, tmp_path / "tables", leave_out_damaged=True)
    assert (written.recordings, len(written.notices)) == (1, 5)
    assert read_table(tmp_path / "tables" / "data" / "recordings-00000-of-00001.parquet").num_rows == 1
    assert "1 recording of 1 object" in (tmp_path / "tables" / "CITATION.cff").read_text()


def test_a_lost_picture_of_an_object_stops_no_archive_that_may_leave_it_out(local: Store, tmp_path: Path) -> None:
    """Without it all the rest is archived, can be imported, and it is told which one is missing."""
    recording = squeeze()
    local.put(recording)
    image, other = (keep_image(local, f"{name}.png", "image/png", name.encode()) for name in ("front", "back"))
    change_thing(local, recording.thing, lambda thing: thing.showing(image).showing(other))
    damage(local.blobs, image.sha256, None)
    with pytest.raises(DamagedError, match=rf"export: blob {image.sha256}: .* \(leave_out_damaged"):
        export(local, Archive(), tmp_path / "archive")
    written = export(local, Archive(), tmp_path / "archive", leave_out_damaged=True)
    assert [notice.partition(": ")[0] for notice in written.notices] == ["image front.png of object made_up/object0"]
    with open_store(tmp_path / "other.sqlite") as second:
        outcomes = list(import_paths(second, [tmp_path / "archive"], all_formats()))
        assert [outcome.fate for outcome in outcomes] == [Fate.NEW]
        assert find_thing(second, "object0").images == (other,)


def test_all_blobs_lost_are_looked_up_at_once(local: Store) -> None:
    """What needs a blob is found by going through all references, which is done as often for one as for many."""
    for number in range(1, 31):
        local.put(squeeze(number, files=(FileItem("cam0.png", "image/png", b"%d" % number),)))
    asked: list[str] = []

    @event.listens_for(local.engine, "before_cursor_execute")
    def note(connection: object, cursor: object, statement: str, *more: object) -> None:
        asked.append(statement)

    counts = []
    for lost in (1, 30):
        for digest, _ in list(local.blobs.all())[:lost]:
            local.blobs.remove(digest)
        asked.clear()
        assert sum("is missing in" in fault.what for fault in verify(local)) == lost
        counts.append(sum("files.blob" in statement for statement in asked))
    assert counts[0] == counts[1]


def test_of_many_that_need_a_blob_three_are_named(local: Store) -> None:
    """The recordings that came first are named, and the others are counted with the objects."""
    made = [squeeze(number, files=(FileItem("cam0.png", "image/png", PICTURE),)) for number in range(5)]
    local.put_many(made)
    image = keep_image(local, "front", "image/png", PICTURE)
    change_thing(local, made[0].thing, lambda thing: thing.showing(image))
    local.blobs.remove(image.sha256)
    (fault,) = verify(local)
    names = ", ".join(f"recording {one.id}" for one in made[:3])
    assert fault.what.endswith(f"; needed by {names} and 3 more")
