"""`palpate explore --record` and `--live`: the exploration is kept, with a recording of each action."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol
from uuid import UUID

from palpate.cli.asked import Asked, RobotKind
from palpate.cli.storing import check_installed
from palpate.explore import Step
from palpate.network.digest import digest
from palpate.robots.protocol import Robot

if TYPE_CHECKING:
    from palpate.cli.preparing import Ready
    from palpate.cli.store_options import Place
    from palpate.recording import About
    from palpate.robots.recorded import RecordedRobot
    from palpate.store.records import Setup, ThingRef
    from palpate.store.store import Store

__all__ = ["Kept", "keeping"]


class Growing(Protocol):
    """An episode that is kept, step by step."""

    @property
    def id(self) -> UUID:
        """Its id."""

    def write(self, step: Step) -> None:
        """Keep a step."""


@dataclass(frozen=True)
class Kept:
    """The robot that explores, the episode it is kept in, and where, for people to read; None where it is not."""

    robot: Robot
    episode: Growing | None = None
    told: str = ""


@contextmanager
def keeping(asked: Asked, place: Place, ready: Ready) -> Iterator[Kept]:
    """Keep an exploration as the options say while the block runs.

    What could not be sent is told on standard error in the end.
    """
    if asked.to is not None:
        with _posted(asked.to, asked, ready) as kept:
            yield kept
    elif asked.keeps:
        with _stored(asked, place, ready) as kept:
            yield kept
    else:
        yield Kept(ready.robot)


@contextmanager
def _stored(asked: Asked, place: Place, ready: Ready) -> Iterator[Kept]:
    """In a store here, with a page to watch it where that was asked for."""
    check_installed()
    from palpate.cli.live import showing
    from palpate.episode.keeping import KeptEpisode

    with place.opened(make=True) as store, showing(asked, place) as shown:
        robot = _recorded(asked, ready, store)
        episode = KeptEpisode(store, robot, ready.prior, ready.about)
        told = f"kept as episode {episode.id} in {store.engine.url!r}"
        try:
            yield Kept(robot, episode, f"{told}\nwatch it at {shown(episode.id)}" if asked.live else told)
        finally:
            for trouble in robot.troubles:
                print(f"palpate: {trouble}", file=sys.stderr)


@contextmanager
def _posted(url: str, asked: Asked, ready: Ready) -> Iterator[Kept]:
    """On a server elsewhere, for which nobody waits."""
    check_installed()
    from palpate.cli.live import LIVE_TIMEOUT_S, begun, tell_left, told_once
    from palpate.client import Client
    from palpate.episode.posting import PostedEpisode

    client = Client(url, timeout_s=LIVE_TIMEOUT_S)
    robot = _recorded(asked, ready, None)
    with told_once():
        episode = PostedEpisode(client, robot, ready.prior, ready.about)
        try:
            yield Kept(robot, episode, begun(episode, client.url, robot.spool))
        finally:
            tell_left(episode.close(), client.url, robot.spool)


def _recorded(asked: Asked, ready: Ready, store: Store | None) -> RecordedRobot:
    """The robot, each action of which is recorded: into a store that is here, or else to be sent."""
    from palpate.robots.recorded import RecordedRobot

    origin = _origin(asked, ready)
    return RecordedRobot(
        ready.robot,
        ready.prior.network,
        store,
        thing=_known_thing(store, origin, ready),
        setup=origin.setup,
        about=origin.about,
        notices=[origin.notice],
    )


@dataclass(frozen=True)
class _Origin:
    """Where outcomes come from, so that nobody takes them for measurements of the real object."""

    dataset: str
    notice: str
    setup: Setup
    about: About | None = None
    is_simulated: bool = True


def _known_thing(store: Store | None, origin: _Origin, ready: Ready) -> ThingRef:
    """The object, of which a store that is here knows what is true where it is simulated."""
    from palpate.cli.knowing import who_of
    from palpate.robots.simulated_truth import simulated_thing, tell_truth
    from palpate.store.records import ThingRef

    if ready.known is None or not origin.is_simulated:
        return ThingRef(origin.dataset, ready.about.object or "unnamed")
    thing = simulated_thing(origin.dataset, ready.known)
    if store is not None:
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
