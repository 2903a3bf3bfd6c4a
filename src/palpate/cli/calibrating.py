"""What `palpate calibrate` does: objects measured with a bar, then sensors fitted as `palpate network fit` does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate import __version__
from palpate.cli.benching import check_installed
from palpate.cli.fit_options import How, OfStore
from palpate.cli.store_options import Place
from palpate.errors import PalpateError, choices, near
from palpate.fitting.data import Data
from palpate.fitting.settings import Settings
from palpate.network.digest import digest
from palpate.network.model import Network
from palpate.network.reading import load_network

__all__ = ["OnRobot", "SensorsOf"]


@dataclass(frozen=True)
class OnRobot:
    """Data from a robot that measures known objects.

    Parameters
    ----------
    robot
        ``sampled`` or ``mujoco``; None where none was named.
    world
        Network from which the sampled robot draws; the one that is calibrated where it is None.
    folder
        Where outcomes are kept.
    """

    robot: str | None
    world: str | None
    things: tuple[str, ...]
    actions: tuple[str, ...]
    times: int
    seed: int
    folder: Path
    workers: int | None
    scheduler: str | None
    resume: bool

    def check_beside(self, place: Place, of_store: OfStore) -> None:
        """Refuse options of a store beside a robot, and those of a robot without one."""
        places = {"--store": place.place, "--blobs": place.blobs}
        typed = [name for name, value in {**places, **of_store.typed}.items() if value is not None]
        if self.robot is not None and typed:
            raise PalpateError(f"{', '.join(typed)}: for a store alone, and --robot was found; expected one of them")
        if self.world is not None and self.robot != "sampled":
            raise PalpateError("--world: for the sampled robot alone, expected --robot sampled")
        if self.robot is None and (self.things or self.resume or self.scheduler):
            raise PalpateError("--object, --resume, --scheduler: for a robot alone, expected --robot")

    def check(self) -> None:
        """Refuse a robot that cannot be had here."""
        if self.robot == "mujoco":
            check_installed()

    @property
    def words(self) -> list[object]:
        """What was typed."""
        world = ["--world", self.world] if self.world else []
        named = [word for name in self.things for word in ("--object", name)]
        return ["--robot", self.robot, *world, *named, "--times", self.times, "--seed", self.seed]

    def read(self, network: Network) -> Data:
        """Measure, or go on measuring, and read what was measured."""
        from palpate.cli.tasks_view import run_shown
        from palpate.experiments.measuring import InPhysics, Lab, Sampled, measure_tasks, measurements
        from palpate.experiments.shared import SharedNetwork
        from palpate.fitting.robot_data import read_outcomes

        drawn = network if self.world is None else load_network(self.world)
        lab: Lab = (InPhysics if self.robot == "mujoco" else Sampled)(SharedNetwork(drawn))
        things = _chosen("--object", self.things, drawn.objects)
        tasks = measure_tasks(lab, things, actions=self.actions, times=self.times, seed=self.seed)
        run_shown(
            tasks,
            self.folder,
            doing="Measuring",
            settings=self._settings(drawn, things),
            workers=self.workers,
            scheduler=self.scheduler,
            resume=self.resume,
        )
        return read_outcomes(network, drawn.objects, measurements(self.folder), self._source(drawn))

    def _settings(self, drawn: Network, things: Sequence[str]) -> dict[str, object]:
        """All that the outcomes depend on, as JSON."""
        return {
            "kind": "measurements",
            "robot": self.robot,
            "network": f"{drawn.name} {digest(drawn)}",
            "objects": list(things),
            "actions": list(self.actions),
            "times": self.times,
            "seed": self.seed,
            "palpate": __version__,
        }

    def _source(self, drawn: Network) -> str:
        return f"mujoco, seed {self.seed}" if self.robot == "mujoco" else f"sampled from {drawn.name}, seed {self.seed}"


@dataclass(frozen=True)
class SensorsOf:
    """The sensors of some actions, or of all; everything else stays as it is."""

    actions: tuple[str, ...]

    @property
    def command(self) -> tuple[str, ...]:
        """The command that fits them."""
        return ("calibrate",)

    def settings(self, network: Network, how: How) -> Settings:
        """How they are fitted."""
        chosen = _chosen("--action", self.actions, network.actions)
        kept = [name for name in network.actions if name not in chosen]
        return Settings(how.pseudo_count, (*network.properties, *kept), whole_sensors=True)

    def words(self, how: How) -> list[str]:
        """What was typed."""
        return [word for name in self.actions for word in ("--action", name)]


def _chosen(option: str, names: Sequence[str], known: Mapping[str, object]) -> tuple[str, ...]:
    """The names that were typed, all that are known where there are none."""
    for name in names:
        if name not in known:
            raise PalpateError(f"{option}: found {name!r}{near(name, known)}; {choices(known)}")
    if not known:
        raise PalpateError(f"{option}: the network knows none, expected one that does")
    return tuple(dict.fromkeys(names)) or tuple(known)
