"""The names of all devices in an order that stays, as new ones come at its end."""

from __future__ import annotations

from sqlalchemy import func, select

from palpate.store import schema
from palpate.store.database import asking
from palpate.store.store import Store

__all__ = ["device_names"]


def device_names(store: Store) -> tuple[str, ...]:
    """Each name once, in the order in which the store first heard of it."""
    columns = schema.devices.c
    asked = select(columns.name).group_by(columns.name).order_by(func.min(columns.id))
    with asking(store.engine) as connection:
        return tuple(connection.scalars(asked))
