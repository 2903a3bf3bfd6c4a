"""`palpate spool`: what was recorded and is in no store yet."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from palpate.client import Receiver
    from palpate.recording.spool import Spool
    from palpate.store.episodes import StoredEpisode

__all__ = ["app"]

app = typer.Typer(help="List, recover and send what was recorded and is in no store yet.")

SERVER = re.compile(r"[\w.-]+:\d+(/.*)?|.*/api/v1/?")
"""What is meant as the address of a server, and lacks its beginning."""

Folder = Annotated[
    Path | None, typer.Option("--spool", metavar="FOLDER", help="The spool; unless given PALPATE_SPOOL, or the user's.")
]


@app.callback()
def spool() -> None:
    """List, recover and send what was recorded and is in no store yet."""


@app.command("list")
def list_(spool: Folder = None) -> None:
    """List the recordings that wait, those that a store refused, and those that are not whole."""
    from palpate.cli.spool_view import print_spool

    print_spool(_found(spool))


@app.command("recover")
def recover(spool: Folder = None) -> None:
    """Make what killed programs left behind recordings that wait, marked as failed."""
    from palpate.cli.spool_view import print_recovered

    print_recovered(_found(spool).recover())


@app.command("upload")
def upload(
    to: Annotated[
        str | None,
        typer.Option(
            "--to",
            metavar="PLACE",
            help="A store, or the address of a server; unless given PALPATE_STORE, or the user's.",
        ),
    ] = None,
    spool: Folder = None,
    refused: Annotated[bool, typer.Option("--refused", help="Send those again that were refused.")] = False,
    attempts: Annotated[int, typer.Option(min=1, help="How often to try before giving up.")] = 5,
) -> None:
    """Send what waits, recordings and then explorations; each leaves the spool when the receiver has acknowledged it.

    The exit code is 1 where something still waits or was refused.
    """
    from palpate.cli.spool_view import print_sent, print_sent_episodes
    from palpate.client import BackOff
    from palpate.recording.outbox import Outbox
    from palpate.recording.uploading import upload as send

    found = _found(spool)
    for name in found.refused() if refused else ():
        found.requeue(name)
    if not (found.waiting() or Outbox(found).waiting()):
        # a place that was mistyped gets neither a store nor a folder for nothing
        raise typer.Exit(0 if print_sent(found, ()) else 1)
    with _receiver(to) as (receiver, put_episode, place):
        is_empty = print_sent(found, send(found, receiver, back_off=BackOff(attempts=attempts)), place)
        # their recordings are there by now
        is_empty &= print_sent_episodes(Outbox(found), put_episode, place)
    raise typer.Exit(0 if is_empty else 1)


def _found(folder: Path | None) -> Spool:
    """The spool; one that was named must be there, and one's own is empty until something is recorded."""
    from palpate.errors import PalpateError
    from palpate.recording.spool import FOLDERS, Spool

    if folder is not None and not any((folder / name).is_dir() for name in FOLDERS):
        raise PalpateError(f"--spool: there is no spool at {folder}, expected a folder with recordings in 'waiting'")
    return Spool(folder)


@contextmanager
def _receiver(place: str | None) -> Iterator[tuple[Receiver, Callable[[StoredEpisode], object], str]]:
    """What takes recordings, what takes explorations, and where both are, for people to read."""
    if place is not None and place.lower().startswith(("http://", "https://")):
        from palpate.client import Client

        client = Client(place)
        yield client, client.put_episode, client.url
        return
    _check_store(place)
    from palpate.cli.storing import tell_made
    from palpate.store.keeping_episodes import put_episode
    from palpate.store.opening import open_store

    with open_store(place, made=tell_made) as store:
        yield store, partial(put_episode, store), repr(store.engine.url)


def _check_store(place: str | None) -> None:
    """Refuse the address of a server that would be the name of a new store here, where nobody looks for it."""
    if place is None or not SERVER.fullmatch(place) or Path(place).exists():
        return
    from palpate.errors import PalpateError

    raise PalpateError(
        f"--to {place!r}: is no store that there is; for a server expected http://{place}, or https://..."
    )
