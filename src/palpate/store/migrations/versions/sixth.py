"""Who else has sent a recording."""

from __future__ import annotations

import json
import time

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0006"
down_revision = "0005"

PUT_ASIDE = "put aside by a downgrade to 0005"
COLUMNS = ("name", "recording_id", "sent_us")
Id = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Make the table, and fill it with what a downgrade has put aside."""
    op.create_table(
        "senders",
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("recording_id", Id, nullable=False),
        sa.Column("sent_us", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["recording_id"], ["recordings.id"], name=op.f("fk_senders_recording_id_recordings")),
        sa.PrimaryKeyConstraint("name", "recording_id", name=op.f("pk_senders")),
        sqlite_with_rowid=False,
    )
    connection, audit, senders = op.get_bind(), _table("audit", "id", "what", "detail"), _table("senders", *COLUMNS)
    kept = audit.c.what == PUT_ASIDE
    for detail in connection.scalars(sa.select(audit.c.detail).where(kept)).all():
        rows = [dict(zip(COLUMNS, row, strict=True)) for row in json.loads(detail)]
        connection.execute(sa.insert(senders), rows)
    connection.execute(sa.delete(audit).where(kept))


def downgrade() -> None:
    """Remove the table; a line of the audit keeps what it says."""
    connection, senders = op.get_bind(), _table("senders", *COLUMNS)
    rows = [list(row) for row in connection.execute(sa.select(senders))]
    if rows:
        # a line without an object stands in no history
        line = {"at_us": time.time_ns() // 1000, "what": PUT_ASIDE, "detail": json.dumps(rows)}
        connection.execute(sa.insert(_table("audit", *line)).values(**line))
    op.drop_table("senders")


def _table(name: str, *columns: str) -> sa.TableClause:
    return sa.table(name, *(sa.column(column) for column in columns))
