"""Colours of devices as the pages have them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from palpate.server.plots.device_colours import device_colours
from palpate.store.device_order import device_names
from palpate.store.store import Store

__all__ = ["colours_of"]


def colours_of(store: Store, drawn: Iterable[str]) -> Mapping[str, int]:
    """The colour of each device that is drawn, by the order in which the store has heard of them."""
    return device_colours(device_names(store), drawn)
