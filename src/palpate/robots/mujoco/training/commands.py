"""What the training commands do: draw, train, write, and print how good it is."""

from __future__ import annotations

from argparse import Namespace

import numpy as np

from palpate.estimators.classifier import Classifier
from palpate.estimators.vision import Model, OnnxClassifier
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.outcomes import Failed
from palpate.robots.mujoco.reading import read_substances
from palpate.robots.mujoco.training import sounds
from palpate.robots.mujoco.training.held_out import Examples, Scores, scores
from palpate.robots.mujoco.training.own import own_pictures, own_plates
from palpate.robots.mujoco.training.report import report
from palpate.robots.mujoco.training.tables import draw_plates, read_measured

__all__ = ["train_ears", "train_eyes", "train_listener", "try_measured"]

OWN_KNOCKS, OWN_LOOKS = 10, 4
SEEN_OF_THINGS = ("category", "material")
PROGRAM = "python -m palpate.robots.mujoco.training"


def train_ears(options: Namespace) -> None:
    """The classifier of knocks."""
    rng = np.random.default_rng(options.seed)
    plates = draw_plates(read_substances(), options.each, rng)
    examples = sounds.record(plates, options.knocks, rng)
    source = (
        f"{PROGRAM} sounds --seed {options.seed} --each {options.each} --knocks {options.knocks}: "
        "knocks on plates of the materials in data/bench/objects.toml"
    )
    trained = sounds.train(examples, rng, source=source)
    trained.classifier.save(options.out)
    print(report(f"Plates held out, {len(plates)} of them", trained.scores))
    met = sounds.record(own_plates(load_network("household")), OWN_KNOCKS, rng)
    states = trained.classifier.labels
    print(
        "\n"
        + report("The bench's own objects", scores(sounds.answers(trained.classifier, met, states), met.labels, states))
    )


def try_measured(options: Namespace) -> None:
    """A classifier of knocks on tables of real things, and its like trained on some of these."""
    tables, rng = read_measured(options.tables), np.random.default_rng(options.seed)
    examples = sounds.record(tables, OWN_KNOCKS, rng)
    classifier = Classifier.load(options.model)
    states = classifier.labels
    found = scores(sounds.answers(classifier, examples, states), examples.labels, states)
    print(report(f"{options.model.name} on {len(tables)} measured tables", found))
    own = sounds.train(examples, rng, folds=2).scores
    print("\n" + report("Trained on half of the measured tables, told the others", own))


def train_eyes(options: Namespace) -> None:
    """The models of images, one for the category and one for the material."""
    from palpate.robots.mujoco.training.learning import Schedule
    from palpate.robots.mujoco.training.nothing import empty_tables, rubbish
    from palpate.robots.mujoco.training.pictures import draw_sights, photograph
    from palpate.robots.mujoco.training.seeing import train_model
    from palpate.robots.mujoco.training.surfaces import SEEN, UNSEEN

    network = load_network("household")
    drawn, blank, tested = (np.random.default_rng(options.seed + place) for place in range(3))
    album = photograph(draw_sights(network, options.things, SEEN, drawn, "train"), options.views, drawn)
    images = len(album.images)
    nothing = np.concatenate([empty_tables(1 + images // 60, blank), rubbish(images // 8, album, blank)])
    blue = photograph(draw_sights(network, 1 + options.things // 10, UNSEEN, tested, "unseen"), options.views, tested)
    own, unknown = own_pictures(network, OWN_LOOKS, tested), rubbish(1 + images // 20, album, tested)
    source = (
        f"{PROGRAM} pictures --seed {options.seed} --things {options.things} --views {options.views} "
        f"--epochs {options.epochs}: pictures of things drawn at random on the bench"
    )
    options.out.mkdir(parents=True, exist_ok=True)
    for what in SEEN_OF_THINGS:
        measured = network.properties[what]
        assert isinstance(measured, CategoricalProperty)
        trained = train_model(
            album.by([getattr(sight, what) for sight in album.sights]),
            measured.states,
            options.out / f"{what}.onnx",
            options.seed,
            source=source,
            rubbish=nothing,
            schedule=Schedule(options.epochs),
        )
        print(report(f"Things held out, {what}", trained.scores) + "\n")
        hues = blue.by([getattr(sight, what) for sight in blue.sights])
        for name, test in (("Colours never met", hues), ("The bench's own objects", own[what])):
            print(report(f"{name}, {what}", _scored(trained.model, test)) + "\n")
        eye = OnnxClassifier(trained.model)
        refused = np.mean([isinstance(eye.outcome(image), Failed) for image in unknown])
        print(f"Noise, stripes and disorder never met, {what}: {100 * refused:.0f} % refused\n", flush=True)


def train_listener(options: Namespace) -> None:
    """The paper's network on mel spectrograms of knocks."""
    from palpate.robots.mujoco.training.learning import Schedule, resnet34
    from palpate.robots.mujoco.training.seeing import train_model

    rng = np.random.default_rng(options.seed)
    plates = draw_plates(read_substances(), options.each, rng)
    examples = sounds.draw_spectrograms(plates, options.knocks, rng)
    source = (
        f"{PROGRAM} spectrograms --seed {options.seed} --each {options.each} --knocks {options.knocks} "
        f"--epochs {options.epochs}: mel spectrograms of knocks on plates of the materials in data/bench/objects.toml"
    )
    trained = train_model(
        examples,
        examples.states,
        options.out,
        options.seed,
        source=source,
        schedule=Schedule(options.epochs, batch=32, rate=1e-3),
        build=lambda states, _: resnet34(states),
    )
    print(report("Plates held out", trained.scores))
    met = sounds.draw_spectrograms(own_plates(load_network("household")), OWN_LOOKS, rng)
    print("\n" + report("The bench's own objects", _scored(trained.model, met)))


def _scored(model: Model, examples: Examples) -> Scores:
    from palpate.robots.mujoco.training.seeing import seen

    return scores(seen(model, examples), examples.labels, model.tells)
