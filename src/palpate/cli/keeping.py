"""`palpate explore --record`: the exploration goes into a store, with a recording of each action."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from palpate.cli.asked import Asked, RobotKind
from palpate.cli.storing import check_installed
from palpate.network.digest import digest
from palpate.robots.protocol import Robot

if TYPE_CHECKING:
    from palpate.cli.preparing import Ready
    from palpate.cli.store_options import Place
    from palpate.episode.keeping import KeptEpisode
    from palpate.recording import About
    from palpate.store.records import Setup, ThingRef
    from palpate.store.store import Store

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

    origin = _origin(asked, ready)
    with place.opened(make=True) as store:
        thing = _known_thing(store, origin, ready)
        robot = RecordedRobot(
            ready.robot,
            ready.prior.network,
            store,
            thing=thing,
            setup=origin.setup,
            about=origin.about,
            notices=[origin.notice],
        )
        try:
            yield Kept(robot, KeptEpisode(store, robot, ready.prior, ready.about), repr(store.engine.url))
        finally:
            for trouble in robot.troubles:
                print(f"palpate: {trouble}", file=sys.stderr)


@dataclass(frozen=True)
class _Origin:
    """Where outcomes come from, so that nobody takes them for measurements of the real object."""

    dataset: str
    notice: str
    setup: Setup
    about: About | None = None
    is_simulated: bool = True


def _known_thing(store: Store, origin: _Origin, ready: Ready) -> ThingRef:
    """The object, of which the store knows what is true where it is simulated."""
    from palpate.cli.knowing import who_of
    from palpate.robots.simulated_truth import simulated_thing, tell_truth
    from palpate.store.records import ThingRef

    if ready.known is None or not origin.is_simulated:
        return ThingRef(origin.dataset, ready.about.object or "unnamed")
    thing = simulated_thing(origin.dataset, ready.known)
    tell_truth(store, thing, ready.known, ready.prior.network, who=who_of(None))
    return thing


def _origin(asked: Asked, ready: Ready) -> _Origin:
    if asked.robot is RobotKind.MUJOCO:
        return _bench_origin(ready)
    from palpate.store.records import Device, Setup

    network, replays = ready.prior.network, asked.replay
    told = {"source": ready.source} if replays else {"network": network.name, "digest": digest(network)}
    device = Device("other", f"{ready.about.robot} robot", maker="palpate", parameters=told)
    dataset, verb = ("replayed", "replayed from") if replays else ("simulated", "drawn from")
    notice = f"{verb} {ready.source}, not measured"
    return _Origin(dataset, notice, Setup(other=(device,)), is_simulated=not replays)


def _bench_origin(ready: Ready) -> _Origin:
    """The bench, which from now on keeps its signals in the recordings."""
    from palpate.recording import About
    from palpate.robots.mujoco.recording import bench_setup, engine, keep_in_recording
    from palpate.robots.mujoco.robot import MujocoRobot

    assert isinstance(ready.robot, MujocoRobot)
    bench = ready.robot.bench
    ready.robot.listeners.append(lambda action, signals, outcome: keep_in_recording(bench, signals))
    about = About(software=f"{About().software}, {engine()}")
    notice = f"simulated on {ready.source} with seed {ready.about.seed}, not measured"
    return _Origin("simulated-bench", notice, bench_setup(bench), about)
