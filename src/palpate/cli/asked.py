"""Options of `palpate explore`, for `palpate.cli.spreading.spread`."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from palpate.network.model import Network

__all__ = ["Asked", "RobotKind"]

LOOP, ROBOT, OUTPUT = "The exploration", "The robot", "What is kept"


class RobotKind(Enum):
    """Who does the actions."""

    SAMPLED = "sampled"
    REPLAY = "replay"
    MUJOCO = "mujoco"


@dataclass(frozen=True)
class Asked:
    """What to explore and how, as it was typed; None where it was not."""

    thing: Annotated[str | None, typer.Argument(metavar="OBJECT", help="One of the network's objects.")] = None
    network: Annotated[
        str | None,
        typer.Option(
            help="Shipped network or TOML file (default: household for a replay, else household-filled).",
            rich_help_panel=LOOP,
        ),
    ] = None
    learn: Annotated[
        list[str] | None,
        typer.Option(help="Property to learn about; several are learned together.", rich_help_panel=LOOP),
    ] = None
    policy: Annotated[
        str,
        typer.Option(
            help="greedy, greedy-per-cost, random, fixed:ACTION,..., static:K or look-ahead:N.", rich_help_panel=LOOP
        ),
    ] = "greedy"
    stop: Annotated[
        list[str] | None,
        typer.Option(
            help="gain:BITS, net-gain:BITS_PER_S, entropy:PROPERTY:BITS, sd:PROPERTY:SD, cost:SECONDS, steps:N "
            "or nothing-left; the first of several to hold stops (default: gain:0.05).",
            rich_help_panel=LOOP,
        ),
    ] = None
    budget_s: Annotated[
        float | None, typer.Option("--budget", help="Cost not to exceed, in seconds.", rich_help_panel=LOOP)
    ] = None
    steps: Annotated[int | None, typer.Option(min=1, help="Most steps to take.", rich_help_panel=LOOP)] = None
    costs: Annotated[
        list[str] | None,
        typer.Option(
            "--cost",
            metavar="ACTION=SECONDS",
            help="Cost of an action, in place of the network's.",
            rich_help_panel=LOOP,
        ),
    ] = None
    repeat: Annotated[
        bool, typer.Option("--repeat/--no-repeat", help="Whether an action may be taken again.", rich_help_panel=LOOP)
    ] = False
    engine: Annotated[
        str,
        typer.Option(
            help="Inference engine: exact, or message-passing: the method of the paper.", rich_help_panel=LOOP
        ),
    ] = "exact"
    preset: Annotated[
        str | None,
        typer.Option(help="Message passing as-released (default), repaired or as-written.", rich_help_panel=LOOP),
    ] = None
    robot: Annotated[
        RobotKind,
        typer.Option(
            help="Draw outcomes from the sensor models, replay recorded ones, or measure on the bench in physics.",
            rich_help_panel=ROBOT,
        ),
    ] = RobotKind.SAMPLED
    session: Annotated[
        str | None,
        typer.Option(
            metavar="FILE|store|store:EPISODE",
            help="What to replay: a session or episode log, all that the store has of OBJECT, or an episode of the "
            "store (default: the shipped session).",
            rich_help_panel=ROBOT,
        ),
    ] = None
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of all chance (default: a new one, shown).", rich_help_panel=ROBOT)
    ] = None
    noise: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=VALUE",
            help="A parameter of the bench's sensors and grasps, or none for perfect ones.",
            rich_help_panel=ROBOT,
        ),
    ] = None
    shapes: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Shapes and looks of the network's objects on the bench (default: those that ship).",
            rich_help_panel=ROBOT,
        ),
    ] = None
    timeout_s: Annotated[
        float | None,
        typer.Option("--timeout", help="Longest time an action may take, in seconds.", rich_help_panel=ROBOT),
    ] = None
    pace_s: Annotated[
        float,
        typer.Option("--pace", help="Pause after each step, in seconds, for who watches.", rich_help_panel=LOOP),
    ] = 0.0
    log: Annotated[
        Path | None, typer.Option(help="Write a line of JSON per step to this file.", rich_help_panel=OUTPUT)
    ] = None
    plot: Annotated[Path | None, typer.Option(help="Draw the episode: .png, .svg or .pdf.", rich_help_panel=OUTPUT)] = (
        None
    )
    video: Annotated[
        Path | None,
        typer.Option(help="Film the bench with the belief beside it, to this .mp4 file.", rich_help_panel=OUTPUT),
    ] = None
    viewer: Annotated[
        bool, typer.Option("--viewer", help="Show the bench in a window of MuJoCo's.", rich_help_panel=OUTPUT)
    ] = False
    rerun: Annotated[
        Path | None,
        typer.Option(help="Log beliefs, images and signals for Rerun, to this .rrd file.", rich_help_panel=OUTPUT),
    ] = None
    record: Annotated[
        bool,
        typer.Option(
            "--record", help="Keep the episode in a store, a recording for each action.", rich_help_panel=OUTPUT
        ),
    ] = False
    live: Annotated[
        bool,
        typer.Option(
            "--live",
            help="Keep the episode as --record does, and serve a page that shows each step as it is done.",
            rich_help_panel=OUTPUT,
        ),
    ] = False
    to: Annotated[
        str | None,
        typer.Option(
            "--to",
            metavar="URL",
            help="For --live: send the episode to this server, such as https://.../api/v1, in place of a store here.",
            rich_help_panel=OUTPUT,
        ),
    ] = None
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every decision on how an outcome was read.")
    ] = False

    @property
    def replay(self) -> bool:
        """Whether outcomes are replayed."""
        return self.robot is RobotKind.REPLAY

    @property
    def keeps(self) -> bool:
        """Whether the episode goes into a store here."""
        return self.record or (self.live and self.to is None)

    def load(self) -> Network:
        """The network asked for, else the one that suits the robot.

        Outcomes are simulated with household-filled, as three columns of a camera's table in household
        are empty and would tell nothing.
        """
        from palpate.network.reading import load_network

        return load_network(
            ("household" if self.replay else "household-filled") if self.network is None else self.network
        )
