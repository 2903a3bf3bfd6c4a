"""Connections to a database, and bringing its tables up to date."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from sqlite3 import Connection as SqliteConnection
from typing import Any

from sqlalchemy import Connection, Engine, create_engine, event, inspect, text
from sqlalchemy.engine import URL, make_url
from sqlalchemy.exc import ArgumentError, DatabaseError

from palpate.errors import extra
from palpate.store.any_case import IN_SQLITE, small
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.outages import tell_outages
from palpate.store.read_only import read_only_uri

__all__ = [
    "ACCOUNT_LOCK",
    "LATEST",
    "MERGE_LOCK",
    "as_of_one_moment",
    "asking",
    "changing",
    "connect",
    "is_store",
    "migrate",
    "one_at_a_time",
    "revision",
    "snapshot",
    "up_to_date",
    "writing",
]

LATEST = "0008"
MIGRATIONS = Path(__file__).parent / "migrations"
WAIT_S = 30
PAGE_BYTES = 16384
CACHE_BYTES = 64 << 20
CONNECTIONS = 12
"""Kept open, and as many more for a while: for each thread of a server one, and another one within."""
# 64 MiB of log before it is worked into the file
CHECKPOINT_PAGES = 4096
MIGRATION_LOCK, MERGE_LOCK, ACCOUNT_LOCK = 0x70616C70, 0x70616C71, 0x70616C72
"""Any numbers that other programs on one PostgreSQL are unlikely to lock."""


def connect(url: str, *, durable: bool = True, cache_bytes: int = CACHE_BYTES) -> Engine:
    """Make an engine.

    Parameters
    ----------
    url
        ``sqlite:///path`` or ``postgresql+psycopg://...``, or ``postgresql://...`` for the same. An SQLite file that
        cannot be written is read.
    durable
        Whether what was committed survives a loss of power; without, SQLite may lose the last commits then, and is
        faster. A killed program loses nothing in either case.
    cache_bytes
        What each connection to SQLite keeps in memory; the system keeps more.

    Raises
    ------
    StoreError
        If it is no address of a database.
    """
    try:
        address = make_url(url)
    except ArgumentError:
        raise StoreError(
            f"store {url!r}: is no address, expected a path, sqlite:///... or postgresql+psycopg://..."
        ) from None
    if address.drivername in ("postgresql", "postgres"):
        address = address.set(drivername="postgresql+psycopg")
    if address.drivername == "postgresql+psycopg":
        return _postgresql(address)
    if address.get_backend_name() != "sqlite":
        found = f"store {address!r}: found {address.drivername!r}"
        raise StoreError(f"{found}, expected a path, sqlite:///... or postgresql+psycopg://...")
    return _sqlite(address, durable=durable, cache_bytes=cache_bytes)


def _postgresql(address: URL) -> Engine:
    try:
        # whatever the encoding of the database, what is sent and read is text
        engine = create_engine(
            address,
            pool_size=CONNECTIONS,
            max_overflow=CONNECTIONS,
            pool_pre_ping=True,
            connect_args={"client_encoding": "utf8"},
        )
    except ImportError as error:
        raise StoreError(f"store {address!r}: needs psycopg, which is not installed: {extra('postgresql')}") from error
    tell_outages(engine)

    @event.listens_for(engine, "connect")
    def prepare(connection: Any, record: Any) -> None:
        # questions are long and their answers short: to compile one takes seconds, and to answer it milliseconds
        connection.autocommit = True
        connection.execute("SET jit = off")
        connection.autocommit = False

    return engine


def _pool(address: URL) -> dict[str, Any]:
    """How many connections there are; one in memory is all of the database."""
    is_file = address.database not in (None, "", ":memory:")
    return {"pool_size": CONNECTIONS, "max_overflow": CONNECTIONS, "pool_use_lifo": True} if is_file else {}


def _sqlite(address: URL, *, durable: bool, cache_bytes: int) -> Engine:
    path = address.database
    uri = None if path in (None, "", ":memory:") else read_only_uri(Path(path))
    if uri is None:
        engine = create_engine(address, connect_args={"timeout": WAIT_S}, **_pool(address))
    else:
        read = partial(sqlite3.connect, uri, uri=True, timeout=WAIT_S, check_same_thread=False)
        engine = create_engine(address, creator=read, **_pool(address))
    tell_outages(engine)
    synchronous = "FULL" if durable else "NORMAL"

    @event.listens_for(engine, "connect")
    def prepare(connection: SqliteConnection, record: Any) -> None:
        # transactions are begun below, and not when sqlite3 thinks fit
        connection.isolation_level = None
        connection.execute(f"PRAGMA page_size = {PAGE_BYTES}")
        try:
            # reads the schema; of a damaged one SQLite tells a part, which need not be text
            connection.execute("PRAGMA journal_mode = WAL" if uri is None else "PRAGMA schema_version")
        except UnicodeDecodeError:
            told = f"store {address!r}: the schema is no text"
            raise DamagedError(f"{told}; expected the SQLite file that was written") from None
        connection.execute(f"PRAGMA synchronous = {synchronous}")
        connection.execute("PRAGMA foreign_keys = ON")
        connection.create_function(IN_SQLITE, 1, small, deterministic=True)
        connection.execute(f"PRAGMA cache_size = -{cache_bytes >> 10}")
        connection.execute(f"PRAGMA wal_autocheckpoint = {CHECKPOINT_PAGES}")

    @event.listens_for(engine, "begin")
    def begin(connection: Connection) -> None:
        # a reader that turns writer later may find that another was faster: writers say so at once
        writes = connection.get_execution_options().get("palpate_writes", False)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


@contextmanager
def asking(engine: Engine) -> Iterator[Connection]:
    """A connection for questions, of which each sees all that is committed by then, as in a transaction of its own.

    PostgreSQL is not told where they begin and end. And as nothing is rolled back, its driver does not throw away what
    it has prepared: questions that are often asked are planned once, which takes longer than most answers. An engine
    of `as_of_one_moment` asks in one transaction all the same.
    """
    with engine.connect() as connection:
        if engine.dialect.name == "postgresql" and "isolation_level" not in connection.get_execution_options():
            connection.execution_options(isolation_level="AUTOCOMMIT")
        yield connection


def writing(engine: Engine) -> Engine:
    """The same engine for transactions that write."""
    return engine.execution_options(palpate_writes=True)


@contextmanager
def changing(engine: Engine) -> Iterator[Connection]:
    """One transaction that writes.

    Raises
    ------
    UnavailableError
        If the database does not take it.
    """
    try:
        with writing(engine).begin() as connection:
            yield connection
    except DatabaseError as error:
        told = f"store {engine.url!r}: {' '.join(str(error.orig).split())}"
        raise UnavailableError(f"{told}; nothing was changed") from None


def one_at_a_time(connection: Connection, lock: int) -> None:
    """Wait until no other transaction that writes holds this lock, and hold it until this one ends."""
    # in SQLite a transaction that writes has locked out all others
    if connection.dialect.name == "postgresql":
        connection.execute(text("SELECT pg_advisory_xact_lock(:number)"), {"number": lock})


@contextmanager
def snapshot(engine: Engine) -> Iterator[Connection]:
    """One transaction that reads: all that it sees is as it was at its first look, whatever is written meanwhile."""
    with as_of_one_moment(engine).connect() as connection:
        yield connection


def as_of_one_moment(engine: Engine) -> Engine:
    """The same engine for transactions that read as `snapshot` does; in SQLite all do."""
    is_postgresql = engine.dialect.name == "postgresql"
    return engine.execution_options(isolation_level="REPEATABLE READ") if is_postgresql else engine


def revision(connection: Connection) -> str | None:
    """Which migration the tables are at; None where there are none."""
    if not inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.execute(text("SELECT version_num FROM alembic_version")).scalar()
    return found


def is_store(engine: Engine) -> bool:
    """Whether there are the tables of a store in a database.

    Raises
    ------
    StoreError
        If the database cannot be reached.
    """
    with _told(engine), engine.connect() as connection:
        return revision(connection) is not None


def up_to_date(engine: Engine) -> None:
    """Make the tables, or change those of an older version.

    Raises
    ------
    StoreError
        If the database cannot be reached, or a newer version of the package made it.
    """
    with _told(engine):
        with engine.connect() as connection:
            if revision(connection) == LATEST:
                return
        migrate(engine, "head")


@contextmanager
def _told(engine: Engine) -> Iterator[None]:
    try:
        yield
    except DatabaseError as error:
        # PostgreSQL tells on further lines where in a statement
        said = str(error.orig).partition("\n")[0]
        raise StoreError(f"store {engine.url!r}: {said}; expected a database that can be written") from None


def migrate(engine: Engine, target: str) -> None:
    """Bring the tables to a revision, up or down (``"base"``: no tables).

    Raises
    ------
    DamagedError
        If the tables do not say of which version they are.
    StoreError
        If they are of a version that is not known here.
    """
    from alembic import command
    from alembic.config import Config
    from alembic.script import ScriptDirectory

    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    with writing(engine).begin() as connection:
        config.attributes["connection"] = connection
        # two programs may open a new store at once
        one_at_a_time(connection, MIGRATION_LOCK)
        found = revision(connection)
        if found is None and inspect(connection).has_table("recordings"):
            raise DamagedError(
                f"store {engine.url!r}: does not say of which version its tables are, expected that it does"
            )
        known = {script.revision for script in ScriptDirectory.from_config(config).walk_revisions()}
        if found is not None and found not in known:
            raise StoreError(
                f"store {engine.url!r}: tables of version {found}, expected {LATEST} or older: update palpate"
            )
        if target == "base" or (found is not None and target < found and target != "head"):
            command.downgrade(config, target)
        else:
            command.upgrade(config, target)
