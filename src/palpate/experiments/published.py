"""Tapes from a folder in the layout of the paper's published measurements.

``experiment_<object>/<entry>_<number>/data/measurement.json``, with five numbers from 0 on for each
of the entries mat-vision, mat-sound, cat-vision, density and elasticity. A file holds its entry's
name as `meas_prop`; a classifier's probabilities by label in `values`, or in `values.prediction`;
of a weighing a list of grams in `values`, or in `values.arm.joint4_torque`; of a squeeze its mean
stiffness as `params.mean`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from palpate.errors import PalpateError, choices, near
from palpate.experiments.tapes import Tape, stable_int
from palpate.network.model import Action, Network
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Outcome, Posterior, Reading
from palpate.store.importing.upload_format import AS_PUBLISHED

__all__ = ["MEASUREMENTS", "published_tapes"]

MEASUREMENTS = 5
"""Measurements of each action and object."""

PREFIX = "experiment_"


def published_tapes(
    folder: str | Path, network: Network, repetitions: int, seed: int
) -> tuple[list[Tape], tuple[str, ...]]:
    """Tapes of the objects in a folder, and what is wrong with it, file by file.

    Repetition r takes the r-th of each action's measurements in an order shuffled for it; actions
    whose file is missing or broken cannot be taken in that repetition. Objects that the network does
    not know have no truth to be compared with.

    Parameters
    ----------
    repetitions
        Tapes of each object, at most `MEASUREMENTS`.

    Returns
    -------
    tapes, problems
        Object by object; a sentence for each problem.

    Raises
    ------
    PalpateError
        There is no such folder, it holds no experiment, or more repetitions are asked for than there
        are measurements.
    """
    if repetitions > MEASUREMENTS:
        raise PalpateError(
            f"{repetitions} repetitions were asked for, expected at most {MEASUREMENTS}: there are no more measurements"
        )
    inside = sorted(path for path in Path(folder).glob(f"{PREFIX}*") if path.is_dir())
    if not inside:
        raise PalpateError(f"{folder}: no folder {PREFIX}<object> was found, expected one for each object")
    problems: list[str] = []
    tapes = [tape for path in inside for tape in _tapes(path, network, repetitions, seed, problems)]
    return tapes, tuple(problems)


def _tapes(path: Path, network: Network, repetitions: int, seed: int, problems: list[str]) -> list[Tape]:
    """The tapes of an object's folder; what is wrong with it is added to the problems."""
    name = path.name.removeprefix(PREFIX)
    known = network.objects.get(name)
    if known is None:
        hint = near(name, network.objects)
        problems.append(f"{path}: object {name!r}{hint} is not known to network {network.name!r}, and is not scored")
    scored = known.truth.items() if known else ()
    truth = {key: true.value for key, true in scored if true.scored}
    entries = {AS_PUBLISHED.actions.get(entry, entry): entry for entry in _entries(path, network, problems)}
    found = {action: _measurements(path, entries[action], network, problems) for action in entries}
    tapes = []
    for repetition in range(repetitions):
        outcomes = {}
        for action in (a for a in network.actions if a in found):
            seeds = np.random.SeedSequence(seed, spawn_key=(stable_int(name), stable_int(action)))
            outcome = found[action][int(np.random.default_rng(seeds).permutation(MEASUREMENTS)[repetition])]
            if outcome is not None:
                outcomes[action] = outcome
        if outcomes:
            tapes.append(Tape(name, repetition, outcomes, truth, bool(known and known.is_trick)))
    return tapes


def _entries(path: Path, network: Network, problems: list[str]) -> list[str]:
    """The entries that an object should have; folders of others are told as problems."""
    names = {action: action for action in network.actions} | {a: e for e, a in AS_PUBLISHED.actions.items()}
    wanted = [names[action] for action in network.actions]
    for inside in sorted(path.iterdir()):
        entry = inside.name.rpartition("_")[0]
        if entry not in wanted:
            problems.append(f"{inside}: {entry!r}{near(entry, wanted)} is no entry, and is left out; {choices(wanted)}")
    return wanted


def _measurements(path: Path, entry: str, network: Network, problems: list[str]) -> list[Outcome | None]:
    """The outcomes of an entry's measurements; None where there is none."""
    found: list[Outcome | None] = []
    for number in range(MEASUREMENTS):
        file = path / f"{entry}_{number}" / "data" / "measurement.json"
        try:
            found.append(_outcome(file, entry, network.actions[AS_PUBLISHED.actions.get(entry, entry)]))
        except PalpateError as error:
            problems.append(str(error))
            found.append(None)
    return found


def _outcome(file: Path, entry: str, action: Action) -> Outcome:
    """What a file says; PalpateError if it cannot be read."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise PalpateError(f"{file} cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise PalpateError(f"{file}: this is no readable JSON: {error}") from error
    if not isinstance(content, Mapping) or content.get("meas_prop") != entry:
        found = content.get("meas_prop") if isinstance(content, Mapping) else None
        raise PalpateError(f"{file}: meas_prop {found!r} was found, expected {entry!r}")
    if isinstance(action.sensor, ConfusionSensor):
        return Posterior(_split(_probabilities(file, content)))
    if "params" in content:
        return Reading(_number(file, "params.mean", _at(content, "params", "mean")), unit=AS_PUBLISHED.units.get(entry))
    channel, unit = AS_PUBLISHED.from_series[entry]
    samples = _at(content, "values", "arm", channel) or _at(content, "values")
    if not isinstance(samples, Sequence) or isinstance(samples, str) or not samples:
        raise PalpateError(f"{file}: no list of samples was found, expected one as values or as values.arm.{channel}")
    numbers = [_number(file, "a sample", sample) for sample in samples]
    return Reading(math.fsum(numbers) / len(numbers), unit=unit)


def _probabilities(file: Path, content: Mapping[str, Any]) -> dict[str, float]:
    found = _at(content, "values", "prediction") or _at(content, "values")
    if not isinstance(found, Mapping) or not found:
        raise PalpateError(
            f"{file}: no probabilities were found, expected them by label as values or values.prediction"
        )
    return {label: _number(file, f"probability of {label!r}", p) for label, p in found.items()}


def _split(probabilities: Mapping[str, float]) -> dict[str, float]:
    """Share a label that stands for several states evenly among them.

    Examples
    --------
    >>> _split({"plastic": 0.5, "wood": 0.5})
    {'wood': 0.5, 'soft-plastic': 0.25, 'hard-plastic': 0.25}
    """
    found = {label: p for label, p in probabilities.items() if label not in AS_PUBLISHED.groups}
    for label, states in AS_PUBLISHED.groups.items():
        for state in states if label in probabilities else ():
            found[state] = found.get(state, 0.0) + probabilities[label] / len(states)
    return found


def _at(content: Any, *keys: str) -> Any:
    """What stands under the keys; None where nothing does."""
    for key in keys:
        content = content.get(key) if isinstance(content, Mapping) else None
    return content


def _number(file: Path, what: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise PalpateError(f"{file}: {what} {value!r} was found, expected a finite number")
    return float(value)
