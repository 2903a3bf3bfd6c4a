"""What the command line says about a spool."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from palpate.cli.terminal import console
from palpate.client import ReceiverError
from palpate.recording.outbox import Outbox
from palpate.recording.spool import Spool
from palpate.recording.uploading import Sent
from palpate.store.entries import FailedEntry
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import StoreError
from palpate.store.records import Recording
from palpate.wording import plural

__all__ = ["print_recovered", "print_sent", "print_sent_episodes", "print_spool"]


def print_spool(spool: Spool) -> None:
    """Print each recording of a spool with its state."""
    waiting, refused, unfinished = spool.waiting(), spool.refused(), spool.unfinished()
    counts = f"{len(waiting)} waiting, {len(refused)} refused, {len(unfinished)} not whole"
    out = console()
    out.print(f"{spool.folder}: {counts}", soft_wrap=True)
    for name in waiting:
        out.print(f"waiting  {name}  {_in_short(spool, name)}", soft_wrap=True)
    for name, reason in refused.items():
        out.print(f"refused  {name}  {reason}", soft_wrap=True)
    for name in Outbox(spool).waiting():
        out.print(f"waiting  exploration {name}, which no server has whole", soft_wrap=True)
    for name, is_running in unfinished.items():
        told = "is being recorded" if is_running else "was cut off: palpate spool recover"
        out.print(f"open     {name}  {told}", soft_wrap=True)


def print_recovered(recovered: Iterable[tuple[str, Recording | StoreError]]) -> None:
    """Print what became of each remainder."""
    out = console()
    count = 0
    for name, found in recovered:
        count += isinstance(found, Recording)
        told = f"recovered {_words(found)}" if isinstance(found, Recording) else f"left as it is: {found}"
        out.print(f"{name}  {told}", soft_wrap=True)
    out.print(f"{count} recovered", soft_wrap=True)


def print_sent(spool: Spool, sent: Iterable[Sent], place: str = "") -> bool:
    """Print what became of each recording, as it happens, and what to do about the rest; True where there is none.

    Parameters
    ----------
    place
        Where they are sent, as people read it.
    """
    out = console()
    arrived = 0
    for one in sent:
        arrived += one.state in ("sent", "known")
        out.print(f"{one.state:8} {one.name}  {one.reason}".rstrip(), soft_wrap=True)
    if arrived:
        out.print(f"{plural(arrived, 'recording')} in {place}", soft_wrap=True)
    waiting, refused = spool.waiting(), spool.refused()
    out.print(f"{len(waiting)} waiting, {len(refused)} refused", soft_wrap=True)
    if waiting:
        out.print(
            "What waits is still in the spool: palpate spool upload again, once the reason is gone.", soft_wrap=True
        )
    if refused:
        told = "see why with palpate spool list, and when that is mended: palpate spool upload --refused"
        out.print(f"What was refused is kept: {told}.", soft_wrap=True)
    return not (waiting or refused)


def print_sent_episodes(outbox: Outbox, put: Callable[[StoredEpisode], object], place: str) -> bool:
    """Send the explorations that wait, and print what became of each; True where none is left."""
    out = console()
    for name in outbox.waiting():
        with outbox.claimed(name) as is_mine:
            if not is_mine:
                out.print(f"waiting  exploration {name}  goes on, and sends its steps itself", soft_wrap=True)
                continue
            try:
                put(outbox.read(name))
            except (ReceiverError, StoreError) as error:
                out.print(f"waiting  exploration {name}  {' '.join(str(error).split())}", soft_wrap=True)
            else:
                outbox.remove(name)
                out.print(f"sent     exploration {name}  is in {place}", soft_wrap=True)
    return not outbox.waiting()


def _in_short(spool: Spool, name: str) -> str:
    try:
        return _words(spool.read(name))
    except StoreError as error:
        return f"damaged: {error}"


def _words(recording: Recording) -> str:
    told = [f"failed, {e.reason}" if isinstance(e, FailedEntry) else e.property for e in recording.entries]
    thing = recording.thing.common_name or recording.thing.id
    without = "signals" if recording.series else "no result"
    # a reason may hold line breaks
    return f"{recording.action} of {thing}: {' '.join(', '.join(told).split()) or without}"
