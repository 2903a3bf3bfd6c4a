"""`palpate explore --video`, `--viewer` and `--rerun`: who watches, as the options say."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Self

from palpate.cli.asked import Asked, RobotKind
from palpate.cli.files import check_ending, replacing
from palpate.cli.spectators import Audience, Spectator
from palpate.explore import Step
from palpate.outcomes import Outcome
from palpate.selection.policies import Choice

if TYPE_CHECKING:
    from palpate.cli.preparing import Ready
    from palpate.robots.mujoco.robot import MujocoRobot
    from palpate.robots.mujoco.scene import Scene
    from palpate.robots.mujoco.viewer import Viewer
    from palpate.robots.signals import Signals

__all__ = ["check_watching", "watching"]


def check_watching(asked: Asked) -> None:
    """Refuse files that cannot be written and packages that are missing, before anything is done."""
    if asked.video is not None:
        from palpate.figures.film import check_film

        check_ending("--video", asked.video, ".mp4")
        check_film()
    if asked.rerun is not None:
        from palpate.cli.rerunning import check_rerun

        check_ending("--rerun", asked.rerun, ".rrd")
        check_rerun()


@contextmanager
def watching(asked: Asked, ready: Ready) -> Iterator[Audience]:
    """All who watch while the block runs; files are whole in the end, or not there."""
    robot = _bench_robot(ready)
    with ExitStack() as stack:
        spectators = [stack.enter_context(spectator) for spectator in _spectators(asked, ready, robot, stack)]
        audience = Audience(spectators)
        if spectators and robot is not None:
            robot.bench.motion.watch = audience.seen
            robot.listeners.append(audience.measured)
        yield audience


def _spectators(asked: Asked, ready: Ready, robot: MujocoRobot | None, stack: ExitStack) -> Iterator[Spectator]:
    """Each in turn, so that those who came are let go of where another cannot; files are replaced by the stack."""
    title = f"{ready.about.object}, learning {ready.about.objective}"
    if asked.viewer and robot is not None:
        from palpate.robots.mujoco.viewer import Viewer

        yield _Window(Viewer(robot.bench.scene))
    if asked.video is not None and robot is not None:
        yield _filming(stack.enter_context(replacing(asked.video)), ready, robot, title)
    if asked.rerun is not None:
        from palpate.cli.rerunning import Rerunning

        draft = stack.enter_context(replacing(asked.rerun))
        yield Rerunning(draft, title, ready.prior, None if robot is None else robot.bench)


def _bench_robot(ready: Ready) -> MujocoRobot | None:
    if ready.about.robot != RobotKind.MUJOCO.value:
        return None
    from palpate.robots.mujoco.robot import MujocoRobot

    assert isinstance(ready.robot, MujocoRobot)
    return ready.robot


def _filming(path: Path, ready: Ready, robot: MujocoRobot, title: str) -> Spectator:
    from palpate.cli.filming import SIZE, Filming
    from palpate.figures.belief_panel import Panel
    from palpate.figures.film import Film
    from palpate.summary import summarise

    panel = Panel(title, "before the first action", robot.actions(), summarise(ready.prior))
    return Filming(Film(path, SIZE), robot.bench.scene, panel)


class _Window:
    """A viewer that is shown the scene; what is thought meanwhile it does not show."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._viewer.close()

    def chosen(self, choice: Choice, action: str) -> None:
        """Nothing to show."""

    def seen(self, scene: Scene) -> None:
        """Show it."""
        self._viewer.show(scene)

    def measured(self, action: str, signals: Signals, outcome: Outcome) -> None:
        """Nothing to show."""

    def learned(self, step: Step) -> None:
        """Nothing to show."""
