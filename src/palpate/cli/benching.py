"""`palpate explore --robot mujoco`: the bench in physics."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import fields, replace
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from palpate.cli.options import number_of
from palpate.errors import PalpateError, choices, extra, near
from palpate.network.model import Network
from palpate.selection.policies import FixedOrder, Policy

if TYPE_CHECKING:
    from palpate.robots.mujoco.noise import BenchNoise
    from palpate.robots.mujoco.robot import MujocoRobot

__all__ = ["bench_in_use", "bench_robot", "check_installed", "noise_of"]

NONE = "none"


def bench_robot(
    network: Network, thing: str, noise: Iterable[str], rng: np.random.Generator, shapes: Path | None = None
) -> MujocoRobot:
    """A robot on the bench with an object of a network on the table; to be closed.

    Parameters
    ----------
    noise
        ``--noise``.
    shapes
        ``--shapes``; the file that ships unless given.
    """
    check_installed()
    from palpate.robots.mujoco.estimates import estimates
    from palpate.robots.mujoco.reading import SHIPPED
    from palpate.robots.mujoco.robot import MujocoRobot

    network.object(thing)
    path = shapes if shapes is not None else SHIPPED
    found = estimates(network, path=path)
    return MujocoRobot.of(network, thing, found, noise=noise_of(noise), rng=rng, path=path)


@contextmanager
def bench_in_use(robot: MujocoRobot, network: Network, policy: Policy) -> Iterator[None]:
    """Refuse a robot that may look where nothing can be drawn, before anything is done; let go of it afterwards."""
    chosen = policy.order if isinstance(policy, FixedOrder) else robot.actions()
    with robot:
        if any(network.action(action).sees_appearance for action in chosen if action in robot.actions()):
            robot.bench.camera.image()
        yield


def noise_of(texts: Iterable[str]) -> BenchNoise:
    """``--noise NAME=VALUE`` or ``--noise none``, one after the other."""
    from palpate.robots.mujoco.noise import QUIET, BenchNoise

    found, names = BenchNoise(), [entry.name for entry in fields(BenchNoise)]
    for text in texts:
        name, equals, value = text.partition("=")
        if text == NONE:
            found = QUIET
        elif not equals:
            raise PalpateError(f"--noise: {text!r} was found, expected NAME=VALUE or {NONE}")
        elif name not in names:
            raise PalpateError(f"--noise: unknown name {name!r}{near(name, names)}; {choices(names)}")
        else:
            found = replace(found, **{name: number_of(f"--noise {name}", value)})
    return found


def check_installed() -> None:
    """Say what is missing where the package was installed without what the bench needs."""
    if find_spec("mujoco") is None:
        raise PalpateError(f"--robot mujoco needs mujoco, which is not installed: {extra('bench')}")
    from palpate.robots import mujoco as bench

    try:
        import mujoco  # noqa: F401
    # each graphics library has errors of its own, down to missing functions
    except (ImportError, OSError, RuntimeError, AttributeError) as error:
        drawn = os.environ.get("MUJOCO_GL", "")
        raise PalpateError(
            f"--robot mujoco: MuJoCo cannot be imported with MUJOCO_GL={drawn} ({error}), expected a graphics library "
            f"that is installed ({', '.join(dict.fromkeys(bench.LIBRARIES.values()))}), or MUJOCO_GL=disabled"
        ) from error
