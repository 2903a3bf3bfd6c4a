"""Knocks that nobody made, each with a sound and a drawing of the object, so that the example can be heard and seen."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from uuid import NAMESPACE_URL, uuid5

import numpy as np

from palpate.network.model import KnownObject, Network
from palpate.server.simulated import DATASET, OWNER
from palpate.server.simulated_drawings import DRAWING, drawing, kind_of
from palpate.store.records import Channel, Device, FileItem, Recording, Series, Setup, ThingRef

__all__ = ["knocks"]

NOTICES = (
    "simulated by a program from three tones that die away, with noise: nothing was knocked on",
    "the picture is drawn by a program from category and material: it is no photograph",
)
FIRST = datetime(2025, 1, 20, 9, tzinfo=UTC)
RATE_HZ, LENGTH_S, BEFORE_S = 16_000.0, 0.8, 0.1
NOISE_PA, LOUDNESS_PA = 0.002, 0.4
OVERTONES = ((1.0, 1.0), (2.76, 0.5), (5.40, 0.25))
"""Of a bar that is free at both ends: times of the lowest tone, and share of its loudness."""


@dataclass(frozen=True)
class Ringing:
    """How something rings when it is knocked on: its lowest tone, and after how long a third of it is left."""

    tone_hz: float
    decay_s: float


MATERIALS = {
    "ceramic": Ringing(1250.0, 0.07),
    "foam": Ringing(140.0, 0.006),
    "glass": Ringing(1400.0, 0.11),
    "hard-plastic": Ringing(620.0, 0.018),
    "metal": Ringing(1050.0, 0.18),
    "paper": Ringing(260.0, 0.008),
    "soft-plastic": Ringing(330.0, 0.012),
    "wood": Ringing(480.0, 0.022),
}


def knocks(network: Network) -> Iterator[Recording]:
    """A knock on one object of each material, the same ones each time."""
    for number, (thing, ringing) in enumerate(_one_of_each(network)):
        recording = Recording(
            id=uuid5(NAMESPACE_URL, f"palpate-example-knock:{number}"),
            recorded_at=FIRST + timedelta(minutes=5 * number),
            action="knocking",
            thing=ThingRef(DATASET, thing.name, common_name=thing.name.replace("_", " ")),
            setup=Setup(microphone=Device("microphone", "simulated microphone", "nobody: it is simulated")),
            owner=OWNER,
            licence="CC0-1.0",
            visibility="public",
            software="palpate.server.example",
            series=(Series("knock", (_sound(ringing, number),)),),
            files=(FileItem(DRAWING, "image/png", drawing(*kind_of(thing))),),
            notices=NOTICES,
        )
        yield recording


def _one_of_each(network: Network) -> Iterator[tuple[KnownObject, Ringing]]:
    """The first object of each material."""
    left = dict(MATERIALS)
    for thing in network.objects.values():
        material = thing.truth.get("material")
        ringing = None if material is None else left.pop(str(material.value), None)
        if ringing is not None:
            yield thing, ringing


def _sound(ringing: Ringing, seed: int) -> Channel:
    rng = np.random.default_rng(seed)
    time_s = np.arange(round(LENGTH_S * RATE_HZ)) / RATE_HZ - BEFORE_S
    since_s = np.maximum(0.0, time_s)
    # higher tones die away sooner
    tones = sum(
        share * np.exp(-since_s * times / ringing.decay_s) * np.sin(2 * np.pi * ringing.tone_hz * times * since_s)
        for times, share in OVERTONES
    )
    pressure = LOUDNESS_PA * np.where(time_s >= 0, tones, 0.0) + rng.normal(0.0, NOISE_PA, time_s.size)
    return Channel("sound", "sound pressure", "Pa", np.asarray(pressure, np.float32), rate_hz=RATE_HZ)
