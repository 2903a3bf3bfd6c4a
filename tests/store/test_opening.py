from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import Connection

from palpate.store.blobs import FolderBlobs
from palpate.store.database import connect
from palpate.store.errors import StoreError
from palpate.store.filters import Filter
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.verifying import verify
from tests.store.made_up import squeeze
from tests.store.places import check_services, emptied


def test_a_store_is_made_on_first_use_and_stays(tmp_path: Path) -> None:
    """A store in a folder that is not there is made, with its blobs beside; what was put is there next time."""
    path = tmp_path / "lab" / "store.sqlite"
    with open_store(path) as store:
        receipt = store.put(squeeze())
        assert isinstance(store.blobs, FolderBlobs)
        assert store.blobs.folder == tmp_path / "lab" / "store.sqlite-blobs"
    with open_store(f"sqlite:///{path}") as store:
        assert store.get(receipt.id).digest == receipt.digest


def test_the_environment_says_where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """PALPATE_STORE and PALPATE_BLOBS are heeded unless a place is given; without them it is the user's data folder."""
    monkeypatch.setenv("PALPATE_STORE", str(tmp_path / "one.sqlite"))
    monkeypatch.setenv("PALPATE_BLOBS", str(tmp_path / "blobs"))
    with open_store() as store:
        assert isinstance(store.blobs, FolderBlobs)
        assert store.blobs.folder == tmp_path / "blobs"
    assert (tmp_path / "one.sqlite").exists()
    monkeypatch.delenv("PALPATE_STORE")
    monkeypatch.delenv("PALPATE_BLOBS")
    monkeypatch.setattr("palpate.store.opening.default_path", lambda: tmp_path / "data" / "store.sqlite")
    with open_store():
        assert (tmp_path / "data" / "store.sqlite").exists()


def test_a_store_that_is_not_there_is_not_made_for_who_only_reads(tmp_path: Path) -> None:
    """It is an error, and leaves nothing behind; one that is there is opened."""
    with pytest.raises(StoreError, match=r"there is no store at .*new.sqlite, expected one"):
        open_store(tmp_path / "lab" / "new.sqlite", make=False)
    assert not list(tmp_path.iterdir())
    open_store(tmp_path / "new.sqlite").close()
    open_store(tmp_path / "new.sqlite", make=False).close()


def test_places_that_cannot_be_used_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder under a file, a file that is no database and PostgreSQL without blobs are errors in one sentence."""
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    plain = tmp_path / "plain.txt"
    plain.write_text("mug" * 1000)
    with pytest.raises(StoreError, match="cannot be made"):
        open_store(plain / "store.sqlite")
    with pytest.raises(StoreError, match="PALPATE_BLOBS is not set"):
        open_store("postgresql+psycopg://lab@127.0.0.1:1/nowhere")
    with pytest.raises(StoreError, match="not a database"):
        open_store(plain)


@pytest.fixture
def server() -> Iterator[Connection]:
    """A connection by which databases and users can be made; what is made here is removed."""
    check_services("postgresql")
    engine = connect(emptied()).execution_options(isolation_level="AUTOCOMMIT")
    gone = ("DROP DATABASE IF EXISTS palpate_odd WITH (FORCE)", "DROP ROLE IF EXISTS palpate_guest")
    with engine.connect() as connection:
        for statement in gone:
            connection.exec_driver_sql(statement)
        yield connection
        for statement in gone:
            connection.exec_driver_sql(statement)
    engine.dispose()


@pytest.mark.parametrize("encoding", ["SQL_ASCII", "UTF8"])
def test_text_is_text_whatever_the_encoding_of_the_database(server: Connection, tmp_path: Path, encoding: str) -> None:
    """A PostgreSQL database that was made without an encoding gives back what was put, and finds it."""
    server.exec_driver_sql(
        f"CREATE DATABASE palpate_odd ENCODING '{encoding}' LC_COLLATE 'C' LC_CTYPE 'C' TEMPLATE template0"
    )
    place = server.engine.url.set(database="palpate_odd").render_as_string(hide_password=False)
    recording = squeeze(action="drücken 押", thing=ThingRef("made_up", "Häferl"), log="ß")
    with open_store(place, tmp_path) as store:
        store.put(recording)
        assert store.get(recording.id) == recording
        assert len(list_recordings(store, Filter(action="drücken 押", text="häferl")).rows) == 1
        assert list(verify(store)) == []


def test_an_empty_database_of_a_server_is_no_store(server: Connection, tmp_path: Path) -> None:
    """Who only reads gets no tables there, and no password is told."""
    server.exec_driver_sql("CREATE DATABASE palpate_odd TEMPLATE template0")
    place = server.engine.url.set(database="palpate_odd", drivername="postgresql").render_as_string(hide_password=False)
    with pytest.raises(StoreError, match=r"there is no store at postgresql.*palpate_odd.*, expected one"):
        open_store(place, tmp_path, make=False)
    open_store(place, tmp_path).close()
    open_store(place, tmp_path, make=False).close()


def test_what_a_user_may_not_do_is_an_error_in_one_sentence(server: Connection, tmp_path: Path) -> None:
    """A user without rights is told so when tables are to be made; one who may read reads, and cannot put."""
    server.exec_driver_sql("CREATE ROLE palpate_guest LOGIN PASSWORD 'secret'")
    server.exec_driver_sql("GRANT USAGE ON SCHEMA public TO palpate_guest")
    place = server.engine.url.set(username="palpate_guest", password="secret").render_as_string(hide_password=False)
    with pytest.raises(StoreError, match="permission denied for schema public; expected a database") as told:
        open_store(place, tmp_path)
    assert "\n" not in str(told.value)
    assert "secret" not in str(told.value)
    with open_store(server.engine.url.render_as_string(hide_password=False), tmp_path) as owned:
        receipt = owned.put(squeeze())
    server.exec_driver_sql("GRANT SELECT ON ALL TABLES IN SCHEMA public TO palpate_guest")
    with open_store(place, tmp_path) as store:
        assert store.get(receipt.id).digest == receipt.digest
        with pytest.raises(StoreError, match="permission denied"):
            store.put(squeeze(1))
        assert len(list_recordings(store).rows) == 1
    server.exec_driver_sql("DROP OWNED BY palpate_guest")
