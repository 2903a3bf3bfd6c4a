"""The commands by their names; what a command needs is imported when it runs."""

from __future__ import annotations

from typing import Annotated

import typer

from palpate.cli import benchmark, calibrate, episode, explore, infer, network, reproduce, serve, spool, store, user

__all__ = ["app"]

app = typer.Typer(
    name="palpate",
    help="Learn the physical properties of an object by choosing which measurement to make next.",
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.command("benchmark")(benchmark.benchmark)
app.command("calibrate")(calibrate.calibrate)
app.command("explore")(explore.explore)
app.command("infer")(infer.infer)
app.command("reproduce")(reproduce.reproduce)
app.command("serve")(serve.serve)
app.add_typer(network.app, name="network")
app.add_typer(episode.app, name="episode")
app.add_typer(spool.app, name="spool")
app.add_typer(store.app, name="store")
app.add_typer(user.app, name="user")


@app.callback(invoke_without_command=True)
def palpate(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    """Learn the physical properties of an object by choosing which measurement to make next."""
    if version:
        from palpate import __version__

        print(__version__)
    elif context.invoked_subcommand is None:
        print(context.get_help())
