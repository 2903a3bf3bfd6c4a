from dataclasses import replace
from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import inspect, text

from palpate.store import schema
from palpate.store.content import entry_plain, to_json
from palpate.store.database import LATEST, as_of_one_moment, asking, changing, connect, migrate, revision
from palpate.store.describing import change_thing
from palpate.store.entries import Distribution, Value
from palpate.store.errors import DamagedError, StoreError
from palpate.store.filters import Filter
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.legible import reading
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing
from palpate.store.verifying import verify
from tests.store.made_up import made_episode, squeeze


def test_migrations_make_the_schema(store: Store) -> None:
    """The tables that the migrations make are those that the code uses."""
    with store.engine.connect() as connection:
        assert revision(connection) == LATEST
        assert compare_metadata(MigrationContext.configure(connection), schema.metadata) == []


def test_migrations_go_down_and_up(store: Store) -> None:
    """A filled store can be taken down to no tables and up again."""
    store.put(squeeze())
    migrate(store.engine, "base")
    with store.engine.connect() as connection:
        assert set(inspect(connection).get_table_names()) == {"alembic_version"}
    migrate(store.engine, "head")
    with store.engine.connect() as connection:
        assert revision(connection) == LATEST


@pytest.mark.parametrize("version", ["0001"])
def test_filled_stores_of_earlier_versions_come_up(store: Store, version: str) -> None:
    """Recordings, known properties and episodes survive the way down to a version and up again."""
    mug = ThingRef("made_up", "object0")
    receipt, episode = store.put(squeeze()), made_episode()
    put_episode(store, replace(episode, steps=()))
    change_thing(store, mug, lambda thing: thing.knowing(Distribution("material", {"wood": 1.0}), "ann"))
    migrate(store.engine, version)
    with store.engine.begin() as connection:
        for name in ("mass", "mass"):
            # an earlier version did not ask for a source
            document = to_json(entry_plain(Value(name, 1.0, unit="g")))
            sql = "INSERT INTO thing_properties (thing_id, property, document) VALUES (1, :name, :document)"
            connection.execute(text(sql), {"name": name, "document": document})
    migrate(store.engine, "head")
    assert store.get(receipt.id) == squeeze(id=receipt.id)
    assert get_episode(store, episode.id).digest == replace(episode, steps=()).digest
    known = {one.source: one.entry for one in find_thing(store, "object0").known}
    assert known == {
        "ann": Distribution("material", {"wood": 1.0}),
        "not stated": Value("mass", 1.0, unit="g"),
        "not stated (3)": Value("mass", 1.0, unit="g"),
    }
    assert len(list_recordings(store, Filter(known={"material": "wood"})).rows) == 1
    assert [fault for fault in verify(store) if "episode" not in fault.where] == []


def test_sqlite_is_set_up_for_many_writers(local: Store) -> None:
    """The file has large pages, a write-ahead log and enforced references."""
    with local.engine.connect() as connection:
        asked = ("page_size", "journal_mode", "foreign_keys")
        found = [connection.exec_driver_sql(f"PRAGMA {name}").scalar() for name in asked]
    assert found == [16384, "wal", 1]


def test_a_newer_store_is_refused(tmp_path: Path) -> None:
    """Tables of a version that is not known yet are left alone."""
    path = tmp_path / "store.sqlite"
    with open_store(path) as store, store.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(StoreError, match=f"tables of version 9999, expected {LATEST} or older: update palpate"):
        open_store(path)


@pytest.mark.parametrize("url", ["mysql://lab@host/db", "://"])
def test_other_addresses_are_refused(url: str) -> None:
    """What is no address of SQLite or PostgreSQL is an error in one sentence."""
    with pytest.raises(StoreError, match="expected"):
        connect(url)


def test_a_schema_that_is_no_text_is_damage(tmp_path: Path) -> None:
    """SQLite tells a damaged schema in its own bytes, which Python's driver cannot read."""
    place = tmp_path / "measurements.sqlite"
    open_store(place).close()
    whole = place.read_bytes()
    name = b"alembic_versionalembic_version"
    assert whole.count(name) == 1
    place.write_bytes(whole.replace(name, b"al\x8f" + name[3:]))
    with pytest.raises(DamagedError, match="the schema is no text"):
        open_store(place)


def test_no_question_is_compiled(store: Store) -> None:
    """PostgreSQL would take seconds to compile one that it answers at once."""
    if store.engine.dialect.name != "postgresql":
        pytest.skip("of PostgreSQL alone")
    with store.engine.connect() as connection:
        assert connection.exec_driver_sql("SHOW jit").scalar() == "off"


def test_what_is_often_asked_is_planned_once(store: Store) -> None:
    """PostgreSQL keeps how it answers a question, whichever connections others give back in between."""
    if store.engine.dialect.name != "postgresql":
        pytest.skip("of PostgreSQL alone")
    for _ in range(12):
        store.known([squeeze().digest])
        assert list_recordings(store).rows == ()
    with reading(store.engine) as connection:
        kept = connection.exec_driver_sql("SELECT statement FROM pg_prepared_statements WHERE generic_plans > 0")
        texts = [one.partition("FROM")[2] for one in kept.scalars()]
    assert any("ORDER BY recordings.recorded_us DESC" in one for one in texts), texts
    assert any("recordings.digest IN" in one for one in texts), texts


def remove_entries_in_vain(store: Store) -> None:
    with changing(store.engine) as connection:
        connection.execute(text("DELETE FROM entries"))
        raise ZeroDivisionError


def test_what_is_asked_leaves_others_their_transactions(store: Store) -> None:
    """A connection by which something was asked takes back what is not committed, and shows one moment where asked."""
    store.put(squeeze())
    count = text("SELECT count(*) FROM recordings")
    with asking(store.engine) as connection:
        assert connection.scalar(count) == 1
    with pytest.raises(ZeroDivisionError):
        remove_entries_in_vain(store)
    with reading(store.engine) as connection:
        assert connection.scalar(text("SELECT count(*) FROM entries")) == 1
    with reading(as_of_one_moment(store.engine)) as connection:
        assert connection.scalar(count) == 1
        store.put(squeeze(1))
        assert connection.scalar(count) == 1
    with reading(store.engine) as connection:
        assert connection.scalar(count) == 2
