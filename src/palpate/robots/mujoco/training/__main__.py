"""``python -m palpate.robots.mujoco.training``: trains the models that ship, and prints how good they are."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from palpate.errors import PalpateError
from palpate.estimators.classifier import Classifier
from palpate.network.reading import load_network
from palpate.robots.mujoco.reading import bench_object, read_substances
from palpate.robots.mujoco.training import sounds
from palpate.robots.mujoco.training.held_out import scores
from palpate.robots.mujoco.training.report import report
from palpate.robots.mujoco.training.tables import Plate, draw_plates, read_measured

EACH, KNOCKS, BENCH_KNOCKS = 60, 4, 10
SEED = 1


def main(arguments: list[str] | None = None) -> int:
    """Run what the command line asks for; 2 if it could not be done."""
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except PalpateError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m palpate.robots.mujoco.training", description="Train the models that ship with the bench."
    )
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("sounds", help="the classifier of knocks, from plates of every material")
    command.set_defaults(run=_sounds)
    command.add_argument("out", type=Path, help="the JSON file to write")
    command.add_argument("--seed", type=int, default=SEED, help="of all chance (default %(default)s)")
    command.add_argument("--each", type=int, default=EACH, help="plates of a material (default %(default)s)")
    command.add_argument("--knocks", type=int, default=KNOCKS, help="on a plate (default %(default)s)")
    command = commands.add_parser("measured", help="how a classifier of knocks fares on the tables of the package tdw")
    command.set_defaults(run=_measured)
    command.add_argument("model", type=Path, help="the JSON file of the classifier")
    command.add_argument("--tables", type=Path, help="their folder (default: that of the installed package)")
    command.add_argument("--seed", type=int, default=SEED, help="of all chance (default %(default)s)")
    return parser


def _sounds(options: argparse.Namespace) -> None:
    rng = np.random.default_rng(options.seed)
    plates = draw_plates(read_substances(), options.each, rng)
    examples = sounds.record(plates, options.knocks, rng)
    source = (
        f"python -m palpate.robots.mujoco.training sounds --seed {options.seed} --each {options.each} "
        f"--knocks {options.knocks}: knocks on plates of the materials in data/bench/objects.toml"
    )
    trained = sounds.train(examples, rng, source=source)
    trained.classifier.save(options.out)
    print(report(f"Plates held out, {len(plates)} of them", trained.scores))
    network = load_network("household")
    things = [bench_object(network, name) for name in network.objects]
    own = [
        Plate(str(network.object(thing.name).truth["material"].value), thing.substance, thing.size_mm, thing.wall_mm)
        for thing in things
    ]
    met = sounds.record(own, BENCH_KNOCKS, rng)
    found = scores(
        sounds.answers(trained.classifier, met, trained.classifier.labels), met.labels, trained.classifier.labels
    )
    print()
    print(report("The bench's own objects", found))


def _measured(options: argparse.Namespace) -> None:
    tables, rng = read_measured(options.tables), np.random.default_rng(options.seed)
    examples = sounds.record(tables, BENCH_KNOCKS, rng)
    classifier = Classifier.load(options.model)
    states = classifier.labels
    found = scores(sounds.answers(classifier, examples, states), examples.labels, states)
    print(report(f"{options.model.name} on {len(tables)} measured tables", found))
    print()
    own = sounds.train(examples, rng, folds=2).scores
    print(report("Trained on half of the measured tables, told the others", own))


if __name__ == "__main__":
    sys.exit(main())
