"""A seal for each recording, by which lists find out whether its document is the one that was written."""

from __future__ import annotations

from hashlib import sha256

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0003"
down_revision = "0002"

AT_ONCE = 1000


def upgrade() -> None:
    """Add the column, and seal what is there."""
    op.add_column("recordings", sa.Column("seal", sa.LargeBinary(32)))
    connection, last = op.get_bind(), 0
    table = sa.table("recordings", sa.column("id"), sa.column("digest"), sa.column("document"), sa.column("seal"))
    # bytes also where they are something else by now, so that a damaged store can be opened and verified
    if connection.dialect.name == "sqlite":
        parts = (sa.cast(table.c.digest, sa.BLOB).label("digest"), sa.cast(table.c.document, sa.BLOB).label("text"))
    else:
        parts = (table.c.digest.label("digest"), sa.func.convert_to(table.c.document, "UTF8").label("text"))
    asked = sa.select(table.c.id, *parts).order_by(table.c.id).limit(AT_ONCE)
    changed = sa.update(table).where(table.c.id == sa.bindparam("row")).values(seal=sa.bindparam("made"))
    while rows := connection.execute(asked.where(table.c.id > last)).all():
        seals = [{"row": row.id, "made": sha256(bytes(row.digest) + bytes(row.text)).digest()} for row in rows]
        connection.execute(changed, seals)
        last = rows[-1].id


def downgrade() -> None:
    """Remove the column."""
    op.drop_column("recordings", "seal")
