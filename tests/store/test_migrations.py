"""Filled stores of every earlier version, brought up to date and taken down again, on SQLite and PostgreSQL."""

import multiprocessing
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from uuid import UUID

import pytest
from alembic.script import ScriptDirectory
from sqlalchemy import Engine, inspect
from sqlalchemy.engine.interfaces import ReflectedForeignKeyConstraint

from palpate.cli import main
from palpate.server.security.accounts import Role, add_user
from palpate.store import database, schema
from palpate.store.audit import history
from palpate.store.blobs import FolderBlobs
from palpate.store.database import LATEST, MIGRATIONS, connect, migrate, revision, up_to_date
from palpate.store.describing import change_thing
from palpate.store.errors import StoreError
from palpate.store.keeping_episodes import put_episode
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.rows import microseconds
from palpate.store.store import Store
from palpate.store.things import list_things
from palpate.store.undoing import undo
from palpate.store.verifying import verify
from palpate.store.viewing import Viewer
from palpate.store.visible_things import ThingFilter, list_visible_things
from tests.store.made_up import made_episode, squeeze
from tests.store.places import check_services, emptied
from tests.store.versions.filled import Filled, filled, rows_of, versions
from tests.store.versions.make import insert

REVISIONS = [
    script.revision
    for script in reversed(list(ScriptDirectory(str(MIGRATIONS), version_locations=[]).walk_revisions()))
]
BROKEN = '''
"""A step that does not get to its end."""
import time
import sqlalchemy as sa
from alembic import op

revision = "9998"
down_revision = "{latest}"


def upgrade():
    op.add_column("things", sa.Column("colour", sa.String()))
    op.create_table("colours", sa.Column("name", sa.String()))
    op.execute("UPDATE recordings SET owner = 'nobody'")
    {end}
'''
OPENING = """
import sys
from pathlib import Path
from typing import Any
from palpate.store import database
from palpate.store.opening import open_store
database.MIGRATIONS, database.LATEST = Path(sys.argv[1]), "9998"
open_store(sys.argv[2], sys.argv[3])
"""


KEPT = ("audit", "recordings", "episodes", "users", "senders")
IDENTIFY = "UPDATE users SET oidc_issuer = 'https://login.lab.example', oidc_subject = 'c-1' WHERE name = 'carla'"


@pytest.fixture(params=["sqlite", "postgresql"])
def place(request: pytest.FixtureRequest, tmp_path: Path) -> str:
    """Address of a database without tables."""
    check_services(request.param)
    return emptied() if request.param == "postgresql" else f"sqlite:///{tmp_path}/store.sqlite"


@pytest.fixture
def engine(place: str) -> Iterator[Engine]:
    made = connect(place, durable=False)
    yield made
    made.dispose()


def fill(engine: Engine, blobs: Path, version: str) -> Filled:
    """A store of a version as it was left."""
    left = filled(version)
    migrate(engine, version)
    with database.writing(engine).begin() as connection:
        left.insert(connection, FolderBlobs(blobs))
    return left


def digests(store: Store) -> dict[str, str]:
    """What reading each recording, and verifying it, gives."""
    found: dict[str, str] = {}
    page = list_recordings(store)
    for row in page.rows:
        found[row.id.hex] = store.get(row.id).digest
    return found


def tables_of(engine: Engine) -> set[str]:
    with engine.connect() as connection:
        return set(inspect(connection).get_table_names())


def unchanged(engine: Engine, left: Filled) -> bool:
    """Whether each row that was left is there with all its values, whatever columns there are beside."""
    with engine.connect() as connection:
        for table, rows in left.tables.items():
            there = rows_of(connection, table, list(rows[0])) if rows else []
            assert sorted(map(repr, (sorted(row.items()) for row in there))) == sorted(
                map(repr, (sorted({**row, **_logical(engine, row)}.items()) for row in rows))
            ), table
    return True


def _logical(engine: Engine, row: dict[str, object]) -> dict[str, object]:
    """What SQLite gives in place of true and false."""
    return {name: int(value) for name, value in row.items() if isinstance(value, bool) and engine.name == "sqlite"}


def described(engine: Engine) -> dict[str, object]:
    """All columns, keys and indices, as the database itself tells them."""
    found: dict[str, object] = {}
    with engine.connect() as connection:
        seen = inspect(connection)
        for table in sorted(set(seen.get_table_names()) - {"alembic_version"}):
            columns = {one["name"]: (str(one["type"]), one["nullable"]) for one in seen.get_columns(table)}
            foreign = [_named(engine, one) for one in seen.get_foreign_keys(table)]
            lists = (seen.get_indexes(table), seen.get_unique_constraints(table), foreign)
            keys = [sorted(map(_plain, some)) for some in lists]
            found[table] = columns, keys, seen.get_pk_constraint(table)
    return found


def _named(engine: Engine, key: ReflectedForeignKeyConstraint) -> object:
    """A foreign key; of one that was added with its column SQLite does not tell the name."""
    return {**key, "name": None} if engine.name == "sqlite" else key


def _plain(key: object) -> str:
    assert isinstance(key, dict)
    # the condition of an index is an object that says nothing of itself
    options = {name: str(value) for name, value in key.get("dialect_options", {}).items()}
    return repr(sorted({**key, "dialect_options": options}.items()))


def test_each_earlier_version_has_a_filled_store() -> None:
    """A migration cannot be added without a store to try it on: see `tests.store.versions.make`."""
    assert REVISIONS[-1] == LATEST
    assert set(REVISIONS[:-1]) <= set(versions()) <= set(REVISIONS)


@pytest.mark.parametrize("version", versions())
def test_a_filled_store_comes_up(place: str, engine: Engine, tmp_path: Path, version: str) -> None:
    """Opened by the code of today, a store of an earlier version gives all its recordings, verifies and takes more."""
    left = fill(engine, tmp_path / "blobs", version)
    assert unchanged(engine, left), "the tables of a version are those that its rows were taken from"
    with open_store(place, tmp_path / "blobs") as store:
        assert digests(store) == left.digests
        assert list(verify(store)) == []
        assert unchanged(engine, left)
        some = store.get(UUID(hex=next(iter(left.digests))))
        assert [receipt.new for receipt in store.put_many([some, squeeze(999)])] == [False, True]
        assert list(verify(store)) == []


@pytest.mark.parametrize("version", [version for version in versions() if version < LATEST])
def test_a_damaged_store_comes_up(place: str, engine: Engine, tmp_path: Path, version: str) -> None:
    """Whatever its documents are by now it can be opened, and verification names what is damaged."""
    fill(engine, tmp_path / "blobs", version)
    tables = ("episodes", "episode_steps", "recordings", "thing_properties")
    with engine.begin() as connection:
        for table in tables:
            connection.exec_driver_sql(f"UPDATE {table} SET document = '{{'")
        if engine.name == "sqlite":
            connection.exec_driver_sql("UPDATE recordings SET digest = 'text' WHERE id = 1")
    with open_store(place, tmp_path / "blobs") as store:
        found = {fault.where.partition(" ")[0] for fault in verify(store)}
    assert found >= {"episode", "recording", "object"}


@pytest.mark.parametrize("version", versions())
def test_a_filled_store_goes_down_and_up(place: str, engine: Engine, tmp_path: Path, version: str) -> None:
    """Taken down to its version a store is what it was, and up again too; taken down to nothing it begins anew."""
    left = fill(engine, tmp_path / "blobs", version)
    up_to_date(engine)
    migrate(engine, version)
    with engine.connect() as connection:
        assert revision(connection) == version
    assert unchanged(engine, left)
    with open_store(place, tmp_path / "blobs") as store:
        assert digests(store) == left.digests
        assert list(verify(store)) == []
    migrate(engine, "base")
    assert tables_of(engine) == {"alembic_version"}
    with open_store(place, tmp_path / "blobs") as store:
        assert digests(store) == {}
        assert store.put(squeeze()).new


@pytest.mark.parametrize("version", versions())
def test_nothing_is_lost_below_the_newest_version(place: str, engine: Engine, tmp_path: Path, version: str) -> None:
    """Taken down to the first version and up again, a store says the same of its objects and episodes as before."""
    fill(engine, tmp_path / "blobs", version)
    with open_store(place, tmp_path / "blobs") as store:
        thing, recording = next(one.ref for one in list_things(store) if one.recordings), squeeze(999)
        change_thing(store, thing, lambda found: found.described(maker="somebody"), who="ann")
        undo(store, thing, who="bob")
        store.put(recording)
        for number, visibility in enumerate(("private", "lab", "public"), 50):
            put_episode(store, made_episode(recording, number=number, owner="ann", stop="done", visibility=visibility))
        for number, days in enumerate((-1, 1)):
            until = datetime.now(UTC) + timedelta(days=days)
            shared: dict[str, Any] = {"visibility": "public", "embargoed_until": until}
            store.put(squeeze(1000 + number, **shared), uploader="bob")
            put_episode(store, made_episode(recording, number=60 + number, **shared), uploader="bob")
            store.put(squeeze(1000 + number, **shared), uploader="carla")
        add_user(store, "carla", Role.READER)
        with engine.begin() as connection:
            connection.exec_driver_sql(IDENTIFY)
        before = list_things(store), list_episodes(store).rows, history(store)
        with engine.connect() as connection:
            rows = {table: rows_of(connection, table, ["*"]) for table in KEPT}
    migrate(engine, "0003")
    with engine.connect() as connection:
        # the version before knows no embargo, and must not show what is under one
        hidden = [rows_of(connection, table, ["uuid", "visibility"]) for table in ("recordings", "episodes")]
        public = [sum(row["visibility"] == "public" for row in some) for some in hidden]
    whole = [sum(row["visibility"] == "public" for row in rows[table]) for table in ("recordings", "episodes")]
    assert public == [count - 1 for count in whole]
    migrate(engine, REVISIONS[0])
    with engine.connect() as connection:
        assert revision(connection) == REVISIONS[0]
    with open_store(place, tmp_path / "blobs") as store:
        assert (list_things(store), list_episodes(store).rows, history(store)) == before
        assert list(verify(store)) == []
        with engine.connect() as connection:
            for table, left in rows.items():
                assert plain(rows_of(connection, table, ["*"])) == plain(left), table


def plain(rows: list[dict[str, object]]) -> list[str]:
    """Rows that can be compared, whatever the order of their columns."""
    return sorted(repr(sorted(row.items())) for row in rows)


def test_episodes_are_filled_from_their_documents(place: str, engine: Engine, tmp_path: Path) -> None:
    """What an episode of the first version says of its owner, its actions and its end stands in the new columns."""
    fill(engine, tmp_path / "blobs", REVISIONS[0])
    whole = made_episode(squeeze(0), squeeze(1), number=60, owner="ann", stop="enough")
    with engine.begin() as connection:
        row = {"digest": bytes.fromhex(whole.digest), "started_us": microseconds(whole.started_at)}
        insert(connection, "episodes", id=60, uuid=whole.id.bytes, thing_id=1, document=whole.document, **row)
        for position, step in enumerate(whole.steps):
            insert(connection, "episode_steps", episode_id=60, position=position, document=step.document)
    with open_store(place, tmp_path / "blobs") as store:
        (listed,) = (one for one in list_episodes(store).rows if one.id == whole.id)
        assert (listed.owner, listed.actions, listed.stop, listed.visibility) == ("ann", 2, "enough", "private")


SAID = ("thing_id", "digest", "maker", "common_name", "aliases")
BOX = ThingRef("lab", "box")


def test_descriptions_are_filled_from_words(place: str, engine: Engine, tmp_path: Path) -> None:
    """A store of before knows what each of its recordings says of its object, as one that is filled today does."""
    fill(engine, tmp_path / "blobs", "0006")
    with open_store(place, tmp_path / "blobs") as store:
        hidden = replace(BOX, common_name="Big\nBox", maker="Acme", aliases=("case",))
        store.put(squeeze(1000, thing=BOX, visibility="public", notices=("case",)))
        store.put_checked([squeeze(1001, thing=hidden)])
        store.put_many([squeeze(1002, thing=replace(BOX, aliases=("case", "Pot")))])
        store.put(squeeze(1003, thing=replace(BOX, maker="Acme"), visibility="public"))
    before = described_in(engine)
    migrate(engine, "0006")
    with open_store(place, tmp_path / "blobs") as store:
        assert described_in(engine) == before
        (box,) = list_visible_things(store, Viewer(), ThingFilter(text="acme box lab")).rows
        assert (box.ref, box.recordings) == (replace(BOX, maker="Acme"), 2)
        assert not list_visible_things(store, Viewer(), ThingFilter(text="case box")).rows
        mugs = list_visible_things(store, Viewer(), ThingFilter(text="Häf cup")).rows
    assert len(mugs) == len([version for version in versions() if version <= "0006"])


def described_in(engine: Engine) -> list[list[str]]:
    """What is said of objects, and by which recordings."""
    tables = {"descriptions": list(SAID), "recordings": ["uuid", "description_id"]}
    with engine.connect() as connection:
        return [plain(rows_of(connection, table, columns)) for table, columns in tables.items()]


def test_words_that_are_damaged_say_nothing(place: str, engine: Engine, tmp_path: Path) -> None:
    """What a recording says of its object, and what else, cannot be told apart then: nobody learns it by a search."""
    fill(engine, tmp_path / "blobs", "0006")
    with engine.begin() as connection:
        connection.exec_driver_sql("UPDATE recordings SET document = '{', visibility = 'public'")
        connection.exec_driver_sql("UPDATE things SET aliases = '['")
    up_to_date(engine)
    with engine.connect() as connection:
        assert rows_of(connection, "descriptions", ["*"]) == []


@pytest.mark.parametrize("version", REVISIONS)
def test_all_ways_lead_to_the_schema(engine: Engine, tmp_path: Path, version: str) -> None:
    """From each version the migrations lead to the tables that the code describes: columns, keys and indices."""
    schema.metadata.create_all(engine)
    wanted = described(engine)
    schema.metadata.drop_all(engine)
    if version in versions():
        fill(engine, tmp_path / "blobs", version)
    else:
        migrate(engine, version)
    up_to_date(engine)
    assert described(engine) == wanted


def with_broken_step(folder: Path, end: str) -> Path:
    """The migrations, and one more that ends otherwise than it should."""
    copied = folder / "migrations"
    shutil.copytree(MIGRATIONS, copied, ignore=shutil.ignore_patterns("__pycache__"))
    (copied / "versions" / "broken.py").write_text(BROKEN.format(latest=LATEST, end=end))
    return copied


def check_old_version(place: str, engine: Engine, blobs: Path, left: Filled) -> None:
    """The store is of the version of before, and whole."""
    with engine.connect() as connection:
        assert revision(connection) == LATEST
        assert "colour" not in {column["name"] for column in inspect(connection).get_columns("things")}
    assert "colours" not in tables_of(engine)
    assert unchanged(engine, left)
    with open_store(place, blobs) as store:
        assert digests(store) == left.digests
        assert list(verify(store)) == []


def test_a_failed_migration_leaves_the_old_version(
    place: str, engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A step that fails in the middle leaves nothing of itself."""
    left = fill(engine, tmp_path / "blobs", versions()[-1])
    up_to_date(engine)
    monkeypatch.setattr(database, "MIGRATIONS", with_broken_step(tmp_path, "op.drop_table('nowhere')"))
    monkeypatch.setattr(database, "LATEST", "9998")
    with pytest.raises(StoreError, match="nowhere"):
        open_store(place, tmp_path / "blobs")
    monkeypatch.undo()
    check_old_version(place, engine, tmp_path / "blobs", left)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_migration_leaves_the_old_version(place: str, engine: Engine, tmp_path: Path) -> None:
    """A program that is killed in the middle of a step leaves nothing of it."""
    left = fill(engine, tmp_path / "blobs", versions()[-1])
    up_to_date(engine)
    reached = tmp_path / "reached"
    end = f"open({str(reached)!r}, 'w').close(); time.sleep(60)"
    arguments = [str(with_broken_step(tmp_path, end)), place, str(tmp_path / "blobs")]
    with subprocess.Popen([sys.executable, "-c", OPENING, *arguments]) as opening:
        while not reached.exists():
            assert opening.poll() is None
            time.sleep(0.02)
        opening.send_signal(signal.SIGKILL)
    check_old_version(place, engine, tmp_path / "blobs", left)


def test_a_store_of_a_newer_version_is_refused(
    place: str, engine: Engine, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Tables of a version that is not known yet are left alone, and the command line says so in one sentence."""
    migrate(engine, "head")
    with engine.begin() as connection:
        connection.exec_driver_sql("UPDATE alembic_version SET version_num = '9999'")
    with pytest.raises(SystemExit) as ended:
        main(["store", "show", "--store", place, "--blobs", str(tmp_path / "blobs")])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.endswith(f"tables of version 9999, expected {LATEST} or older: update palpate\n")
    assert said.count("\n") == 1
    with engine.connect() as connection:
        assert revision(connection) == "9999"


def open_and_put(place: str, blobs: Path, number: int) -> str:
    with open_store(place, blobs) as store:
        return store.put(squeeze(number)).digest


def test_programs_may_open_a_new_store_at_once(place: str, tmp_path: Path) -> None:
    """Of several programs that find no tables, one makes them and the others wait."""
    with multiprocessing.get_context("spawn").Pool(4) as pool:
        put = pool.starmap(open_and_put, [(place, tmp_path / "blobs", number % 3) for number in range(8)])
    with open_store(place, tmp_path / "blobs") as store:
        assert {store.get(digest).digest for digest in put} == {squeeze(number).digest for number in range(3)}
        assert list(verify(store)) == []
