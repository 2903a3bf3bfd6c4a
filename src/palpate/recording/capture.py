"""What a measurement prints and logs, heard without standing in the way of anything.

While a listener is there, `sys.stdout` is a `Tee`, and the factory of log records tells the
listener of each new one. Handlers are left alone: a handler of its own on the root logger would
silence `logging.lastResort` and turn a later `logging.basicConfig` into nothing. Both are put back
when the last listener goes. Who listens is a context variable, so that threads and tasks that
measure at the same time hear only themselves.
"""

from __future__ import annotations

import logging
import os
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any, TextIO, cast

__all__ = ["hearing"]

Hear = Callable[[str], None]


@dataclass(frozen=True, eq=False)
class Listener:
    """Who hears what the current context writes, and whom it is inside of."""

    hear: Hear
    outer: Listener | None
    process: int


_listener: ContextVar[Listener | None] = ContextVar("palpate_listener", default=None)


@contextmanager
def hearing(hear: Hear) -> Iterator[None]:
    """Call `hear` with all that this context prints or logs in the block; outer blocks hear it too."""
    token = _listener.set(Listener(hear, _listener.get(), os.getpid()))
    _TAPS.open()
    try:
        yield
    finally:
        _TAPS.close()
        _listener.reset(token)


def _tell(text: str) -> None:
    listener, here = _listener.get(), os.getpid()
    while listener is not None:
        # a forked child has its parent's context, and must not write to its parent's files
        if listener.process == here:
            listener.hear(text)
        listener = listener.outer


class Tee:
    """Standard output that also tells the listener; in all else it is the stream behind it."""

    def __init__(self, behind: TextIO) -> None:
        self.behind = behind

    def write(self, text: str, /) -> int:
        """Write to the stream behind, then tell the listener."""
        written = self.behind.write(text)
        _tell(text)
        return written

    def writelines(self, lines: Iterable[str], /) -> None:
        """Write each of the lines."""
        for line in lines:
            self.write(line)

    def close(self) -> None:
        """Leave the stream behind open: it belongs to others."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self.behind, name)


class _Taps:
    """The places where output is heard: put in for the first listener, taken out after the last."""

    def __init__(self) -> None:
        self._guard = threading.Lock()
        self._count = 0
        self._factory: Callable[..., logging.LogRecord] | None = None
        self._telling: Callable[..., logging.LogRecord] | None = None

    def open(self) -> None:
        with self._guard:
            self._count += 1
            # someone else may have replaced standard output since the first listener came
            if sys.stdout is not None and not isinstance(sys.stdout, Tee):
                sys.stdout = cast("TextIO", Tee(sys.stdout))
            if self._telling is None:
                self._factory = logging.getLogRecordFactory()
                self._telling = _telling(self._factory)
                logging.setLogRecordFactory(self._telling)

    def close(self) -> None:
        with self._guard:
            self._count -= 1
            if self._count:
                return
            # what others have put there since is theirs, and stays
            while isinstance(sys.stdout, Tee):
                sys.stdout = sys.stdout.behind
            if self._factory is not None and logging.getLogRecordFactory() is self._telling:
                logging.setLogRecordFactory(self._factory)
            self._factory = self._telling = None


_TAPS = _Taps()
_FORM = logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s")


def _telling(factory: Callable[..., logging.LogRecord]) -> Callable[..., logging.LogRecord]:
    def tell(*args: Any, **kwargs: Any) -> logging.LogRecord:
        record = factory(*args, **kwargs)
        if _listener.get() is not None:
            _tell(_line(record))
        return record

    return tell


def _line(record: logging.LogRecord) -> str:
    try:
        text = _FORM.format(record)
    except Exception:
        # logging itself reports arguments that do not fit; the measurement must not fail by them
        text = f"{record.levelname} {record.name}: {record.msg} {record.args}"
    return text + "\n"
