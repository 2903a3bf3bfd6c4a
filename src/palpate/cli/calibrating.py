"""What `palpate calibrate` does: objects measured with a bar, then sensors fitted as `palpate network fit` does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate import __version__
from palpate.cli.benching import check_installed
from palpate.cli.calibrate_options import Measured
from palpate.cli.fit_options import How, OfStore
from palpate.cli.store_options import Place
from palpate.cli.task_options import RobotKind, Running
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
    asked
        What was typed.
    folder
        Where outcomes are kept.
    """

    asked: Measured
    running: Running
    folder: Path

    def check_beside(self, place: Place, of_store: OfStore) -> None:
        """Refuse options of a store beside a robot, and those of a robot without one."""
        places = {"--store": place.place, "--blobs": place.blobs}
        typed = [name for name, value in {**places, **of_store.typed}.items() if value is not None]
        asked, running = self.asked, self.running
        if asked.robot is not None and typed:
            raise PalpateError(f"{', '.join(typed)}: for a store alone, and --robot was found; expected one of them")
        if asked.world is not None and asked.robot is not RobotKind.SAMPLED:
            raise PalpateError("--world: for the sampled robot alone, expected --robot sampled")
        if asked.robot is None and (asked.things or running.resume or running.scheduler):
            raise PalpateError("--object, --resume, --scheduler: for a robot alone, expected --robot")

    def check(self) -> None:
        """Refuse a robot that cannot be had here."""
        if self._in_physics:
            check_installed()

    @property
    def words(self) -> list[object]:
        """What was typed."""
        asked = self.asked
        world = ["--world", asked.world] if asked.world else []
        named = [word for name in asked.things for word in ("--object", name)]
        return ["--robot", self._robot, *world, *named, "--times", asked.times, "--seed", asked.seed]

    def read(self, network: Network) -> Data:
        """Measure, or go on measuring, and read what was measured."""
        from palpate.cli.tasks_view import run_shown
        from palpate.experiments.measuring import InPhysics, Lab, Sampled, measure_tasks, measurements
        from palpate.experiments.shared import SharedNetwork
        from palpate.fitting.robot_data import read_outcomes

        asked = self.asked
        drawn = network if asked.world is None else load_network(asked.world)
        lab: Lab = (InPhysics if self._in_physics else Sampled)(SharedNetwork(drawn))
        things = _chosen("--object", asked.things, drawn.objects)
        tasks = measure_tasks(lab, things, actions=asked.actions, times=asked.times, seed=asked.seed)
        run_shown(tasks, self.folder, self.running, doing="Measuring", settings=self._settings(drawn, things))
        return read_outcomes(network, drawn.objects, measurements(self.folder), self._source(drawn))

    def _settings(self, drawn: Network, things: Sequence[str]) -> dict[str, object]:
        """All that the outcomes depend on, as JSON."""
        return {
            "kind": "measurements",
            "robot": self._robot,
            "network": f"{drawn.name} {digest(drawn)}",
            "objects": list(things),
            "actions": list(self.asked.actions),
            "times": self.asked.times,
            "seed": self.asked.seed,
            "palpate": __version__,
        }

    def _source(self, drawn: Network) -> str:
        measured = "mujoco" if self._in_physics else f"sampled from {drawn.name}"
        return f"{measured}, seed {self.asked.seed}"

    @property
    def _in_physics(self) -> bool:
        return self.asked.robot is RobotKind.MUJOCO

    @property
    def _robot(self) -> str | None:
        return None if self.asked.robot is None else self.asked.robot.value


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

    @property
    def words(self) -> list[str]:
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
