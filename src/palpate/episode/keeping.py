"""Keeping an exploration in a store, with a recording of each action, while it runs."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Any
from uuid import UUID

from palpate.episode.format import About, Episode, episode_of, header_record, step_record
from palpate.explore import Step
from palpate.inference.belief import Belief
from palpate.logfile import Line
from palpate.network.model import Network
from palpate.robots.recorded import RecordedRobot
from palpate.store.checks import check_unit
from palpate.store.content import in_utc
from palpate.store.episodes import StoredEpisode
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.quantities import check_quantity
from palpate.store.store import Store
from palpate.store.units import units_of

__all__ = ["KeptEpisode", "begun_episode", "check_units", "read_stored_episode", "stored_record"]


class KeptEpisode:
    """An episode in a store that grows by a step at a time.

    Whatever ends the exploration early, the store has the steps until then, and the recording of each action.

    Parameters
    ----------
    store
        Where it is kept.
    robot
        The robot that explores, and records each action into the same store.
    belief
        The belief at the start.
    about
        How the exploration is set up.

    Raises
    ------
    StoreError
        If the store has a property in a unit of another dimension than the network, or cannot be written.

    Examples
    --------
    ::

        robot = RecordedRobot(own_robot, network, store, thing=ThingRef("our lab", "sponge 3"))
        kept = KeptEpisode(store, robot, belief)
        for step in explore(belief, robot):
            kept.write(step)
    """

    def __init__(self, store: Store, robot: RecordedRobot, belief: Belief, about: About | None = None) -> None:
        check_units(store, belief.network)
        self._store = store
        self._robot = robot
        self.stored = begun_episode(robot, belief, about)
        put_episode(store, self.stored)

    @property
    def id(self) -> UUID:
        """Under which id the store has it."""
        return self.stored.id

    def write(self, step: Step) -> None:
        """Add a step; StoreError if the store cannot be written any more."""
        self.stored = self.stored.continued(stored_record(step), self._robot.end_step())
        put_episode(self._store, self.stored)


def begun_episode(robot: RecordedRobot, belief: Belief, about: About | None = None) -> StoredEpisode:
    """An exploration that begins now, without a step, seen by whom the robot's recordings are."""
    return StoredEpisode(
        datetime.now(UTC),
        robot.thing,
        header_record(belief, about or About()),
        owner=robot.about.owner,
        visibility=robot.about.visibility,
    )


def stored_record(step: Step) -> dict[str, Any]:
    """The line of a step as a store has it: with the time when it was done, so that who watches knows how old it is."""
    return {**step_record(step), "done_at": in_utc(datetime.now(UTC))}


def read_stored_episode(store: Store, key: UUID | str) -> Episode:
    """An episode of a store, by its id or its digest, as `palpate.read_episode` reads one from a log.

    Raises
    ------
    StoreError, LogError
        If there is none, or it is incomplete.
    """
    stored = get_episode(store, key)
    return episode_of([Line(f"episode {stored.id} line {n}", record) for n, record in enumerate(stored.records, 1)])


def check_units(store: Store, network: Network) -> None:
    """Refuse a network whose units the store would refuse, before anything is measured."""
    known = units_of(store)
    for prop in network.properties.values():
        unit = getattr(prop, "unit", None)
        if unit is None:
            continue
        where = f"property {prop.name!r} of the network {network.name!r}"
        check_unit(where, unit, known.get(prop.name))
        check_quantity(where, unit, prop.name)
