"""Known properties that can be asked for, whose an episode is and how it went, and who undid a change."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping, Sequence
from typing import Any

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0002"
down_revision = "0001"

PUT_ASIDE = "put aside by a downgrade"
LINE = ("at_us", "what", "thing_id", "detail")
NOT_STATED = "not stated"
LABELLED = sa.text("label IS NOT NULL")
BY_LABEL = "ix_thing_properties_property_thing_properties_label_thing_properties_thing_id"
ONE_OF_A_SOURCE = "uq_thing_properties_thing_id_property_source"


def upgrade() -> None:
    """Add columns, and fill them from what is there."""
    _known_properties_up()
    op.add_column("audit", sa.Column("undone_by", sa.String()))
    op.add_column("episodes", sa.Column("owner", sa.String()))
    op.add_column("episodes", sa.Column("visibility", sa.String(), nullable=False, server_default="private"))
    op.add_column("episodes", sa.Column("actions", sa.Integer(), nullable=False, server_default="0"))
    op.add_column("episodes", sa.Column("stop", sa.Text()))
    _fill_episodes()
    _bring_back()
    op.drop_index(op.f("ix_episodes_started_us"), table_name="episodes")
    op.drop_index(op.f("ix_episodes_thing_id"), table_name="episodes")
    op.create_index(op.f("ix_episodes_started_us_episodes_id"), "episodes", ["started_us", "id"])
    op.create_index(
        op.f("ix_episodes_thing_id_episodes_started_us_episodes_id"), "episodes", ["thing_id", "started_us", "id"]
    )


def downgrade() -> None:
    """Remove the columns; a line of the audit keeps what they say and nothing else does, for the way up."""
    _put_aside()
    op.drop_index(op.f("ix_episodes_thing_id_episodes_started_us_episodes_id"), table_name="episodes")
    op.drop_index(op.f("ix_episodes_started_us_episodes_id"), table_name="episodes")
    op.create_index(op.f("ix_episodes_thing_id"), "episodes", ["thing_id"])
    op.create_index(op.f("ix_episodes_started_us"), "episodes", ["started_us"])
    for name in ("stop", "actions", "visibility", "owner"):
        op.drop_column("episodes", name)
    op.drop_column("audit", "undone_by")
    op.drop_index(op.f(BY_LABEL), table_name="thing_properties", sqlite_where=LABELLED, postgresql_where=LABELLED)
    with op.batch_alter_table("thing_properties") as table:
        table.drop_constraint(op.f(ONE_OF_A_SOURCE), type_="unique")
        table.alter_column("source", existing_type=sa.String(), type_=sa.Text(), nullable=True)
        table.drop_column("label")


def _fill_episodes() -> None:
    """Owner, number of actions and why it stopped, from the documents."""
    episodes = _table("episodes", "id", "document", "owner", "actions", "stop")
    steps = _table("episode_steps", "episode_id", "position", "document")
    connection = op.get_bind()
    for row in connection.execute(sa.select(episodes.c.id, episodes.c.document)).mappings().all():
        asked = sa.select(steps.c.document).where(steps.c.episode_id == row["id"]).order_by(steps.c.position)
        told = _told(row["document"], connection.scalars(asked).all())
        connection.execute(sa.update(episodes).where(episodes.c.id == row["id"]).values(**told))


def _told(document: str, steps: Sequence[str]) -> dict[str, Any]:
    """What the columns of an episode repeat; nothing of a damaged one, so that its store can be opened and verified."""
    try:
        records = [json.loads(step)["record"] for step in steps]
        return {
            "owner": json.loads(document)["owner"],
            "actions": sum("action" in record for record in records),
            "stop": records[-1].get("stop") if records else None,
        }
    except (ValueError, TypeError, LookupError, AttributeError):
        return {"owner": None, "actions": 0, "stop": None}


def _put_aside() -> None:
    """Who may see an episode, and who undid a change, where that is anything else than what the way up fills in."""
    episodes, audit = _table("episodes", "uuid", "visibility"), _table("audit", "id", *LINE, "undone_by")
    connection = op.get_bind()
    seen = sa.select(episodes).where(episodes.c.visibility != "private")
    undone = sa.select(audit.c.id, audit.c.undone_by).where(audit.c.undone_by.is_not(None))
    detail = {
        "visibility": {row.uuid.hex(): row.visibility for row in connection.execute(seen)},
        "undone_by": {str(row.id): row.undone_by for row in connection.execute(undone)},
    }
    if any(detail.values()):
        # a line without an object stands in no history
        line = {"at_us": time.time_ns() // 1000, "what": PUT_ASIDE, "thing_id": None, "detail": json.dumps(detail)}
        connection.execute(sa.insert(audit).values(**line))


def _bring_back() -> None:
    """What `_put_aside` kept, for the episodes and changes that are still there."""
    episodes, audit = _table("episodes", "uuid", "visibility"), _table("audit", "id", *LINE, "undone_by")
    connection = op.get_bind()
    kept = audit.c.what == PUT_ASIDE
    for detail in map(json.loads, connection.scalars(sa.select(audit.c.detail).where(kept).order_by(audit.c.id)).all()):
        for uuid, visibility in detail["visibility"].items():
            that = episodes.c.uuid == bytes.fromhex(uuid)
            connection.execute(sa.update(episodes).where(that).values(visibility=visibility))
        for row, who in detail["undone_by"].items():
            connection.execute(sa.update(audit).where(audit.c.id == int(row)).values(undone_by=who))
    connection.execute(sa.delete(audit).where(kept))


def _table(name: str, *columns: str) -> sa.TableClause:
    return sa.table(name, *(sa.column(column) for column in columns))


def _known_properties_up() -> None:
    op.add_column("thing_properties", sa.Column("label", sa.String()))
    _fill()
    with op.batch_alter_table("thing_properties") as table:
        table.alter_column("source", existing_type=sa.Text(), type_=sa.String(), nullable=False)
        table.create_unique_constraint(op.f(ONE_OF_A_SOURCE), ["thing_id", "property", "source"])
    op.create_index(
        op.f(BY_LABEL),
        "thing_properties",
        ["property", "label", "thing_id"],
        sqlite_where=LABELLED,
        postgresql_where=LABELLED,
    )


def _fill() -> None:
    """Sources that were not stated, or twice the same, get names of their own; labels come from the documents."""
    known = _table("thing_properties", "id", "thing_id", "property", "source", "label", "document")
    connection, taken = op.get_bind(), set[tuple[int, str, str]]()
    for row in connection.execute(sa.select(known).order_by(known.c.id)).mappings().all():
        source = row["source"] or NOT_STATED
        if (row["thing_id"], row["property"], source) in taken:
            source = f"{source} ({row['id']})"
        taken.add((row["thing_id"], row["property"], source))
        changed = sa.update(known).where(known.c.id == row["id"])
        connection.execute(changed.values(source=source, label=_label(row["document"])))


def _label(document: str) -> str | None:
    """The most probable label of what is known; none of what is damaged, as for episodes."""
    try:
        probabilities: Mapping[str, float] = json.loads(document).get("probabilities") or {}
        return min(probabilities, key=lambda name: (-probabilities[name], name)) if probabilities else None
    except (ValueError, TypeError, LookupError, AttributeError):
        return None
