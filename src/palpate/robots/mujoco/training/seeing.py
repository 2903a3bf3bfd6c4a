"""The models of images that ship: learned from pictures of made-up things, scored on things that were held out."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.vision import Model, OnnxClassifier
from palpate.outcomes import Failed
from palpate.robots.mujoco.training.held_out import (
    Examples,
    Probabilities,
    Scores,
    fit_temperature,
    folds,
    scores,
    tempered,
)
from palpate.robots.mujoco.training.learning import Net, Schedule, compact, fit, write_onnx
from palpate.robots.mujoco.training.nothing import NOTHING

__all__ = ["TrainedModel", "seen", "train_model", "write_model"]

FOLDS = 7
"""A seventh of the things is for the temperature, and a seventh for the scores."""


@dataclass(frozen=True, eq=False)
class TrainedModel:
    """What is known of a model whose file was written, and scores of it on things that it has not met."""

    model: Model
    scores: Scores


def train_model(
    examples: Examples,
    states: Sequence[str],
    path: Path,
    seed: int,
    *,
    source: str,
    rubbish: NDArray[np.uint8] | None = None,
    schedule: Schedule | None = None,
    build: Callable[[int, tuple[int, int]], Net] = compact,
) -> TrainedModel:
    """Train a model of images, write it as an ONNX file with a TOML file beside it, and score it.

    Parameters
    ----------
    examples
        Images, (n, height, width, 3); the groups are things, a part of which is held out.
    states
        In the order of the output.
    rubbish
        Images of nothing: the model has a label for such.
    path
        The ONNX file; what is said of it goes to a file of the same name that ends in ``.toml``.
    """
    untouched, cooling, *_ = folds(examples, FOLDS, np.random.default_rng(seed))
    learned = examples.of(~untouched & ~cooling)
    targets = np.array([list(states).index(label) for label in learned.labels.tolist()])
    height, width = learned.inputs.shape[1:3]
    size = (width, height)
    images, wanted, labels = learned.inputs.astype(np.uint8), targets, tuple(states)
    if rubbish is not None:
        images, labels = np.concatenate([images, rubbish]), (*labels, NOTHING)
        wanted = np.concatenate([targets, np.full(len(rubbish), len(states))])
    net = fit(lambda: build(len(labels), size), images, wanted, seed, schedule)
    write_onnx(net, size, path)
    shares = np.bincount(targets, minlength=len(states)) / len(targets)
    prior = {state: float(share) for state, share in zip(states, shares, strict=True)}
    nothing = NOTHING if rubbish is not None else None
    plain = Model(path, labels, training_prior=prior, nothing=nothing, source=source)
    calibration = examples.of(cooling)
    temperature = fit_temperature(seen(plain, calibration), calibration.labels, states)
    model = replace(plain, temperature=round(temperature, 3))
    write_model(model)
    rest = examples.of(untouched)
    return TrainedModel(model, scores(seen(model, rest), rest.labels, states))


def seen(model: Model, examples: Examples) -> Probabilities:
    """Probabilities of what a model tells, (n, k), as beliefs take them: calibrated, and without its training prior."""
    eye = OnnxClassifier(model)
    found, prior = np.full((len(examples.labels), len(model.tells)), np.nan), np.ones(len(model.tells))
    if model.training_prior is not None:
        prior = np.array([model.training_prior[label] for label in model.tells])
    for row, image in enumerate(examples.inputs):
        outcome = eye.outcome(image.astype(np.uint8))
        if not isinstance(outcome, Failed):
            told = np.array([[outcome.probabilities[label] for label in model.tells]])
            with np.errstate(divide="ignore"):
                calm = tempered(np.log(told), model.temperature)[0] / np.maximum(prior, 1e-6)
            found[row] = calm / calm.sum()
    return found


def write_model(model: Model) -> None:
    """Write what is known of a model beside its file, as `palpate.estimators.vision.read_model` reads it."""
    lines = [
        f"source = {json.dumps(model.source)}",
        f"path = {json.dumps(model.path.name)}",
        f"labels = {json.dumps(list(model.labels))}",
        f"temperature = {model.temperature}",
        f"mean = {list(model.mean)}",
        f"sd = {list(model.sd)}",
    ]
    if model.nothing is not None:
        lines.append(f"nothing = {json.dumps(model.nothing)}")
    if model.training_prior is not None:
        lines += ["", "[training_prior]"]
        lines += [f"{json.dumps(state)} = {share:.6f}" for state, share in model.training_prior.items()]
    model.path.with_suffix(".toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
