"""What is wrong with a store, in the terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from palpate.store.faults import Fault, Remedy
from palpate.wording import plural

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["tell_found", "tell_mended"]

SHOWN = 5
"""Faults that are alike and are told; the others are counted."""
BACK = "missing blobs come back when their recordings are imported again, or from a copy of the blobs"


def tell_found(faults: Iterable[Fault]) -> Sequence[Fault]:
    """Print what verification finds as it comes, and what can be done about it."""
    told = _told(faults, lambda fault: f"{fault.where}: {fault.what}")
    if not told:
        print("all is as it was written")
        return told
    steps = Counter(fault.remedy for fault in told)
    able = [f"mends {steps[Remedy.REINDEX] + steps[Remedy.REMOVE]}", f"sets {steps[Remedy.SET_ASIDE]} aside"]
    able = [one for one in able if " 0" not in one]
    print(plural(len(told), "fault") + (f"; palpate store repair {' and '.join(able)}" if able else ""))
    _tell_way_back(told)
    return told


def tell_mended(faults: Iterable[Fault]) -> Sequence[Fault]:
    """Print what was found, what was done about it, and how much is left."""
    told = _told(faults, _line)
    if not told:
        print("all is as it was written")
        return told
    aside = sum(fault.done and not fault.mended for fault in told)
    mended = sum(fault.mended for fault in told)
    counts = {"mended": mended, "set aside": aside, "left": len(told) - mended - aside}
    print(f"{plural(len(told), 'fault')}: {', '.join(f'{count} {what}' for what, count in counts.items() if count)}")
    _tell_way_back(told)
    return told


def _line(fault: Fault) -> str:
    done = fault.remedy.after if fault.done and fault.remedy is not None else "left as it is"
    return f"{fault.where}: {fault.what}: {done}"


def _told(faults: Iterable[Fault], line: Callable[[Fault], str]) -> list[Fault]:
    told, alike = list[Fault](), Counter[tuple[str, str]]()
    for fault in faults:
        told.append(fault)
        key = _key(fault)
        alike[key] += 1
        if alike[key] <= SHOWN:
            print(_printable(line(fault)))
    for more in _more(alike):
        print(_printable(more))
    return told


def _more(alike: Counter[tuple[str, str]]) -> Iterator[str]:
    for (kind, what), count in alike.items():
        if count > SHOWN:
            yield f"and {count - SHOWN} more of {kind}: {what}"


def _key(fault: Fault) -> tuple[str, str]:
    # a blob is told with what needs it
    return fault.where.partition(" ")[0], fault.what.partition("; ")[0]


def _tell_way_back(faults: Sequence[Fault]) -> None:
    if any(fault.where.startswith("blob ") and fault.remedy is not Remedy.REMOVE for fault in faults):
        print(BACK)


def _printable(text: str) -> str:
    """One line, whatever stood in a damaged store."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)
