"""``python -m palpate.robots.mujoco.training``: trains the models that ship, and prints how good they are."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from palpate.errors import PalpateError
from palpate.robots.mujoco.training import commands

SEED = 1


def main(arguments: list[str] | None = None) -> int:
    """Run what the command line asks for; 2 if it could not be done."""
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except (PalpateError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=commands.PROGRAM, description="Train the models that ship with the bench, and tell how good they are."
    )
    verbs = parser.add_subparsers(required=True)
    verb = verbs.add_parser("sounds", help="the classifier of knocks, from plates of every material")
    verb.add_argument("out", type=Path, help="the JSON file to write")
    _count(verb, each=(60, "plates of a material"), knocks=(4, "on a plate"))
    verb.set_defaults(run=commands.train_ears)
    verb = verbs.add_parser("measured", help="how a classifier of knocks fares on the tables of the package tdw")
    verb.add_argument("model", type=Path, help="the JSON file of the classifier")
    verb.add_argument("--tables", type=Path, help="their folder (default: that of the installed package)")
    verb.set_defaults(run=commands.try_measured)
    verb = verbs.add_parser("pictures", help="the models of images, from pictures of things drawn at random")
    verb.add_argument("out", type=Path, help="the folder to write to")
    _count(verb, things=(900, "things to draw"), views=(2, "pictures of a thing"), epochs=(24, "times to learn them"))
    verb.set_defaults(run=commands.train_eyes)
    verb = verbs.add_parser("spectrograms", help="a ResNet34 of mel spectrograms, from plates of every material")
    verb.add_argument("out", type=Path, help="the ONNX file to write")
    _count(
        verb, each=(60, "plates of a material"), knocks=(4, "on a plate"), epochs=(10, "times to learn from each knock")
    )
    verb.set_defaults(run=commands.train_listener)
    for verb in verbs.choices.values():
        verb.add_argument("--seed", type=int, default=SEED, help="of all chance (default %(default)s)")
    return parser


def _count(verb: argparse.ArgumentParser, **counts: tuple[int, str]) -> None:
    for name, (default, what) in counts.items():
        verb.add_argument(f"--{name}", type=int, default=default, help=f"{what} (default %(default)s)")


if __name__ == "__main__":
    sys.exit(main())
