"""Time stamps of messages, and what is odd about those of a topic."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.store.importing.bags.fields import MISSING, member

__all__ = ["oddities", "order_of", "seconds", "stamp_of"]

GAP = 5
"""A gap is longer than so many usual intervals."""

FEWEST = 10
"""Intervals below which none of them is usual."""

APART_NS = 60_000_000_000
"""Two clocks that are further apart are not the same one."""

NS = 1_000_000_000


def stamp_of(message: Any) -> int | None:
    """The time in a message's header, or in its own stamp [ns]; None where there is none, 0 where it was not set."""
    header = member(message, "header")
    for holder, name in ((header, "stamp"), (message, "stamp"), (message, "timestamp")):
        stamp = member(holder, name)
        if stamp is MISSING:
            continue
        for parts in (("sec", "nanosec"), ("sec", "nsec"), ("secs", "nsecs")):
            whole, fraction = (member(stamp, part) for part in parts)
            if isinstance(whole, int) and isinstance(fraction, int):
                return whole * NS + fraction
    return None


def seconds(stamps_ns: NDArray[np.int64], start_ns: int) -> NDArray[np.float64]:
    """Seconds since a start; times are subtracted as integers, so that nanoseconds are not lost."""
    return (stamps_ns - start_ns) / NS


def order_of(logged_ns: NDArray[np.int64]) -> NDArray[np.intp]:
    """The order in which messages were written; those of one time stay in the order in which they were read."""
    return np.argsort(logged_ns, kind="stable")


def oddities(topic: str, stamps_ns: NDArray[np.int64], logged_ns: NDArray[np.int64], start_ns: int) -> Iterator[str]:
    """Tell what is odd about the times of the messages of a topic, in the order of the bag."""
    steps = np.diff(stamps_ns)
    if backwards := int((steps < 0).sum()):
        is_before = "time stamp is before the one ahead of it", "time stamps are before the one ahead of them"
        yield f"{topic}: {backwards} {is_before[backwards > 1]}: the bag's order is kept"
    if again := int((steps == 0).sum()):
        is_same = "time stamp is the same as the one ahead of it", "time stamps are the same as the one ahead of them"
        yield f"{topic}: {again} {is_same[again > 1]}"
    forward = steps[steps > 0]
    if len(forward) >= FEWEST:
        usual = float(np.median(forward))
        gaps = np.flatnonzero(steps > GAP * usual)
        if len(gaps):
            longest = int(gaps[np.argmax(steps[gaps])])
            when, how_long = seconds(stamps_ns[longest : longest + 1], start_ns)[0], steps[longest] / NS
            found = f"{len(gaps)} gap{'s' * (len(gaps) > 1)}, the longest of {how_long:.4g} s at {when:.4g} s"
            yield f"{topic}: {found}, where {usual / NS:.4g} s are usual"
    apart_ns = float(np.median(stamps_ns - logged_ns)) if len(stamps_ns) else 0.0
    if abs(apart_ns) > APART_NS:
        found = f"the stamps are {apart_ns / NS:.4g} s apart from when the messages were written"
        yield f"{topic}: {found}: they are of another clock and are kept as they are"
