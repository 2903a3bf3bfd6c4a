from pathlib import Path

import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import inspect

from palpate.store import schema
from palpate.store.database import LATEST, connect, migrate, revision
from palpate.store.errors import StoreError
from palpate.store.opening import open_store
from palpate.store.store import Store
from tests.store.made_up import squeeze


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
    with pytest.raises(StoreError, match="tables of version 9999, expected 0001 or older: update palpate"):
        open_store(path)


@pytest.mark.parametrize("url", ["mysql://lab@host/db", "://"])
def test_other_addresses_are_refused(url: str) -> None:
    """What is no address of SQLite or PostgreSQL is an error in one sentence."""
    with pytest.raises(StoreError, match="expected"):
        connect(url)
