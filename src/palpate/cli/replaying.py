"""What is replayed: a shipped session, a file, an episode of a store, or all that a store has of an object."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path

from palpate.cli.store_options import Place
from palpate.cli.storing import check_installed
from palpate.episode import read_episode
from palpate.errors import PalpateError
from palpate.logfile import EPISODE_FORMAT, SESSION_FORMAT, read_lines
from palpate.network.model import Network
from palpate.robots.protocol import Robot
from palpate.robots.replay import ReplayRobot
from palpate.robots.session import read_session, shipped_session

__all__ = ["Source", "is_in_store", "replayed"]

STORE, IN_STORE = "store", "store:"


@dataclass(frozen=True)
class Source:
    """A robot, the object that its outcomes are of, where they are from, and what was decided about them.

    It is used inside of `using`, which lets go of what the robot holds.
    """

    robot: Robot
    thing: str | None
    source: str
    notes: tuple[str, ...] = ()
    using: AbstractContextManager[object] = field(default_factory=nullcontext)


def replayed(session: str | None, thing: str | None, network: Network, place: Place) -> Source:
    """What ``--session`` asks for, of the object that was named.

    Parameters
    ----------
    session
        ``store``, ``store:EPISODE``, a file, or None for the session that ships.
    place
        Where the store is.
    """
    if session is not None and session.startswith(IN_STORE):
        found = _episode_of_store(session.removeprefix(IN_STORE), place)
    elif session is not None and session != STORE:
        found = _from_file(Path(session))
    elif thing is None:
        raise PalpateError("no OBJECT was found, expected the object whose session is replayed, or --session FILE")
    elif session == STORE:
        return _object_of_store(thing, network, place)
    else:
        shipped = shipped_session(thing)
        return Source(ReplayRobot(shipped.recorded), shipped.object, shipped.source, shipped.all_decisions)
    if thing not in (None, found.thing):
        raise PalpateError(f"{session} is of the object {found.thing!r}, expected one of {thing!r}")
    return found


def is_in_store(session: str) -> bool:
    """Whether ``--session`` asks for something in a store."""
    return session == STORE or session.startswith(IN_STORE)


def _from_file(path: Path) -> Source:
    header = read_lines(path, SESSION_FORMAT, EPISODE_FORMAT)[0]
    if header.record["format"] == EPISODE_FORMAT:
        return Source(ReplayRobot.read(path), read_episode(path).about.object, str(path))
    session = read_session(path)
    return Source(ReplayRobot.read(path), session.object, session.source, session.all_decisions)


def _episode_of_store(key: str, place: Place) -> Source:
    check_installed()
    from palpate.episode.keeping import read_stored_episode
    from palpate.store.keys import episode_id

    with place.opened() as store:
        found = episode_id(store, key)
        episode = read_stored_episode(store, found)
    return Source(ReplayRobot(episode.recorded), episode.about.object, f"episode {found}")


def _object_of_store(thing: str, network: Network, place: Place) -> Source:
    check_installed()
    from palpate.robots.stored import stored_session

    with place.opened() as store:
        session = stored_session(store, thing, network)
    return Source(ReplayRobot(session.recorded), session.object, session.source, session.all_decisions)
