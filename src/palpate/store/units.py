"""The unit that each property of a store was first given in, which decides its dimension."""

from __future__ import annotations

from collections.abc import Mapping

from sqlalchemy import select

from palpate.store import schema
from palpate.store.store import Store

__all__ = ["units_of"]


def units_of(store: Store) -> Mapping[str, str]:
    """Property to its unit."""
    with store.engine.connect() as connection:
        return {row.name: row.unit for row in connection.execute(select(schema.properties))}
