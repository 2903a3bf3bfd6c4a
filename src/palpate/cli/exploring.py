"""Run an exploration in the terminal: show every step, keep what was asked for."""

from __future__ import annotations

import time
from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console, Group
from rich.live import Live
from rich.padding import Padding
from rich.rule import Rule
from rich.text import Text

from palpate.cli.asked import Asked
from palpate.cli.belief_view import scales
from palpate.cli.files import check_picture, check_writable, replacing
from palpate.cli.keeping import Kept, keeping
from palpate.cli.network_view import object_table
from palpate.cli.preparing import Ready, prepare
from palpate.cli.spectators import Audience
from palpate.cli.step_view import View
from palpate.cli.store_options import Place
from palpate.cli.terminal import console
from palpate.cli.truth_view import truth_table
from palpate.cli.waiting_view import Waiting
from palpate.cli.watching import check_watching, watching
from palpate.episode import EpisodeLog, record_episode
from palpate.explore import Step, explore
from palpate.robots.protocol import Robot
from palpate.selection.lookahead import LookAhead
from palpate.selection.policies import Choice, Policy

__all__ = ["explore_object", "list_objects"]


def list_objects(asked: Asked) -> None:
    """Print the objects that can be simulated."""
    console().print(object_table(asked.load()))


def explore_object(asked: Asked, place: Place) -> None:
    """Explore, print, and keep what was asked for: in a log, in a store, as a picture."""
    ready = prepare(asked, place)
    if asked.plot is not None:
        check_picture("--plot", asked.plot)
    if asked.log is not None:
        check_writable("--log", asked.log)
    check_watching(asked)
    with ready.using, watching(asked, ready) as audience, keeping(asked, place, ready) as kept:
        steps = _explore(asked, ready, kept, audience)
    if asked.plot is not None:
        _plot(asked.plot, ready, steps)


def _explore(asked: Asked, ready: Ready, kept: Kept, audience: Audience) -> list[Step]:
    """Explore; keep, show and print each step."""
    screen, view, steps = console(), _view(asked, ready), list[Step]()
    log = EpisodeLog(asked.log, ready.prior, ready.about) if asked.log is not None else None
    screen.print(_heading(asked, ready, view, kept.told), crop=False)
    with closing(_explored(asked, ready, kept.robot, audience, screen, view)) as exploration:
        for step in exploration:
            # What was done is kept before it is shown: the screen may be a pipe that is closed.
            if log is not None:
                log.write(step)
            if kept.episode is not None:
                kept.episode.write(step)
            steps.append(step)
            audience.learned(step)
            if step.action is not None:
                screen.print(view.step(step))
                # it is who explores that waits, whether anybody watches or not
                time.sleep(asked.pace_s)
    *taken, last = steps
    screen.print(view.end(last, taken))
    if ready.known is not None:
        screen.print(Padding(truth_table(last.after, ready.known), (0, 0, 0, 1)))
    return steps


def _plot(path: Path, ready: Ready, steps: Sequence[Step]) -> None:
    # matplotlib is slow to import
    from palpate.figures.episode import draw_episode

    with replacing(path) as draft:
        draw_episode(record_episode(ready.prior, steps, ready.about), draft)


def _view(asked: Asked, ready: Ready) -> View:
    network = ready.prior.network
    at_first = ready.objective.gains(ready.prior, network.actions)
    return View(
        network=network,
        objective=ready.objective.name,
        costs_s=ready.costs_s,
        drawn_on=scales(ready.prior),
        full_bits=max(at_first.values(), default=0.0),
        verbose=asked.verbose,
    )


@dataclass(frozen=True)
class _Announced:
    """A policy that tells what it chose before the robot does it."""

    policy: Policy
    tell: Callable[[Choice, str], None]

    def choose(self, choice: Choice) -> str | None:
        """What the policy chooses."""
        action = self.policy.choose(choice)
        if action is not None:
            self.tell(choice, action)
        return action


def _explored(
    asked: Asked, ready: Ready, robot: Robot, audience: Audience, screen: Console, view: View
) -> Generator[Step]:
    """The steps; what is being done is shown while it lasts."""
    waiting = Waiting()
    with Live(waiting, console=screen, transient=True) as live:

        def tell(choice: Choice, action: str) -> None:
            live.update(view.pending(choice, action), refresh=True)
            audience.chosen(choice, action)

        policy = replace(ready.policy, told=waiting.told) if isinstance(ready.policy, LookAhead) else ready.policy
        for step in explore(
            ready.prior,
            robot,
            objective=ready.objective,
            policy=_Announced(policy, tell),
            stopping=ready.stopping,
            repeat=asked.repeat,
            rng=ready.rng,
            costs_s=ready.costs_s,
            timeout_s=asked.timeout_s,
        ):
            waiting.restart()
            live.update(waiting, refresh=True)
            yield step


def _heading(asked: Asked, ready: Ready, view: View, kept: str) -> Group:
    """What is explored, and how."""
    known = ready.known
    about = known.description if known else ""
    how = [
        f"network {ready.prior.network.name}",
        f"objective {ready.about.objective}",
        f"policy {ready.about.policy}",
        f"robot {ready.about.robot}",
    ]
    if ready.about.seed is not None:
        how.append(f"seed {ready.about.seed}")
    if asked.engine != "exact":
        how.insert(1, f"engine {ready.about.engine}")
    lines = [Text.assemble("Exploring ", (ready.about.object or "an object", "bold"), f": {about}" if about else "")]
    if known and known.looks_like:
        lines.append(Text(f"A trick: to a camera it looks like {known.looks_like}."))
    lines.append(Text(", ".join(how), style="dim"))
    if kept:
        # an address that was folded is none
        lines.append(Text(kept, style="dim", no_wrap=True, overflow="ignore"))
    if asked.verbose:
        lines += [Text(f"note: {note}", style="dim") for note in ready.notes]
    elif ready.notes:
        lines.append(Text(f"{len(ready.notes)} notes on how the session was recorded (--verbose)", style="dim"))
    prior = Rule(Text("Before  the prior"), align="left", style="dim")
    return Group(*lines, Text(), prior, Padding(view.belief(ready.prior), (0, 0, 1, 1)))
