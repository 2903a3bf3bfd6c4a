"""Two indexes hold all that says who sees a recording, so that lists of objects and setups count without reading it."""

from __future__ import annotations

from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0005"
down_revision = "0004"

SEEN_BY = ("visibility", "embargoed_us", "owner", "uploaded_by")
COLUMNS = {"ix_recordings_of_thing": "thing_id", "ix_recordings_of_setup": "setup_id"}


def upgrade() -> None:
    """Make wider indexes in place of those there are."""
    for name, column in COLUMNS.items():
        op.create_index(op.f(name), "recordings", [column, "recorded_us", "id", *SEEN_BY])
        op.drop_index(_before(column), table_name="recordings")


def downgrade() -> None:
    """Make the indexes that there were."""
    for name, column in COLUMNS.items():
        op.create_index(_before(column), "recordings", [column, "recorded_us", "id"])
        op.drop_index(op.f(name), table_name="recordings")


def _before(column: str) -> str:
    return op.f(f"ix_recordings_{column}_recordings_recorded_us_recordings_id")
