"""Recordings that nobody made: 150 samples of 3 channels, one result, 60 objects, 5 grippers."""

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from palpate.store.entries import Value
from palpate.store.opening import open_store
from palpate.store.records import Channel, Device, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from tests.store.places import check_services, emptied

BATCH = 1000
GRIPPERS = [Setup(gripper=Device("gripper", f"gripper{number}")) for number in range(5)]
PROPERTIES = {"elasticity": "kPa", "mass": "g", "volume": "cm^3"}
START = datetime(2024, 1, 1, tzinfo=UTC)


def recordings(first: int, count: int, samples: int = 150) -> list[Recording]:
    """Recordings of consecutive numbers; the same number is the same recording."""
    rng = np.random.default_rng(first)
    units = {"position": ("length", "mm"), "current": ("current", "A"), "force": ("force", "N")}
    names = list(PROPERTIES)
    made = []
    for number in range(first, first + count):
        signals = rng.normal(size=(3, samples)).cumsum(axis=1)
        channels = [
            Channel(name, quantity, unit, values, 100.0)
            for values, (name, (quantity, unit)) in zip(signals, units.items(), strict=True)
        ]
        name = names[number % 3]
        made.append(
            Recording(
                START + timedelta(seconds=number),
                "squeezing",
                ThingRef("made up", f"object{number % 60}"),
                GRIPPERS[number % 5],
                series=(Series("gripper", tuple(channels)),),
                entries=(Value(name, 40.0 + rng.normal(), 10.0, PROPERTIES[name]),),
            )
        )
    return made


def new_store(kind: str, folder: Path, *, durable: bool = False) -> Store:
    """An empty store of a kind; skipped where it needs a service that is not told."""
    check_services(kind)
    place = emptied() if kind == "postgresql" else folder / "store.sqlite"
    return open_store(place, folder / "blobs", durable=durable)


def fill(store: Store, count: int) -> None:
    """Put recordings, a batch at a time."""
    for first in range(0, count, BATCH):
        store.put_many(recordings(first, min(BATCH, count - first)))
