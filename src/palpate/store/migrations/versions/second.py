"""Known properties that can be asked for, whose an episode is and how it went, and who undid a change."""

from __future__ import annotations

import json

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0002"
down_revision = "0001"

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
    op.drop_index(op.f("ix_episodes_started_us"), table_name="episodes")
    op.drop_index(op.f("ix_episodes_thing_id"), table_name="episodes")
    op.create_index(op.f("ix_episodes_started_us_episodes_id"), "episodes", ["started_us", "id"])
    op.create_index(
        op.f("ix_episodes_thing_id_episodes_started_us_episodes_id"), "episodes", ["thing_id", "started_us", "id"]
    )


def downgrade() -> None:
    """Remove the columns."""
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
    names = ("id", "thing_id", "property", "source", "label", "document")
    known = sa.table("thing_properties", *(sa.column(name) for name in names))
    connection, taken = op.get_bind(), set[tuple[int, str, str]]()
    for row in connection.execute(sa.select(known).order_by(known.c.id)).mappings().all():
        source = row["source"] or NOT_STATED
        if (row["thing_id"], row["property"], source) in taken:
            source = f"{source} ({row['id']})"
        taken.add((row["thing_id"], row["property"], source))
        plain = json.loads(row["document"])
        probabilities = plain.get("probabilities") or {}
        label = min(probabilities, key=lambda name: (-probabilities[name], name)) if probabilities else None
        changed = sa.update(known).where(known.c.id == row["id"]).values(source=source, label=label)
        connection.execute(changed)
