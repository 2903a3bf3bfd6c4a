"""Which tasks a reproduction is made of, and what its results depend on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from palpate import __version__
from palpate.errors import EvidenceError, choices, near
from palpate.experiments.engines import Engine, MessagePassing
from palpate.experiments.published import published_tapes
from palpate.experiments.reproduction.episodes import Goal
from palpate.experiments.reproduction.paper import paper
from palpate.experiments.reproduction.tasks import StartTask, TapeTask
from palpate.experiments.shared import SharedNetwork
from palpate.experiments.tapes import Tape, draw_tapes
from palpate.inference.message_passing.settings import Settings
from palpate.network.digest import digest
from palpate.network.model import Network

__all__ = ["Plan", "plan"]


@dataclass(frozen=True)
class Plan:
    """The tasks of a reproduction.

    Parameters
    ----------
    settings
        All that the results depend on, as JSON.
    problems
        What is wrong with the recordings, file by file.
    """

    tasks: tuple[TapeTask | StartTask, ...]
    settings: dict[str, object]
    problems: tuple[str, ...] = field(default=())


def plan(
    networks: Sequence[Network],
    engines: Sequence[Engine],
    *,
    seed: int,
    repetitions: int | None = None,
    objects: Sequence[str] = (),
    objectives: Sequence[str] = (),
    data: Path | None = None,
) -> Plan:
    """Plan the paper's experiment, or a part of it.

    Parameters
    ----------
    networks
        Tapes are drawn from each and believed by the same; the first is the main one.
    repetitions, objects, objectives
        The paper's number of repetitions, all objects and all of the paper's objectives unless given.
    data
        Folder of recordings, see `palpate.experiments.published`; tapes are drawn where it is None.

    Raises
    ------
    PalpateError
        An unknown object or objective, or a folder without recordings.
    """
    known = paper()
    goals = tuple(
        Goal(name, known.objectives[name]) for name in _known("objective", objectives, list(known.objectives))
    )
    times = known.repetitions if repetitions is None else repetitions
    tasks: list[TapeTask] = []
    starts: list[StartTask] = []
    problems: dict[str, None] = {}
    for network in networks:
        tapes, wrong = _tapes(network, objects, times, seed, data)
        problems |= dict.fromkeys(wrong)
        shared = SharedNetwork(network)
        tasks += [TapeTask(shared, tape, engine, goals, known.cases, seed) for engine in engines for tape in tapes]
        starts += [StartTask(shared, engine, goals, seed) for engine in _only_begun(engines)]
    settings: dict[str, object] = {
        "palpate": __version__,
        "seed": seed,
        "networks": {network.name: digest(network) for network in networks},
        "engines": [engine.name for engine in engines],
        "objectives": [goal.name for goal in goals],
        "objects": list(dict.fromkeys(task.tape.object for task in tasks)),
        "repetitions": times,
        "recordings": None if data is None else str(data),
        "problems": list(problems),
    }
    return Plan((*tasks, *starts), settings, tuple(problems))


def _only_begun(engines: Sequence[Engine]) -> list[Engine]:
    """The engines whose gains before any action are told though they are not run: the paper's equations."""
    written = MessagePassing(Settings.as_written())
    passing = any(isinstance(engine, MessagePassing) for engine in engines)
    return [written] if passing and written not in engines else []


def _tapes(
    network: Network, objects: Sequence[str], repetitions: int, seed: int, data: Path | None
) -> tuple[list[Tape], tuple[str, ...]]:
    if data is None:
        return draw_tapes(network, _known("object", objects, list(network.objects)), repetitions, seed), ()
    tapes, problems = published_tapes(data, network, repetitions, seed)
    names = _known("object", objects, list(dict.fromkeys(tape.object for tape in tapes)))
    return [tape for tape in tapes if tape.object in names], problems


def _known(what: str, wanted: Sequence[str], valid: list[str]) -> list[str]:
    """The names wanted, all where none is; EvidenceError for one that is not valid."""
    for name in wanted:
        if name not in valid:
            raise EvidenceError(f"unknown {what} {name!r}{near(name, valid)}: {choices(valid)}")
    return [name for name in valid if name in wanted] if wanted else valid
