"""An import in the terminal: a bar while it runs, and what became of everything."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli.progress_view import timed
from palpate.cli.terminal import error_console
from palpate.store.importing.items import Fate
from palpate.wording import plural

if TYPE_CHECKING:
    from palpate.store.importing.items import Outcome
    from palpate.store.importing.report import Report

__all__ = ["bar", "outcome_lines", "report_lines"]

SHOWN = 50
"""Refused or skipped files that are named; a report as a file has them all."""


@contextmanager
def bar(counted: Callable[[], int]) -> Iterator[Callable[[], None]]:
    """A bar with the time left on standard error; it gives what to call for each step.

    Parameters
    ----------
    counted
        Counts the steps; asked only where there is a bar to show.
    """
    screen = error_console()
    # what is printed in the same terminal goes above the bar, and what goes to a file goes there
    with timed(screen, redirect_stdout=sys.stdout.isatty()) as progress:
        task = progress.add_task("Importing", total=None)
        if screen.is_terminal:
            progress.update(task, total=counted())
        yield lambda: progress.advance(task)


def outcome_lines(outcome: Outcome) -> Iterator[str]:
    """The decisions on how a file was read."""
    for notice in () if outcome.recording is None else outcome.recording.notices:
        # of a single file, a notice may begin with the name of it
        yield _printable(f"{outcome.source}: {notice.removeprefix(f'{Path(outcome.source).name} ')}")


def report_lines(report: Report) -> Iterator[str]:
    """Each file that was refused or skipped, with the reason, and the counts."""
    for fate in (Fate.REFUSED, Fate.SKIPPED):
        left = [one for one in report.left if one.fate is fate]
        yield from (_printable(f"{fate.value}: {one.source}: {one.reason}") for one in left[:SHOWN])
        if len(left) > SHOWN:
            yield f"{fate.value}: {plural(len(left) - SHOWN, 'more file')}, named in a file by --report FILE"
    told = report.implausible
    yield from (_printable(f"cannot be true: {source}: {notice}") for source, notice in told[:SHOWN])
    if len(told) > SHOWN:
        yield f"cannot be true: {plural(len(told) - SHOWN, 'more result')}, named in a file by --report FILE"
    yield counts_line(report)


def counts_line(report: Report) -> str:
    """How many have met each fate; mended ones only where there are some."""
    words = {Fate.NEW: "new", Fate.KNOWN: "there already", Fate.REFUSED: "refused", Fate.SKIPPED: "skipped"}
    if report.count(Fate.MENDED):
        words = {Fate.MENDED: "mended", **words}
    return ", ".join(f"{report.count(fate)} {word}" for fate, word in words.items())


def _printable(text: str) -> str:
    """One line, whatever files are called."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)
