"""Recordings that end while something runs, told to whoever asked for the action: an exploration, for one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from palpate.recording.spool import Spool
from palpate.store.records import Recording

__all__ = ["Finished", "finished_recordings", "tell_finished"]

_watching: ContextVar[list[Finished] | None] = ContextVar("palpate_watching", default=None)


@dataclass(frozen=True, eq=False)
class Finished:
    """A recording that is whole, and where it waits."""

    spool: Spool
    name: str
    recording: Recording


@contextmanager
def finished_recordings() -> Iterator[list[Finished]]:
    """Give a list that holds each recording that has ended in this context since the block began, the last one last."""
    found: list[Finished] = []
    token = _watching.set(found)
    try:
        yield found
    finally:
        _watching.reset(token)


def tell_finished(finished: Finished) -> None:
    """Tell of a recording that has ended."""
    found = _watching.get()
    if found is not None:
        found.append(finished)
