"""Compute the oracle's answers to 200 random evidence sets of the household network, once.

Run from the root of the checkout (about fifteen minutes on one core)::

    PYTHONPATH=src:. python -m tests.oracle.make_reference

It writes `household_reference.json.gz` beside this file. Narrowing all the oracle's panels by two
fifths moved its answers to eight of the sets, the sharpest among them, by less than 1e-11
(probabilities), 1e-8 bits (gains, entropies) and 1e-9 SD (means, SDs).
"""

from __future__ import annotations

import gzip
import json
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor
from tests.oracle.brute_force import Oracle
from tests.oracle.networks import household_oracle

FILE = Path(__file__).with_name("household_reference.json.gz")
OBJECTIVES: tuple[str | tuple[str, ...], ...] = (
    *("category", "material", "elasticity", "density", "volume", "mass", "everything"),
    ("category", "material"),
    ("category", "elasticity"),
)
QUANTILES = (0.05, 0.5, 0.95)
CERAMIC, MUG = {"action": "mat-sound", "label": "ceramic"}, {"action": "cat-vision", "label": "mug"}
EXTREMES: tuple[list[dict[str, Any]], ...] = (
    [],
    [{"action": "weighing", "value": 5.0}],
    [{"action": "weighing", "value": 2500.0}],
    [{"action": "weighing", "value": -9.0}],
    [{"action": "weighing", "value": 0.2, "sd": 0.5}],
    [{"action": "weighing", "value": 2500.0, "sd": 0.5}],
    [{"action": "weighing", "value": 2500.0, "sd": 50.0}],
    [{"action": "mat-vision", "label": "ceramic"}, {"action": "squeezing", "value": 0.0}],
    [
        {"action": "mat-sound", "label": "ceramic"},
        {"action": "squeezing", "value": 0.0},
        {"action": "weighing", "value": 5.0},
    ],
    [{"action": "squeezing", "above": 95.0}] * 4,
    [{"action": "squeezing", "above": 95.0}, {"action": "squeezing", "value": 3.0}],
    [{"action": "squeezing", "value": 40.0, "sd": 0.5}, {"action": "squeezing", "above": 95.0}],
    [{"action": "weighing", "value": 66.0}] * 5,
    [{"action": "weighing", "value": 60.0}, {"action": "weighing", "value": 110.0}],
    [{"action": "weighing", "value": 5.0}, {"action": "weighing", "value": 2500.0, "sd": 50.0}],
    [{"action": "mat-sound", "label": "foam"}, {"action": "weighing", "value": 2500.0}],
    [{"action": "cat-vision", "label": "dice"}, {"action": "weighing", "value": 2500.0}],
    [{"action": "mat-vision", "label": "metal"}, {"action": "mat-vision", "label": "foam"}],
    [
        {"action": "cat-vision", "label": "mug"},
        {"action": "cat-vision", "label": "fruit"},
        {"action": "weighing", "value": 66.0},
    ],
    [{"action": "weighing", "above": 800.0}, {"action": "weighing", "below": 900.0}],
    [{"action": "weighing", "below": 1.0, "sd": 0.5}, {"action": "squeezing", "below": 5.0}],
    [{"action": "squeezing", "failed": True}, {"action": "weighing", "value": 118.0}],
)


def _label(rng: np.random.Generator, sensor: ConfusionSensor) -> dict[str, Any]:
    return {"label": str(rng.choice(sensor.outcomes))}


def _vector(rng: np.random.Generator, states: Sequence[str]) -> dict[str, Any]:
    values = rng.dirichlet(np.full(len(states), 0.5))
    if rng.random() < 0.5:
        return {"likelihood": {s: round(float(v), 6) for s, v in zip(states, values, strict=True)}}
    found = {s: round(float(v), 6) for s, v in zip(states, values, strict=True) if rng.random() < 0.8}
    item: dict[str, Any] = {"posterior": {**found, states[0]: 0.05, "kettle": round(float(rng.uniform(0, 0.5)), 6)}}
    if rng.random() < 0.5:
        item["temperature"] = round(float(rng.uniform(0.5, 3)), 3)
    if rng.random() < 0.5:
        weights = rng.dirichlet(np.full(len(states), 3.0))
        item["training_prior"] = {s: round(float(w), 6) for s, w in zip(states, weights, strict=True)}
    return item


def _number(rng: np.random.Generator, action: str) -> dict[str, Any]:
    if action == "squeezing":
        if rng.random() < 0.35:
            return {"above": 95.0} if rng.random() < 0.8 else {"above": round(float(rng.uniform(20, 95)), 3)}
        item: dict[str, Any] = {"value": round(float(rng.choice([0.0, rng.uniform(-10, 95)])), 3)}
    else:
        extreme = float(rng.choice([5.0, 2500.0, rng.uniform(-10, 20)]))
        usual = float(np.exp(rng.normal(4.5, 1.3)))
        item = {"value": round(extreme if rng.random() < 0.25 else usual, 3)}
    if rng.random() < 0.25:
        item["sd"] = float(rng.choice([0.5, 2.0, 50.0]))
    return item


def random_evidence(rng: np.random.Generator, network: Network) -> list[dict[str, Any]]:
    """One to six items; two sets of three hold a weighing."""
    actions = list(rng.choice([a for a in network.actions if a != "weighing"], size=int(rng.integers(0, 5))))
    actions += ["weighing"] * int(rng.choice([0, 1, 2], p=[0.33, 0.47, 0.2]))
    items = []
    for action in rng.permutation(actions or ["mat-vision"]):
        sensor = network.actions[str(action)].sensor
        if isinstance(sensor, ConfusionSensor):
            prop = network.properties[sensor.property]
            assert isinstance(prop, CategoricalProperty)
            outcome = _label(rng, sensor) if rng.random() < 0.65 else _vector(rng, prop.states)
        else:
            outcome = _number(rng, str(action)) if rng.random() < 0.95 else {"failed": True}
        items.append({"action": str(action), **outcome})
    return items


def answer(oracle: Oracle, items: list[dict[str, Any]]) -> dict[str, Any]:
    """All that the reference holds for one evidence set."""
    posterior = oracle.posterior(items)
    numbers = {}
    for name in ("elasticity", "density", "volume", "mass"):
        mean, sd = posterior.moments(name)
        quantiles = [posterior.quantile(name, p) for p in QUANTILES]
        numbers[name] = {"mean": mean, "sd": sd, "quantiles": quantiles, "entropy_bits": posterior.entropy_bits(name)}
    steps = []
    for i, item in enumerate(items):
        # Without a weighing so far nothing ties density to volume: the pair need not be integrated.
        loose = all(seen["action"] != "weighing" for seen in items[: i + 1])
        asked = replace(oracle, links=()) if loose else oracle
        before = asked.posterior(items[:i], gains=False, features=items)
        steps.append({"log2_before": before.log2_evidence, "surprise": before.surprise(item)})
    return {
        "evidence": items,
        "joint": posterior.probabilities("category", "material").tolist(),
        "numbers": numbers,
        "gains": {a: [posterior.gain(z, a) for z in OBJECTIVES] for a in oracle.network.actions},
        "log_evidence_bits": posterior.log2_evidence,
        "steps": steps,
    }


def rounded(value: Any) -> Any:
    """Nine significant digits: well below the oracle's tolerance."""
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(v) for v in value]
    return float(f"{value:.9g}") if isinstance(value, float) else value


def chosen(oracle: Oracle, count: int, seed: int) -> list[list[dict[str, Any]]]:
    """The evidence sets: the extremes first, then random ones that some object could give."""
    sets, rng = [list(extreme) for extreme in EXTREMES], np.random.default_rng(seed)
    while len(sets) < count:
        items = random_evidence(rng, oracle.network)
        if np.isfinite(oracle.log_prior + oracle.log_categorical(items)).any():
            sets.append(items)
    return sets


def _line(index: int, count: int = 200, seed: int = 20241) -> str:
    oracle = household_oracle(load_network("household"))
    return json.dumps(rounded(answer(oracle, chosen(oracle, count, seed)[index])), separators=(",", ":"))


def main(count: int = 200) -> None:
    """Write the reference file; finished sets stay in a folder beside it until all are there."""
    parts = FILE.with_suffix(".parts")
    parts.mkdir(exist_ok=True)
    for i in range(count):
        part = parts / f"{i:03d}.json"
        if not part.exists():
            part.write_text(_line(i))
    sets = ",".join(part.read_text() for part in sorted(parts.iterdir()))
    head = json.dumps({"objectives": OBJECTIVES, "quantiles": QUANTILES})[:-1]
    FILE.write_bytes(gzip.compress(f'{head},"sets":[{sets}]}}'.encode(), 9, mtime=0))
    shutil.rmtree(parts)


if __name__ == "__main__":
    main()
