"""Who has sent something, until when others do not see it, and who an account is to a provider of log-ins."""

from __future__ import annotations

import json
import time
from typing import Any

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0004"
down_revision = "0003"

PUT_ASIDE = "put aside by a downgrade to 0003"
SHARED = ("recordings", "episodes")
LINKS = {"recording_id": "recordings", "episode_id": "episodes"}
IDENTITY = ("oidc_issuer", "oidc_subject")
ONE_ACCOUNT = "ix_users_oidc_issuer_users_oidc_subject"
Id = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Add columns, and what a downgrade has put aside."""
    for name in SHARED:
        op.add_column(name, sa.Column("uploaded_by", sa.String()))
        op.add_column(name, sa.Column("embargoed_us", sa.BigInteger()))
    with op.batch_alter_table("audit") as table:
        for column, other in LINKS.items():
            table.add_column(sa.Column(column, Id))
            table.create_foreign_key(op.f(f"fk_audit_{column}_{other}"), other, [column], ["id"])
    for column in LINKS:
        op.create_index(op.f(f"ix_audit_{column}"), "audit", [column])
    for column in IDENTITY:
        op.add_column("users", sa.Column(column, sa.String()))
    op.create_index(op.f(ONE_ACCOUNT), "users", list(IDENTITY), unique=True)
    _bring_back()


def downgrade() -> None:
    """Remove the columns; a line of the audit keeps what they say, and what is embargoed is private meanwhile."""
    _put_aside()
    op.drop_index(op.f(ONE_ACCOUNT), table_name="users")
    for column in reversed(IDENTITY):
        op.drop_column("users", column)
    for column in reversed(LINKS):
        op.drop_index(op.f(f"ix_audit_{column}"), table_name="audit")
    with op.batch_alter_table("audit") as table:
        for column, other in reversed(LINKS.items()):
            table.drop_constraint(op.f(f"fk_audit_{column}_{other}"), type_="foreignkey")
            table.drop_column(column)
    for name in SHARED:
        for column in ("embargoed_us", "uploaded_by"):
            op.drop_column(name, column)


def _table(name: str, *columns: str) -> sa.TableClause:
    return sa.table(name, *(sa.column(column) for column in columns))


def _shared(name: str) -> sa.TableClause:
    return _table(name, "id", "visibility", "uploaded_by", "embargoed_us")


def _put_aside() -> None:
    connection, now = op.get_bind(), time.time_ns() // 1000
    audit, users = _table("audit", "id", "at_us", "what", "detail", *LINKS), _table("users", "id", *IDENTITY)
    detail: dict[str, list[list[Any]]] = {}
    for name in SHARED:
        table = _shared(name)
        said = sa.or_(table.c.uploaded_by.is_not(None), table.c.embargoed_us.is_not(None))
        detail[name] = _rows(sa.select(table).where(said))
        # the version before would show it to all
        hidden = sa.update(table).where(table.c.embargoed_us > now)
        connection.execute(hidden.values(visibility="private"))
    linked = sa.or_(*(audit.c[column].is_not(None) for column in LINKS))
    detail["audit"] = _rows(sa.select(audit.c.id, *(audit.c[column] for column in LINKS)).where(linked))
    detail["users"] = _rows(sa.select(users).where(users.c.oidc_subject.is_not(None)))
    if any(detail.values()):
        # a line without an object stands in no history
        line = {"at_us": now, "what": PUT_ASIDE, "detail": json.dumps(detail)}
        connection.execute(sa.insert(_table("audit", *line)).values(**line))


def _rows(asked: sa.Select[*tuple[Any, ...]]) -> list[list[Any]]:
    return [list(row) for row in op.get_bind().execute(asked)]


def _bring_back() -> None:
    """What `_put_aside` kept; rows are never removed, so that their numbers hold."""
    connection, audit = op.get_bind(), _table("audit", "id", "what", "detail")
    kept = audit.c.what == PUT_ASIDE
    for detail in map(json.loads, connection.scalars(sa.select(audit.c.detail).where(kept).order_by(audit.c.id)).all()):
        for name in SHARED:
            _restore(_shared(name), ("visibility", "uploaded_by", "embargoed_us"), detail[name])
        _restore(_table("audit", "id", *LINKS), tuple(LINKS), detail["audit"])
        _restore(_table("users", "id", *IDENTITY), IDENTITY, detail["users"])
    connection.execute(sa.delete(audit).where(kept))


def _restore(table: sa.TableClause, columns: tuple[str, ...], rows: list[list[Any]]) -> None:
    for row, *values in rows:
        that = sa.update(table).where(table.c.id == row)
        op.get_bind().execute(that.values(**dict(zip(columns, values, strict=True))))
