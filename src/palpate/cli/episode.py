"""`palpate episode`: what can be done with the log of an exploration, and recordings made into one to replay."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(help="Draw the log of an exploration, or make recordings a session to replay.")


@app.callback()
def episode() -> None:
    """Draw the log of an exploration, or make recordings a session to replay."""


@app.command("plot")
def plot(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="What palpate explore --log wrote.")],
    picture: Annotated[Path, typer.Argument(metavar="PICTURE", help="The file to draw: .png, .svg or .pdf.")],
) -> None:
    """Draw an episode from its log: gains over the steps, actions taken, belief before and after."""
    from palpate.cli.files import check_picture, replacing
    from palpate.episode import read_episode
    from palpate.figures.episode import draw_episode

    check_picture("PICTURE", picture)
    found = read_episode(log)
    with replacing(picture) as draft:
        draw_episode(found, draft)


@app.command("convert")
def convert(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE...", help="Upload dictionaries of one object, or folders of them.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The session file to write.")],
    network: Annotated[str, typer.Option(help="Name of a shipped network, or a TOML file.")] = "household",
    source: Annotated[
        str, typer.Option(help="Where the recordings are from, for people to read.")
    ] = "upload dictionaries",
    labels: Annotated[
        bool, typer.Option("--labels", help="Take a classifier's most probable label, not its probabilities.")
    ] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every decision on how a recording was read.")
    ] = False,
) -> None:
    """Make the upload dictionaries of one object a session, which palpate explore --robot replay replays."""
    from palpate.cli.files import check_writable
    from palpate.network.reading import load_network
    from palpate.robots.session import write_session
    from palpate.robots.upload_dictionary import convert as read
    from palpate.wording import outcome_words, plural

    check_writable("--output", output)
    session = read(files, load_network(network), source=source, labels=labels)
    write_session(session, output)
    print(f"{output}: {plural(len(session.recordings), 'recording')} of {session.object}")
    for recording in session.recordings:
        print(f"  {recording.action}: {outcome_words(recording.outcome)}")
    if not verbose:
        print(f"{plural(len(session.all_decisions), 'note')} on how they were read (--verbose)")
    for decision in session.all_decisions if verbose else ():
        print(f"note: {decision}")
