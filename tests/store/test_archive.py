import json
import shutil
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.store.archive import export_archive
from palpate.store.content import file_digest
from palpate.store.describing import change_thing
from palpate.store.errors import DamagedError, StoreError
from palpate.store.filters import Filter
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.own_formats import Archives
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.matching import ids_matching
from palpate.store.opening import open_store
from palpate.store.reading_archive import archive_rows, read_archive
from palpate.store.records import FileItem, Recording, ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing
from palpate.store.verifying import verify
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_things import ThingFilter, list_visible_things, visible_thing
from tests.store.made_up import made_episode, recordings, squeeze

MADE = [squeeze(1, log="said"), squeeze(2, files=(FileItem("cam0.png", "image/png", b"picture"),)), squeeze(3)]


@pytest.fixture
def archive(local: Store, tmp_path: Path) -> Path:
    local.put_many(MADE)
    assert export_archive(local, tmp_path / "archive") == 3
    return tmp_path / "archive"


def test_import_of_an_export_is_the_same(store: Store, tmp_path: Path) -> None:
    """Recordings come back with ids and digests from an archive; a second import adds nothing."""
    store.put_many(MADE)
    export_archive(store, tmp_path / "archive")
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        first, second = (list(import_paths(other, [tmp_path / "archive"], [Archives()])) for _ in range(2))
        assert [outcome.fate for outcome in (*first, *second)] == [Fate.NEW] * 3 + [Fate.KNOWN] * 3
        assert [other.get(recording.id) for recording in MADE] == MADE
        assert list(verify(other)) == []


@settings(
    max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], deadline=None
)
@given(st.lists(recordings(), max_size=3))
def test_any_recordings_survive_an_archive(local: Store, tmp_path: Path, made: list[Recording]) -> None:
    """Whatever may be kept has the same digest after a round trip through an archive."""
    local.put_many(made)
    shutil.rmtree(tmp_path / "archive", ignore_errors=True)
    export_archive(local, tmp_path / "archive")
    found = {recording.digest for recording in read_archive(tmp_path / "archive")}
    assert {recording.digest for recording in made} <= found


def test_an_archive_tells_nobody_more_than_the_store(store: Store, tmp_path: Path) -> None:
    """Of an object that not all see whole each recording says what it said, and the object is all that it was."""
    cup = ThingRef("lab", "cup")
    store.put(squeeze(1, thing=replace(cup, maker="Acme", common_name="beaker", aliases=("pot",)), owner="ann"))
    change_thing(store, cup, lambda thing: thing.described(maker="Zeus"), who="ann")
    store.put(squeeze(2, thing=replace(cup, aliases=("mug", "pot")), visibility="public"))
    store.put(squeeze(3, thing=replace(cup, maker="Brown", attributes={"colour": "red"}), visibility="public"))
    whole = find_thing(store, "lab/cup")
    words = ("acme", "zeus", "beaker", "pot", "mug", "red", "a")

    def told(place: Store, viewer: Viewer) -> list[object]:
        texts = [VisibleFilter(text=word, viewer=viewer) for word in words]
        lists = [list_visible_things(place, viewer, ThingFilter(text=word)).rows for word in words]
        thing = visible_thing(place, viewer, "lab", "cup")
        return [thing, lists, [len(list_recordings(place, one).rows) for one in texts]]

    export_archive(store, tmp_path / "archive")
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        assert {one.fate for one in import_paths(other, [tmp_path / "archive"], [Archives()])} == {Fate.NEW}
        restored = find_thing(other, "lab/cup")
        public = visible_thing(other, Viewer(), "lab", "cup")
        assert public is not None
        assert public.ref == replace(cup, aliases=("mug", "pot"))
        assert (restored.ref, restored.known) == (whole.ref, whole.known)
        # what contradicts the rest is not in an archive, and shows in the store to who sees nothing else
        change_thing(store, cup, lambda thing: thing.described(maker="Acme"), who="ann")
        change_thing(other, cup, lambda thing: thing.described(maker="Acme"), who="ann")
        for viewer in (Viewer(), Viewer("eve", lab=True)):
            assert told(other, viewer) == told(store, viewer)
            assert "pot" in str(told(other, viewer)), "what a public recording says is seen"
        assert list(verify(other)) == []


def test_a_selection_is_exported(store: Store, tmp_path: Path) -> None:
    """Only the recordings that match are in the archive, whole, with their files, and progress is told of them."""
    store.put_many(MADE)
    told: list[tuple[int, int]] = []
    count = export_archive(store, tmp_path / "archive", Filter(thing="object2"), lambda *each: told.append(each))
    assert count == 1
    assert told == [(1, 1)]
    assert [recording.digest for recording in read_archive(tmp_path / "archive")] == [MADE[1].digest]


def test_an_embargo_survives_an_archive(store: Store, tmp_path: Path) -> None:
    """It comes back with the visibility that holds after it; who reads the tables alone is told that it is private."""
    ends = [datetime.now(UTC) + timedelta(days=days) for days in (1, -1)]
    made = [squeeze(n, visibility="lab", embargoed_until=until) for n, until in enumerate(ends)]
    store.put_many(made)
    put_episode(store, made_episode(made[0], visibility="public", embargoed_until=ends[0]))
    folder = tmp_path / "archive"
    export_archive(store, folder)
    said = pq.read_table(folder / "recordings.parquet")["visibility"].to_pylist()
    assert said == ["private", "lab"]
    assert set(pq.read_table(folder / "episodes.parquet")["visibility"].to_pylist()) == {"private"}
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        assert {one.fate for one in import_paths(other, [folder], [Archives()])} == {Fate.NEW}
        assert [other.get(one.id) for one in made] == made
        (row,) = list_episodes(other).rows
        found = get_episode(other, row.id)
        assert (found.visibility, found.embargoed_until) == ("public", ends[0])


def test_what_is_embargoed_is_private_meanwhile(store: Store, tmp_path: Path) -> None:
    """A selection by visibility asks who may see it now."""
    ends = [None, datetime.now(UTC) + timedelta(days=1), datetime.now(UTC) - timedelta(days=1)]
    made = [squeeze(n, visibility="public", embargoed_until=until) for n, until in enumerate(ends)]
    store.put_many(made)
    for visibility, wanted in (("public", [made[0], made[2]]), ("private", [made[1]]), ("lab", [])):
        assert set(ids_matching(store, Filter(visibility=visibility))) == {one.id for one in wanted}
    assert export_archive(store, tmp_path / "archive", Filter(visibility="public")) == 2


@pytest.mark.parametrize("stated", [["public", "soon"], ["secret", "2026-01-01T00:00:00.000000Z"], "public"])
def test_an_embargo_that_cannot_be_read_is_refused(archive: Path, stated: object) -> None:
    """A manifest that states no moment or no visibility is none."""
    manifest = json.loads((archive / "manifest.json").read_text())
    (archive / "manifest.json").write_text(json.dumps({**manifest, "embargoed": {MADE[0].digest: stated}}))
    with pytest.raises(StoreError, match="expected the manifest of an archive"):
        list(read_archive(archive))


def test_an_existing_folder_is_not_written_to(local: Store, tmp_path: Path) -> None:
    """Exporting to a name that is taken is refused; a failed export leaves nothing."""
    with pytest.raises(StoreError, match="exists already"):
        export_archive(local, tmp_path)
    local.put(MADE[0])
    with local.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE series SET data = x'00'")
    before = set(tmp_path.iterdir())
    with pytest.raises(DamagedError):
        export_archive(local, tmp_path / "archive")
    assert set(tmp_path.iterdir()) == before


@pytest.mark.parametrize("name", ["recordings.parquet", "entries.parquet"])
def test_a_changed_archive_is_refused(archive: Path, name: str) -> None:
    """A file that is not the one that was written is named, before anything is imported."""
    path = archive / name
    path.write_bytes(path.read_bytes() + b"x")
    with pytest.raises(DamagedError, match=f"{name}: is missing or not the file"):
        next(read_archive(archive))


@pytest.mark.parametrize(
    ("manifest", "message"),
    [("{", "cannot be read"), ("[]", "cannot be read"), ('{"version": 2, "sha256": {}}', "cannot be read")],
)
def test_a_manifest_that_is_none_is_refused(archive: Path, manifest: str, message: str) -> None:
    """A manifest that cannot be read is an error in one sentence."""
    (archive / "manifest.json").write_text(manifest)
    with pytest.raises(StoreError, match=message):
        next(read_archive(archive))


def forged(archive: Path, column: str, value: object) -> Path:
    """The archive with another value in one column, and a manifest that agrees."""
    path = archive / "recordings.parquet"
    table = pq.read_table(path)
    place = table.schema.get_field_index(column)
    field = table.schema.field(column)
    pq.write_table(table.set_column(place, field, pa.array([value] * table.num_rows, field.type)), path)
    manifest = json.loads((archive / "manifest.json").read_text())
    manifest["sha256"]["recordings.parquet"] = file_digest(path)
    (archive / "manifest.json").write_text(json.dumps(manifest))
    return archive


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("document", "{"),
        ("document", "[]"),
        ("document", '{"files":[{"sha256":"../../../etc/passwd"}]}'),
        ("document", '{"files":[{"sha256":"/etc/passwd"}]}'),
        ("thing", "{}"),
        ("setup", "null"),
        ("id", "mug"),
        ("digest", "00" * 32),
        ("log", b"other"),
        ("series", []),
        ("series", None),
        ("series", [{"name": "a", "layout": "[]", "data": b""}]),
    ],
)
def test_a_forged_row_is_refused(archive: Path, column: str, value: object) -> None:
    """Whatever stands in a row, it is a whole recording of its digest or an error; no path leads out of the archive."""
    with pytest.raises(StoreError):
        list(read_archive(forged(archive, column, value)))


def test_a_missing_file_is_named(archive: Path, tmp_path: Path) -> None:
    """A file that the archive does not hold is an error, and so is a link in its place."""
    digest = MADE[1].files[0].sha256
    path = archive / "blobs" / digest[:2] / digest[2:]
    path.rename(tmp_path / "picture")
    with pytest.raises(DamagedError, match=f"blob {digest} is missing"):
        list(read_archive(archive))
    path.symlink_to(tmp_path / "picture")
    with pytest.raises(DamagedError, match=f"blob {digest} is missing"):
        list(read_archive(archive))


def test_what_a_store_refuses_is_told(archive: Path, tmp_path: Path) -> None:
    """A recording that the other store may not keep is told, and the others are imported."""
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        other.put(replace(squeeze(9), id=MADE[2].id))
        done = list(import_paths(other, [archive], [Archives()]))
    assert [outcome.fate for outcome in done] == [Fate.NEW, Fate.NEW, Fate.REFUSED]
    assert done[2].source == f"{archive}: recording {MADE[2].id}"
    assert "is that of another recording" in str(done[2].reason)


def test_signals_are_read_only_when_asked_for(archive: Path) -> None:
    """Ids and digests come without the rows, which can be read after all of them were listed."""
    rows = list(archive_rows(archive))
    assert [(row.id, row.digest) for row in rows] == [(str(made.id), made.digest) for made in MADE]
    assert [row.read().digest for row in rows] == [made.digest for made in MADE]


def test_a_table_that_is_none_is_refused(archive: Path) -> None:
    """A table with a right digest and no Parquet in it is an error in one sentence."""
    (archive / "recordings.parquet").write_bytes(b"PAR1, or not")
    manifest = json.loads((archive / "manifest.json").read_text())
    manifest["sha256"]["recordings.parquet"] = file_digest(archive / "recordings.parquet")
    (archive / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(DamagedError, match=r"recordings\.parquet: cannot be read"):
        next(read_archive(archive))
