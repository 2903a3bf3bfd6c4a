"""An index of what was done, so that a page can offer all actions without reading each recording."""

from __future__ import annotations

from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0008"
down_revision = "0007"

COLUMNS = ("ground_truth", "action", "visibility", "embargoed_us", "owner", "uploaded_by")
INDEX = "ix_recordings_of_action"


def upgrade() -> None:
    """Make the index."""
    op.create_index(op.f(INDEX), "recordings", list(COLUMNS))


def downgrade() -> None:
    """Remove it."""
    op.drop_index(op.f(INDEX), table_name="recordings")
