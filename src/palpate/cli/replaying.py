"""What is replayed: a shipped session, a file, an episode of a store, or all that a store has of an object."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from palpate.cli.storing import check_installed, opened
from palpate.episode import read_episode
from palpate.errors import PalpateError
from palpate.logfile import EPISODE_FORMAT, SESSION_FORMAT, read_lines
from palpate.network.model import Network
from palpate.robots.replay import ReplayRobot
from palpate.robots.session import read_session, shipped_session

__all__ = ["Replayed", "is_in_store", "replayed"]

STORE, IN_STORE = "store", "store:"


@dataclass(frozen=True)
class Replayed:
    """The robot that replays, the object its outcomes are of, where they are from, and what was decided about them."""

    robot: ReplayRobot
    thing: str | None
    source: str
    notes: tuple[str, ...] = ()


def replayed(
    session: str | None, thing: str | None, network: Network, place: str | None, blobs: str | None
) -> Replayed:
    """What ``--session`` asks for, of the object that was named.

    Parameters
    ----------
    session
        ``store``, ``store:EPISODE``, a file, or None for the session that ships.
    place, blobs
        ``--store`` and ``--blobs``.
    """
    if session is not None and session.startswith(IN_STORE):
        found = _episode_of_store(session.removeprefix(IN_STORE), place, blobs)
    elif session is not None and session != STORE:
        found = _from_file(Path(session))
    elif thing is None:
        raise PalpateError("no OBJECT was found, expected the object whose session is replayed, or --session FILE")
    elif session == STORE:
        return _object_of_store(thing, network, place, blobs)
    else:
        shipped = shipped_session(thing)
        return Replayed(ReplayRobot(shipped.recorded), shipped.object, shipped.source, shipped.all_decisions)
    if thing not in (None, found.thing):
        raise PalpateError(f"{session} is of the object {found.thing!r}, expected one of {thing!r}")
    return found


def is_in_store(session: str) -> bool:
    """Whether ``--session`` asks for something in a store."""
    return session == STORE or session.startswith(IN_STORE)


def _from_file(path: Path) -> Replayed:
    header = read_lines(path, SESSION_FORMAT, EPISODE_FORMAT)[0]
    if header.record["format"] == EPISODE_FORMAT:
        return Replayed(ReplayRobot.read(path), read_episode(path).about.object, str(path))
    session = read_session(path)
    return Replayed(ReplayRobot.read(path), session.object, session.source, session.all_decisions)


def _episode_of_store(key: str, place: str | None, blobs: str | None) -> Replayed:
    check_installed()
    from palpate.episode.keeping import read_stored_episode
    from palpate.store.keys import episode_id

    with opened(place, blobs) as store:
        found = episode_id(store, key)
        episode = read_stored_episode(store, found)
    return Replayed(ReplayRobot(episode.recorded), episode.about.object, f"episode {found}")


def _object_of_store(thing: str, network: Network, place: str | None, blobs: str | None) -> Replayed:
    check_installed()
    from palpate.robots.stored import stored_session

    with opened(place, blobs) as store:
        session = stored_session(store, thing, network)
    return Replayed(ReplayRobot(session.recorded), session.object, session.source, session.all_decisions)
