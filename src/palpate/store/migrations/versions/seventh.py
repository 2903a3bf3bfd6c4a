"""What recordings say of their objects stands once, apart from the other words of a recording.

It is taken from those words. Which of them is the maker the object's own row tells; whatever else is said is a name.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from hashlib import sha256
from typing import Any

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0007"
down_revision = "0006"

AT_ONCE = 1000
INDEXED = ("description_id", "visibility", "embargoed_us", "owner", "uploaded_by")
INDEX = "ix_recordings_of_description"
SAID = ("maker", "common_name", "aliases")
DESCRIBED = ("thing_id", "digest", *SAID, "words")
LINK = "fk_recordings_description_id_descriptions"
Id = sa.BigInteger().with_variant(sa.Integer(), "sqlite")
Row = sa.Row[*tuple[Any, ...]]


def upgrade() -> None:
    """Make the table, fill it, and let recordings refer to it."""
    op.create_table(
        "descriptions",
        sa.Column("id", Id, nullable=False),
        sa.Column("thing_id", Id, nullable=False),
        sa.Column("digest", sa.LargeBinary(32), nullable=False),
        sa.Column("maker", sa.String(), nullable=True),
        sa.Column("common_name", sa.String(), nullable=True),
        sa.Column("aliases", sa.Text(), nullable=False),
        sa.Column("words", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_descriptions_thing_id_things")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_descriptions")),
        sa.UniqueConstraint("thing_id", "digest", name=op.f("uq_descriptions_thing_id_digest")),
    )
    if op.get_bind().dialect.name == "sqlite":
        # a batch of alembic's would copy the table
        op.execute(
            f"ALTER TABLE recordings ADD COLUMN description_id INTEGER CONSTRAINT {LINK} REFERENCES descriptions (id)"
        )
    else:
        op.add_column("recordings", sa.Column("description_id", Id))
        op.create_foreign_key(op.f(LINK), "recordings", "descriptions", ["description_id"], ["id"])
    _fill()
    some = sa.text("description_id IS NOT NULL")
    op.create_index(op.f(INDEX), "recordings", list(INDEXED), sqlite_where=some, postgresql_where=some)


def downgrade() -> None:
    """Remove it: the words of recordings say the same."""
    op.drop_index(op.f(INDEX), table_name="recordings")
    if op.get_bind().dialect.name != "sqlite":
        op.drop_constraint(op.f(LINK), "recordings", type_="foreignkey")
    op.drop_column("recordings", "description_id")
    op.drop_table("descriptions")


def _fill() -> None:
    connection, recordings, descriptions = op.get_bind(), _table("recordings", "id", "description_id"), _Descriptions()
    to = sa.update(recordings).where(recordings.c.id == sa.bindparam("row"))
    for rows in _chunks():
        said = [(row, words) for row in rows if (words := _said(row))]
        if said:
            found = [{"row": row.id, "description_id": descriptions.row(row.thing_id, words)} for row, words in said]
            connection.execute(to, found)


def _chunks() -> Iterator[Sequence[Row]]:
    recordings = _table("recordings", "id", "thing_id", "setup_id", "action", "owner", "words", "document")
    things, setups = _table("things", "id", "dataset", "name"), _table("setups", "id", "document")
    asked = (
        sa.select(recordings, things.c.dataset, things.c.name, setups.c.document.label("setup"))
        .join(things, things.c.id == recordings.c.thing_id)
        .join(setups, setups.c.id == recordings.c.setup_id)
        .order_by(recordings.c.id)
        .limit(AT_ONCE)
    )
    last = 0
    while rows := op.get_bind().execute(asked.where(recordings.c.id > last)).all():
        yield rows
        last = rows[-1].id


def _said(row: Row) -> str:
    """What stands between data set and name, with which the words begin, and what is not of the object; of lines."""
    try:
        setup = json.loads(row.setup)
        named = [setup[name] for name in ("arm", "gripper", "camera", "microphone") if setup[name]] + setup["other"]
        rest = [*(device["name"] for device in named), row.owner, *json.loads(row.document)["notices"]]
        begin, end = _lines(row.action, row.dataset, row.name), _lines(*rest)
        words = row.words + "\n"
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
        # damaged, as verification tells: it says nothing to anybody
        return ""
    is_whole = words.startswith(begin) and words.endswith(end) and len(words) >= len(begin) + len(end)
    return words[len(begin) : len(words) - len(end)] if is_whole else ""


def _lines(*texts: str | None) -> str:
    return "".join(f"{text}\n" for text in texts if text).casefold()


class _Descriptions:
    """The rows that say something of an object, each made once."""

    def __init__(self) -> None:
        self._found: dict[tuple[int, str], int] = {}
        self._made: dict[tuple[int, bytes], int] = {}

    def row(self, thing: int, words: str) -> int:
        """That of these words."""
        if (thing, words) not in self._found:
            self._found[thing, words] = self._row(thing, words)
        return self._found[thing, words]

    def _row(self, thing: int, words: str) -> int:
        things, descriptions = _table("things", "id", *SAID), _table("descriptions", "id", *DESCRIBED)
        said = _apart(op.get_bind().execute(sa.select(things).where(things.c.id == thing)).one(), words)
        digest = sha256(_to_json(said).encode()).digest()
        if (thing, digest) not in self._made:
            new = sa.insert(descriptions).values(thing_id=thing, digest=digest, words=words[:-1], **said)
            self._made[thing, digest] = op.get_bind().execute(new.returning(descriptions.c.id)).scalar_one()
        return self._made[thing, digest]


def _apart(known: Row, words: str) -> dict[str, Any]:
    """The words, told apart by what is known of the object, in the letters in which it is known."""
    left = "\n" + words

    def told(text: str | None) -> bool:
        nonlocal left
        line = f"\n{text or ''}\n".casefold()
        is_there = bool(text) and line in left
        left = left.replace(line, "\n") if is_there else left
        return is_there

    common_name, maker = (name if told(name) else None for name in (known.common_name, known.maker))
    try:
        aliases = [name for name in json.loads(known.aliases) if told(name)]
    except ValueError:
        # damaged
        aliases = []
    aliases += (line for line in left.split("\n") if line)
    return {"maker": maker, "common_name": common_name, "aliases": _to_json(aliases)}


def _to_json(plain: Any) -> str:
    return json.dumps(plain, sort_keys=True, separators=(",", ":"), ensure_ascii=False)


def _table(name: str, *columns: str) -> sa.TableClause:
    return sa.table(name, *(sa.column(column) for column in columns))
