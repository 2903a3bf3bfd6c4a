"""`palpate explore --record`: the exploration goes into a store, with a recording of each action."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from palpate.cli.storing import check_installed
from palpate.network.digest import digest
from palpate.robots.protocol import Robot

if TYPE_CHECKING:
    from palpate.cli.asked import Asked
    from palpate.cli.preparing import Ready
    from palpate.cli.store_options import Place
    from palpate.episode.keeping import KeptEpisode
    from palpate.store.records import Setup

__all__ = ["Kept", "keeping"]


@dataclass(frozen=True)
class Kept:
    """The robot that explores, and the episode it is kept in; None where it is not."""

    robot: Robot
    episode: KeptEpisode | None = None
    place: str = ""

    @property
    def told(self) -> str:
        """Where it is kept, for people to read."""
        return f"kept as episode {self.episode.id} in {self.place}" if self.episode is not None else ""


@contextmanager
def keeping(asked: Asked, place: Place, ready: Ready) -> Iterator[Kept]:
    """Keep an exploration in the store of the options while the block runs, where that was asked for.

    What could not be sent to the store is told on standard error in the end.
    """
    if not asked.record:
        yield Kept(ready.robot)
        return
    check_installed()
    from palpate.episode.keeping import KeptEpisode
    from palpate.robots.recorded import RecordedRobot
    from palpate.store.records import ThingRef

    network = ready.prior.network
    with place.opened(make=True) as store:
        # what was drawn or replayed must not be taken for a measurement of the object
        dataset, notice = ("replayed", "replayed from") if asked.replay else ("simulated", "drawn from")
        robot = RecordedRobot(
            ready.robot,
            network,
            store,
            thing=ThingRef(dataset, ready.about.object or "unnamed"),
            setup=_setup(asked, ready),
            notices=[f"{notice} {ready.source}, not measured"],
        )
        try:
            yield Kept(robot, KeptEpisode(store, robot, ready.prior, ready.about), repr(store.engine.url))
        finally:
            for trouble in robot.troubles:
                print(f"palpate: {trouble}", file=sys.stderr)


def _setup(asked: Asked, ready: Ready) -> Setup:
    """The robot as a device, so that nobody takes it for one that measures."""
    from palpate.store.records import Device, Setup

    network = ready.prior.network
    told = {"source": ready.source} if asked.replay else {"network": network.name, "digest": digest(network)}
    return Setup(other=(Device("other", f"{ready.about.robot} robot", maker="palpate", parameters=told),))
