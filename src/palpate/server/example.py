"""Example data, so that there is something to look at: a recorded session, an exploration, and simulated recordings.

What is simulated is in a data set of its own, and each recording says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from tempfile import TemporaryDirectory

import numpy as np

from palpate.episode.format import About
from palpate.episode.keeping import KeptEpisode
from palpate.explore import explore
from palpate.inference.exact import ExactBelief
from palpate.network.model import Network
from palpate.network.reading import load_network
from palpate.recording.measuring import About as AboutRecordings
from palpate.recording.spool import Spool
from palpate.robots.recorded import RecordedRobot
from palpate.robots.sampled import SampledRobot
from palpate.robots.simulated_truth import LOOKS_LIKE
from palpate.server.simulated import DATASET, OWNER, simulated, true_value
from palpate.server.simulated_drawings import DRAWING, drawing, kind_of
from palpate.server.simulated_knocks import knocks
from palpate.store.describing import change_thing, keep_image
from palpate.store.entries import Distribution, Entry, Value
from palpate.store.filters import Filter
from palpate.store.importing.own_formats import EXAMPLE
from palpate.store.listing_episodes import list_episodes
from palpate.store.matching import ids_matching
from palpate.store.reading_archive import archive_rows
from palpate.store.records import Device, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.things import Image, Thing, list_things

__all__ = ["add_example"]

COUNT = 2_000
AT_ONCE = 200
EXPLORED = "banana_ycb"
"""It looks like a fruit and is plastic: what a camera sees does not fit what was weighed."""
SEED = 12
UNITS = {"elasticity": "kPa", "mass": "g"}


def add_example(store: Store, *, count: int = COUNT) -> None:
    """Add the example data; what is there of it stays, so that it may be done again.

    Parameters
    ----------
    count
        Of simulated recordings.
    """
    network = load_network("household-filled")
    store.put_many(replace(row.read(), visibility="public") for row in archive_rows(EXAMPLE))
    # to make them again takes longer than to see that they are there
    recordings = iter(()) if _count(store) >= count else simulated(network, count)
    while batch := list(islice(recordings, AT_ONCE)):
        store.put_many(batch)
    store.put_many(list(knocks(network)))
    _tell_truths(store, network)
    if not list_episodes(store, thing=f"{DATASET}/{EXPLORED}", limit=1).rows:
        _explore(store, network)


def _count(store: Store) -> int:
    """How many recordings there are of the simulation."""
    return len(ids_matching(store, Filter(dataset=DATASET, owner=OWNER)))


def _explore(store: Store, network: Network) -> None:
    """Explore a trick object with outcomes drawn from the network."""
    belief, drawn = ExactBelief(network), SampledRobot(network, EXPLORED, np.random.default_rng(SEED))
    setup = Setup(other=(Device("other", "sampled robot", maker="palpate", parameters={"network": network.name}),))
    with TemporaryDirectory() as folder:
        robot = RecordedRobot(
            drawn,
            network,
            store,
            thing=ThingRef(DATASET, EXPLORED),
            setup=setup,
            about=AboutRecordings(owner=OWNER, licence="CC0-1.0", visibility="public"),
            spool=Spool(folder, sync=False),
            notices=["simulated: drawn from the network, not measured"],
        )
        about = About("everything", "greedy", "gain:0.05", "sampled", EXPLORED, SEED, costs_s=_costs_s(network))
        kept = KeptEpisode(store, robot, belief, about)
        for step in explore(belief, robot):
            kept.write(step)


def _costs_s(network: Network) -> dict[str, float]:
    return {name: action.cost_s for name, action in network.actions.items()}


def _tell_truths(store: Store, network: Network) -> None:
    """Say what the simulation began with, which is what everything is compared to, and draw each object."""
    there = {thing.ref.id: thing for thing in list_things(store) if thing.ref.dataset == DATASET}
    for known in network.objects.values():
        if known.name in there:
            values = {name: true_value(known, name) for name in (*UNITS, "category", "material")}
            entries = list(_entries(values))
            image = keep_image(store, DRAWING, "image/png", drawing(*kind_of(known)))
            change_thing(store, there[known.name].ref, partial(_told, entries, known.looks_like, image), who=OWNER)


def _entries(values: dict[str, float | str | None]) -> Iterator[Entry]:
    for name, value in values.items():
        if isinstance(value, float):
            yield Value(name, value, unit=UNITS[name])
        elif isinstance(value, str):
            yield Distribution(name, {value: 1.0})


def _told(entries: Sequence[Entry], looks_like: str | None, image: Image, thing: Thing) -> Thing:
    if looks_like is not None:
        thing = thing.described(attributes={**thing.ref.attributes, LOOKS_LIKE: looks_like})
    for entry in entries:
        thing = thing.knowing(entry, "what the simulation began with")
    return thing.showing(image)
