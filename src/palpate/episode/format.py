"""The form of an episode: the records of its log, and what they say.

The first line tells what was explored and how, with the belief at the start; then comes a line
for each step as soon as it is done, and a last one with the reason why exploration stopped. A log
without the last line is of an exploration that was interrupted, and can be read all the same.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from palpate import __version__
from palpate.errors import EvidenceError, LogError
from palpate.evidence import format_item, parse_item, spell_out
from palpate.explore import Step
from palpate.inference.belief import Belief
from palpate.logfile import EPISODE_FORMAT, Line, finite
from palpate.network.digest import digest
from palpate.outcomes import Outcome
from palpate.summary import BeliefSummary, summarise, summary_from_json

__all__ = ["About", "Episode", "LoggedStep", "episode_of", "header_record", "step_record"]

NUMBER = (int, float)
NUMBER_OR_NULL = (int, float, type(None))


@dataclass(frozen=True)
class About:
    """How an exploration was set up: what the loop itself cannot tell.

    Parameters
    ----------
    objective, policy, stopping
        As people read them.
    costs_s
        Cost of every action [s].
    engine
        What worked out the beliefs, with its preset where it has some.
    """

    objective: str = ""
    policy: str = ""
    stopping: str = ""
    robot: str = ""
    object: str | None = None
    seed: int | None = None
    repeat: bool = False
    costs_s: Mapping[str, float] = field(default_factory=dict)
    engine: str = "exact"


@dataclass(frozen=True, eq=False)
class LoggedStep:
    """A step of an episode, without the engine that made it; see `palpate.explore.Step`."""

    index: int
    gains_bits: Mapping[str, float]
    action: str
    outcome: Outcome
    admitted: Outcome
    notices: tuple[str, ...]
    cost_s: float
    total_cost_s: float
    expected_gain_bits: float
    realised_gain_bits: float | None
    entropy_drop_bits: float | None
    surprise: float | None
    before: BeliefSummary
    after: BeliefSummary


@dataclass(frozen=True, eq=False)
class Episode:
    """An exploration that is over.

    Parameters
    ----------
    network, digest
        Name of the network, and the digest of its model.
    prior
        The belief at the start.
    stop
        Why it stopped; None where it was interrupted.
    gains_left_bits
        Expected gain, at the end, of the actions that could still have been taken.
    """

    about: About
    network: str
    digest: str
    version: str
    prior: BeliefSummary
    steps: tuple[LoggedStep, ...]
    stop: str | None
    gains_left_bits: Mapping[str, float]

    @property
    def recorded(self) -> tuple[tuple[str, Outcome], ...]:
        """Actions and outcomes in order: what a replay needs."""
        return tuple((step.action, step.outcome) for step in self.steps)

    @property
    def posterior(self) -> BeliefSummary:
        """The belief at the end."""
        return self.steps[-1].after if self.steps else self.prior


def header_record(belief: Belief, about: About) -> dict[str, Any]:
    """The first line: how an object is explored, and the belief at the start."""
    network = {"name": belief.network.name, "digest": digest(belief.network)}
    setup = {"palpate": __version__, "network": network, **asdict(about)}
    record: dict[str, Any] = finite({"format": EPISODE_FORMAT, **setup, "belief": _as_json(summarise(belief))})
    return record


def step_record(step: Step) -> dict[str, Any]:
    """The line of a step; the last one says why exploration stopped."""
    if step.action is None:
        end: dict[str, Any] = {"stop": step.stop, "total_cost_s": step.total_cost_s, "gains_bits": step.gains_bits}
        return dict(finite(end))
    assert step.outcome is not None
    assert step.admitted is not None
    admitted = spell_out(step.before.network, step.action, step.admitted)
    taken: dict[str, Any] = {
        "step": step.index,
        "action": step.action,
        "outcome": format_item(step.action, step.outcome),
        "admitted": format_item(step.action, admitted),
        "notices": list(step.notices),
        "cost_s": step.cost_s,
        "total_cost_s": step.total_cost_s,
        "gains_bits": dict(step.gains_bits),
        "expected_gain_bits": step.expected_gain_bits,
        "realised_gain_bits": step.realised_gain_bits,
        "entropy_drop_bits": step.entropy_drop_bits,
        "surprise": step.surprise,
        "belief": _as_json(summarise(step.after)),
    }
    return dict(finite(taken))


def _as_json(summary: BeliefSummary) -> dict[str, Any]:
    return {name: entry.to_json() for name, entry in summary.items()}


def episode_of(lines: Sequence[Line]) -> Episode:
    """The episode that the lines of a log tell; LogError names the line that is incomplete."""
    header, *rest = lines
    prior = summary_from_json(header.where, header.get("belief", dict))
    ends = [place for place, line in enumerate(rest) if "stop" in line.record]
    if ends and ends[0] != len(rest) - 1:
        raise LogError(f"{rest[ends[0] + 1].where}: a line was found after the one that says why exploration stopped")
    steps: list[LoggedStep] = []
    for line in rest[: ends[0]] if ends else rest:
        steps.append(_step(line, steps[-1].after if steps else prior, len(steps) + 1))
    network = Line(f"{header.where}: 'network'", header.get("network", dict))
    return Episode(
        about=_about(header),
        network=network.get("name", str),
        digest=network.get("digest", str),
        version=header.get("palpate", str),
        prior=prior,
        steps=tuple(steps),
        stop=rest[-1].get("stop", str) if ends else None,
        gains_left_bits=rest[-1].get("gains_bits", dict) if ends else {},
    )


def _about(header: Line) -> About:
    return About(
        objective=header.get("objective", str),
        policy=header.get("policy", str),
        stopping=header.get("stopping", str),
        robot=header.get("robot", str),
        object=header.get("object", (str, type(None))),
        seed=header.get("seed", (int, type(None))),
        repeat=header.get("repeat", bool),
        costs_s=header.get("costs_s", dict),
        engine=header.get("engine", str),
    )


def _step(line: Line, before: BeliefSummary, number: int) -> LoggedStep:
    if line.get("step", int) != number:
        raise LogError(f"{line.where}: step {line.record['step']} was found, expected step {number}")
    return LoggedStep(
        index=number,
        gains_bits=line.get("gains_bits", dict),
        action=line.get("action", str),
        outcome=_outcome(line, "outcome"),
        admitted=_outcome(line, "admitted"),
        notices=tuple(line.get("notices", list)),
        cost_s=line.get("cost_s", NUMBER),
        total_cost_s=line.get("total_cost_s", NUMBER),
        expected_gain_bits=line.get("expected_gain_bits", NUMBER),
        realised_gain_bits=line.get("realised_gain_bits", NUMBER_OR_NULL),
        entropy_drop_bits=line.get("entropy_drop_bits", NUMBER_OR_NULL),
        surprise=line.get("surprise", NUMBER_OR_NULL),
        before=before,
        after=summary_from_json(line.where, line.get("belief", dict)),
    )


def _outcome(line: Line, key: str) -> Outcome:
    try:
        return parse_item(line.get(key, dict))[1]
    except EvidenceError as error:
        raise LogError(f"{line.where}: {key!r}: {error}") from error
