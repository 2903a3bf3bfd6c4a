"""`palpate explore --rerun`: a log for Rerun's viewer, of beliefs, gains, images and raw signals."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.errors import PalpateError, extra
from palpate.explore import Step
from palpate.inference.belief import Belief
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.outcomes import Outcome
from palpate.selection.policies import Choice
from palpate.summary import CategoricalSummary, ContinuousSummary, summarise
from palpate.wording import outcome_words

if TYPE_CHECKING:
    from rerun.blueprint import Blueprint

    from palpate.robots.mujoco.bench import Bench
    from palpate.robots.mujoco.camera import Camera
    from palpate.robots.mujoco.scene import Scene
    from palpate.robots.signals import GripperSamples, Signals

__all__ = ["Rerunning", "check_rerun"]

STEP, TIME = "step", "bench time"
SCENE_SIZE, TICKS = (640, 480), 20
"""The scene is logged in this size, each so many hundredths of a second of its time."""
QUALITY = 80
SIGNALS = {"arm": "torques [N m]", "gripper": "gap [mm] and force [N]", "microphone": "microphone"}
"""Raw signals of different scales, each kind in a view of its own."""


def check_rerun() -> None:
    """Say what is missing where nothing can be logged."""
    if find_spec("rerun") is None:
        raise PalpateError(f"--rerun needs rerun-sdk, which is not installed: {extra('rerun')}")


class Rerunning:
    """Logs an exploration to a file that ``rerun FILE`` shows; it needs the extra ``rerun``.

    Parameters
    ----------
    path
        The file; it ends in .rrd.
    title
        What is explored, and what for.
    prior
        The belief at the start.
    bench
        Where it is explored; None where that is no bench, and there is nothing to be seen.
    """

    def __init__(self, path: Path, title: str, prior: Belief, bench: Bench | None) -> None:
        check_rerun()
        import rerun

        self._rerun, self._prior, self._bench, self._ticks = rerun, prior, bench, 0
        self._camera: Camera | None = None
        self._log = rerun.RecordingStream("palpate")
        self._log.save(path, default_blueprint=_blueprint(prior.network))
        self._log.send_recording_name(title)
        if bench is not None:
            from palpate.robots.mujoco.camera import Camera

            self._camera = Camera(bench.scene, SCENE_SIZE)

    def __enter__(self) -> Self:
        try:
            self._step(0, self._prior)
            self._see()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        if self._camera is not None:
            self._camera.close()
        self._log.flush()
        self._log.disconnect()

    def chosen(self, choice: Choice, action: str) -> None:
        """Log the gains before an action."""
        self._log.set_time(STEP, sequence=len(choice.taken) + 1)
        for name, bits in choice.gains.items():
            self._log.log(f"gains/{name}", self._rerun.Scalars(bits))
        self._log.log("words", self._rerun.TextLog(f"{action} is chosen"))

    def seen(self, scene: Scene) -> None:
        """Log the scene where it is time for it."""
        self._ticks += 1
        if self._ticks % TICKS == 0:
            self._see()

    def measured(self, action: str, signals: Signals, outcome: Outcome) -> None:
        """Log raw signals at the times at which they were read."""
        from palpate.robots.signals import ImageSignals, SoundSignals, SqueezeSignals, WeighSignals

        match signals:
            case ImageSignals():
                self._log.log("camera", self._rerun.Image(signals.image))
            case SoundSignals():
                seconds = np.arange(signals.samples.size) / signals.rate_hz
                self._columns("signals/microphone", seconds + self._now_s(), signals.samples)
            case SqueezeSignals():
                self._gripper(signals.gripper)
            case WeighSignals():
                for hold in (*signals.holds, *signals.others):
                    self._columns(f"signals/arm/{hold.joint}", hold.time_s, hold.torque_nm)
                if signals.gripper is not None:
                    self._gripper(signals.gripper)

    def learned(self, step: Step) -> None:
        """Log the outcome and the belief."""
        told = f"stopped: {step.stop}"
        if step.outcome is not None:
            told = f"{step.action} gave {outcome_words(step.outcome)}"
        self._step(step.index, step.after)
        self._log.log("words", self._rerun.TextLog(told))

    def _step(self, index: int, belief: Belief) -> None:
        self._log.set_time(STEP, sequence=index)
        self._log.set_time(TIME, duration=self._now_s())
        for name, summary in summarise(belief).items():
            if isinstance(summary, CategoricalSummary):
                for state, probability in summary.probabilities.items():
                    self._log.log(f"belief/{name}/{state}", self._rerun.Scalars(probability))
            elif isinstance(summary, ContinuousSummary):
                # bars stand at even distances
                x = np.linspace(summary.x[0], summary.x[-1], len(summary.x))
                density = np.interp(x, summary.x, summary.density)
                # a bar is one unit wide unless told, which hides bars that are further apart
                widths = np.full(len(x), x[1] - x[0])
                self._log.log(f"belief/{name}", self._rerun.BarChart(density, abscissa=x, widths=widths))

    def _see(self) -> None:
        if self._camera is None:
            return
        from palpate.robots.mujoco.furniture import OVERVIEW

        self._log.set_time(TIME, duration=self._now_s())
        image = self._rerun.Image(self._camera.image(OVERVIEW))
        self._log.log("scene", image.compress(jpeg_quality=QUALITY))

    def _now_s(self) -> float:
        return 0.0 if self._bench is None else self._bench.clock_s

    def _gripper(self, samples: GripperSamples) -> None:
        self._columns("signals/gripper/gap_mm", samples.time_s, samples.gap_mm)
        self._columns("signals/gripper/force_n", samples.time_s, samples.force_n)

    def _columns(self, path: str, time_s: NDArray[np.float64], values: ArrayLike) -> None:
        times = self._rerun.TimeColumn(TIME, duration=time_s)
        self._log.send_columns(path, [times], self._rerun.Scalars.columns(scalars=values))


def _blueprint(network: Network) -> Blueprint:
    """What the viewer shows at first: the scene, beliefs beside it, gains and signals below."""
    from rerun import blueprint as parts

    beliefs = [
        (parts.TimeSeriesView if isinstance(known, CategoricalProperty) else parts.BarChartView)(
            origin=f"belief/{name}", name=name if isinstance(known, CategoricalProperty) else f"{name} [{known.unit}]"
        )
        for name, known in network.properties.items()
    ]
    left = parts.Vertical(
        parts.Spatial2DView(origin="scene", name="scene"),
        parts.TextLogView(origin="words", name="what was done"),
        row_shares=[3, 1],
    )
    below = parts.Horizontal(
        parts.TimeSeriesView(origin="gains", name="expected gain [bits]"),
        parts.Tabs(
            *(parts.TimeSeriesView(origin=f"signals/{part}", name=name) for part, name in SIGNALS.items()),
            name="raw signals",
        ),
        parts.Spatial2DView(origin="camera", name="camera"),
    )
    right = parts.Vertical(parts.Grid(*beliefs, grid_columns=2), below, row_shares=[3, 1])
    return parts.Blueprint(
        parts.Horizontal(left, right), parts.TimePanel(state="collapsed", timeline=TIME), collapse_panels=True
    )
