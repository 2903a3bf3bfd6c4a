"""`palpate explore --live`: the page that shows an exploration as it goes on, and what did not get to a server."""

from __future__ import annotations

import logging
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING
from uuid import UUID

from palpate.wording import plural

if TYPE_CHECKING:
    from palpate.cli.asked import Asked
    from palpate.cli.store_options import Place
    from palpate.episode.posting import PostedEpisode
    from palpate.recording.posting import Left
    from palpate.recording.spool import Spool

__all__ = ["LIVE_TIMEOUT_S", "begun", "page_of", "showing", "tell_left", "told_once"]

LIVE_TIMEOUT_S = 10.0
"""After it a server that does not answer is asked again."""
BEGIN_S = 1.0
"""In which a server takes an exploration, or the command goes on and says that it has not."""
GRACE_S = 2.0
"""In which those who watch get the last step."""
SERVICE = "/api/v1"


@contextmanager
def showing(asked: Asked, place: Place) -> Iterator[Callable[[UUID], str]]:
    """Serve the store while the block runs, where that was asked for; what it gives makes the address of an episode.

    In a terminal the page stays until Ctrl-C, as somebody may still look at it.
    """
    if not asked.live:
        yield str
        return
    from palpate.cli.serve import check_installed
    from palpate.server.beside import beside

    check_installed()
    with beside(place.place, place.blobs) as address:
        yield lambda id: f"{address}&episode={id}"
        if sys.stdout.isatty():
            print("The page stays until Ctrl-C.", flush=True)
            _until_interrupted()
        else:
            time.sleep(GRACE_S)


def _until_interrupted() -> None:
    try:
        while True:
            time.sleep(3600.0)
    except KeyboardInterrupt:
        print()


def page_of(url: str, id: UUID) -> str:
    """The address for people of an episode on a server.

    Examples
    --------
    >>> page_of("https://touch.example.org/api/v1", UUID(int=7))
    'https://touch.example.org/episodes/00000000-0000-0000-0000-000000000007'
    """
    return f"{url.removesuffix(SERVICE)}/episodes/{id}"


def begun(episode: PostedEpisode, url: str, spool: Spool) -> str:
    """Where an exploration can be watched; or why it cannot yet, and where it is kept meanwhile."""
    left = episode.begun(BEGIN_S)
    if left is None:
        return f"sent as episode {episode.id}; watch it at {page_of(url, episode.id)}"
    return f"kept as episode {episode.id} in {spool.folder}; {url} has not taken it: {left.reason}"


@contextmanager
def told_once() -> Iterator[None]:
    """Keep from the log, while the block runs, what is told here: why a server takes no more of an exploration."""
    log = logging.getLogger("palpate.recording")
    log.addFilter(_not_of_posting)
    try:
        yield
    finally:
        log.removeFilter(_not_of_posting)


def _not_of_posting(record: logging.LogRecord) -> bool:
    return record.module != "posting"


def tell_left(left: Left | None, url: str, spool: Spool) -> None:
    """Say what a server does not have, why, and how to send it; nothing where it has all."""
    if left is not None:
        lines = f"{plural(left.lines, 'line')} of the episode" if left.lines else "the episode"
        print(
            f"palpate: {lines} did not get to {url}: {left.reason}\n"
            f"palpate: all of it is kept in {spool.folder}; to send it: palpate spool upload --to {url}",
            file=sys.stderr,
        )
