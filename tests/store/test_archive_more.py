import json
import sqlite3
from pathlib import Path

import pyarrow
import pytest
from pyarrow import parquet

from palpate.store.archive import Archive, export_archive
from palpate.store.audit import history
from palpate.store.content import file_digest
from palpate.store.describing import add_thing, change_thing, fields_of, keep_image
from palpate.store.entries import Distribution, Value
from palpate.store.errors import UnavailableError
from palpate.store.exporting.writing import export
from palpate.store.filters import Filter
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Outcome
from palpate.store.importing.own_formats import Archives
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.listing_episodes import list_episodes
from palpate.store.merging import merge_things
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing, list_things
from palpate.store.verifying import verify
from tests.store.made_up import made_episode, squeeze

MUG, CUP, BOX = (ThingRef("made_up", name) for name in ("mug", "cup", "box"))
RECORDINGS = [squeeze(number, thing=thing) for number, thing in enumerate((MUG, CUP))]


def taken(store: Store, archive: Path) -> list[Outcome]:
    return list(import_paths(store, [archive], [Archives()]))


def fates(outcomes: list[Outcome], what: str) -> list[Fate]:
    return [outcome.fate for outcome in outcomes if f": {what} " in outcome.source]


@pytest.fixture
def archive(store: Store, tmp_path: Path) -> Path:
    """Of a store with a merged object, one that was never measured, known properties, an image and episodes."""
    store.put_many(RECORDINGS)
    image = keep_image(store, "front.png", "image/png", b"a picture")
    wood = Distribution("material", {"wood": 0.9, "metal": 0.1})
    change_thing(store, MUG, lambda thing: thing.knowing(Value("weight", 118.0, 1.0, "g"), "scale").showing(image))
    change_thing(store, MUG, lambda thing: thing.knowing(wood, "ann").described(attributes={"colour": "red"}))
    add_thing(store, BOX)
    merge_things(store, CUP, MUG)
    for number in range(3):
        put_episode(store, made_episode(*RECORDINGS[:number], number=number, stop="enough", visibility="lab"))
    put_episode(store, made_episode(number=7))
    export_archive(store, tmp_path / "archive")
    return tmp_path / "archive"


def test_objects_and_episodes_survive_an_archive(store: Store, archive: Path, tmp_path: Path) -> None:
    """Descriptions, known properties, images, merges and episodes come back; a second import adds nothing."""
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        first, second = (taken(other, archive) for _ in range(2))
        assert (fates(first, "episode"), fates(second, "episode")) == ([Fate.NEW] * 4, [Fate.KNOWN] * 4)
        assert fates(first, "object") == fates(second, "object") == []
        assert Archives().count(archive) == len(first)
        assert list_things(other) == list_things(store)
        assert other.blobs.get(find_thing(other, "mug").images[0].sha256) == b"a picture"
        for number in range(3):
            episode = made_episode(*RECORDINGS[:number], number=number, stop="enough")
            assert get_episode(other, episode.digest).visibility == "lab"
        assert list(verify(other)) == []


def test_an_archive_is_of_one_moment(store: Store, tmp_path: Path) -> None:
    """An episode that grows while the archive is written names no recording that the archive lacks."""
    new, episode = squeeze(5, thing=MUG), made_episode(RECORDINGS[0], thing=MUG)
    store.put_many(RECORDINGS)
    put_episode(store, episode)

    def grow(done: int, of: int) -> None:
        store.put(new)
        put_episode(store, episode.continued({"step": 2, "action": "squeezing"}, new.digest))
        put_episode(store, made_episode(new, number=5))
        add_thing(store, BOX)

    assert export_archive(store, tmp_path / "archive", told=grow) == 2
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        assert {outcome.fate for outcome in taken(other, tmp_path / "archive")} == {Fate.NEW}
        assert get_episode(other, episode.id).digest == episode.digest
        assert [thing.path for thing in list_things(other)] == ["made_up/cup", "made_up/mug"]


def test_a_selection_has_its_objects_and_its_whole_episodes(store: Store, archive: Path, tmp_path: Path) -> None:
    """An archive of some recordings describes their objects, and holds the episodes of which it has all recordings."""
    part = tmp_path / "part"
    written = export(store, Archive(), part, Filter(action="squeezing", until=RECORDINGS[1].recorded_at))
    assert written.recordings == 1
    assert written.notices == (
        "2 objects left out (about which nothing is in the archive)",
        "3 episodes left out (without recordings, with some that are not in the archive, or of another visibility)",
    )
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        assert {outcome.fate for outcome in taken(other, part)} == {Fate.NEW}
        assert find_thing(other, "mug").known == find_thing(store, "mug").known
        assert other.blobs.get(find_thing(other, "mug").images[0].sha256) == b"a picture"
        assert [row.digest for row in list_episodes(other).rows] == [
            made_episode(RECORDINGS[0], number=1, stop="enough").digest
        ]
        assert list(verify(other)) == []


def test_a_selection_has_what_its_objects_count_as(store: Store, archive: Path, tmp_path: Path) -> None:
    """The object that a merged one counts as comes with it, although none of its recordings does."""
    assert export_archive(store, tmp_path / "part", Filter(since=RECORDINGS[1].recorded_at)) == 1
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        assert {outcome.fate for outcome in taken(other, tmp_path / "part")} == {Fate.NEW}
        assert find_thing(other, "cup").merged_into == find_thing(other, "mug").ref


def test_a_selection_by_visibility_has_episodes_of_it(store: Store, tmp_path: Path) -> None:
    """A private episode of public recordings is in no archive of what is public."""
    made = squeeze(1, visibility="public")
    store.put(made)
    for number, visibility in enumerate(("private", "public")):
        put_episode(store, made_episode(made, number=number, visibility=visibility))
    export_archive(store, tmp_path / "archive", Filter(visibility="public"))
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        taken(other, tmp_path / "archive")
        assert [row.visibility for row in list_episodes(other).rows] == ["public"]


def test_what_a_store_says_already_stays(store: Store, archive: Path, tmp_path: Path) -> None:
    """An archive completes an object, and neither changes nor removes what is there; the audit says so."""
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        other.put(squeeze(9, thing=MUG))
        heavier = Value("weight", 120.0, unit="g")
        change_thing(other, MUG, lambda thing: thing.described(attributes={"colour": "blue", "age": 3}))
        change_thing(other, MUG, lambda thing: thing.knowing(heavier, "scale"))
        taken(other, archive)
        found = find_thing(other, "mug")
        assert found.ref.attributes == {"colour": "blue", "age": 3}
        assert {one.source: one.entry for one in found.known}["scale"] == heavier
        assert ("known", "material", "ann") in fields_of(found)
        assert history(other, MUG)[-1].who == "archive archive"


def test_what_does_not_fit_is_told(store: Store, archive: Path, tmp_path: Path) -> None:
    """A merge into another object than here, and a unit of another dimension, are told and not taken over."""
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        other.put(squeeze(9, thing=BOX, entries=(Value("weight", 1.0, unit="N"),)))
        add_thing(other, CUP)
        merge_things(other, CUP, BOX)
        refused = [outcome for outcome in taken(other, archive) if outcome.fate is Fate.REFUSED]
        assert [outcome.source.partition(": ")[2] for outcome in refused] == [
            "object made_up/mug",
            "object made_up/cup",
        ]
        assert "counts as made_up/box here, and as made_up/mug in the archive" in (refused[1].reason or "")
        assert find_thing(other, "cup").merged_into == BOX
        assert list(verify(other)) == []


@pytest.mark.parametrize("name", ["objects.parquet", "episodes.parquet"])
def test_changed_tables_are_refused(archive: Path, local: Store, name: str) -> None:
    """A file that is not the one that was written, or that the manifest does not know, is named once."""
    path = archive / name
    path.write_bytes(path.read_bytes() + b"x")
    (refused,) = taken(local, archive)
    assert f"{name}: is missing or not the file" in (refused.reason or "")
    manifest = archive / "manifest.json"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace(f'"{name}"', '"other.parquet"'), encoding="utf-8")
    (refused,) = taken(local, archive)
    assert f"{name}: is not among the files of manifest.json" in (refused.reason or "")


@pytest.mark.parametrize("name", ["objects.parquet", "episodes.parquet"])
@pytest.mark.parametrize("content", ["junk", "columns", "rows"])
def test_tables_of_others_are_refused(archive: Path, tmp_path: Path, name: str, content: str) -> None:
    """What is no table, has other columns or other values is told in a sentence; the recordings are there."""
    path = archive / name
    if content == "junk":
        path.write_bytes(b"PAR1 and nothing else PAR1")
    elif content == "columns":
        parquet.write_table(pyarrow.table({"document": ["{}"]}), path)
    else:
        table = parquet.read_table(path)
        field = "attributes" if name.startswith("objects") else "document"
        place = table.column_names.index(field)
        wrong = pyarrow.array(["}"] * table.num_rows, pyarrow.string())
        parquet.write_table(table.set_column(place, table.schema.field(place), wrong), path)
    manifest = archive / "manifest.json"
    plain = json.loads(manifest.read_text(encoding="utf-8"))
    plain["sha256"][name] = file_digest(path)
    manifest.write_text(json.dumps(plain), encoding="utf-8")
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        outcomes = taken(other, archive)
        refused = [outcome for outcome in outcomes if outcome.fate is Fate.REFUSED]
        assert refused
        assert all(outcome.reason for outcome in refused)
        assert fates(outcomes, "recording") == [Fate.NEW] * 2
        assert list(verify(other)) == []


def test_archives_without_objects_and_episodes_are_taken(archive: Path, tmp_path: Path) -> None:
    """An archive that was written before there were such tables gives its recordings."""
    manifest = archive / "manifest.json"
    plain = json.loads(manifest.read_text(encoding="utf-8"))
    for name in ("objects.parquet", "episodes.parquet"):
        (archive / name).unlink()
        del plain["sha256"][name]
    del plain["episodes"]
    manifest.write_text(json.dumps(plain), encoding="utf-8")
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        assert [outcome.fate for outcome in taken(other, archive)] == [Fate.NEW] * 2


def test_a_store_that_cannot_be_used_ends_an_import(
    archive: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """While another program holds the file nothing is refused that may be right; the same import then goes on."""
    monkeypatch.setattr("palpate.store.database.WAIT_S", 0.1)
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        other.put_many(RECORDINGS)
        holding = sqlite3.connect(tmp_path / "other.sqlite", isolation_level=None)
        holding.execute("BEGIN IMMEDIATE")
        for change in (
            lambda: taken(other, archive),
            lambda: add_thing(other, BOX),
            lambda: put_episode(other, made_episode()),
        ):
            with pytest.raises(UnavailableError, match=r"database is locked; nothing was (changed|kept)"):
                change()
        holding.execute("ROLLBACK")
        holding.close()
        assert Fate.REFUSED not in {outcome.fate for outcome in taken(other, archive)}
        assert list(verify(other)) == []
