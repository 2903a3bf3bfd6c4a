"""Importing files: what `palpate store import` does, apart from its options."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli.fruitless import Fruitless
from palpate.cli.import_view import bar, counts_line, outcome_lines, report_lines
from palpate.cli.terminal import console
from palpate.errors import PalpateError

if TYPE_CHECKING:
    from palpate.store.importing.items import Format
    from palpate.store.importing.report import Report
    from palpate.store.importing.zips import Zips
    from palpate.store.store import Store

__all__ = ["check_paths", "formats_of", "import_shown"]


def check_paths(paths: Sequence[Path], report: Path | None) -> None:
    """Find out before anything is imported whether all paths exist, and whether the report can be written."""
    if not paths:
        raise PalpateError("store import: nothing to import, expected files or folders, or --example")
    for path in paths:
        if not path.exists():
            raise PalpateError(f"{path}: no such file or folder, expected what is to be imported")
    if report is not None and report.is_dir():
        raise PalpateError(f"{report}: is a folder, expected the name of a file for the report")
    if report is not None and not report.absolute().parent.is_dir():
        raise PalpateError(f"{report}: there is no folder {report.absolute().parent}, expected one for the report")


def formats_of(columns: Path | None, topics: Path | None) -> Sequence[Format]:
    """All formats, with what the options say about some of them."""
    from palpate.store.importing.bags.reading_topics import read_topic_map
    from palpate.store.importing.formats import all_formats
    from palpate.store.importing.reading_columns import read_columns

    return all_formats(
        None if columns is None else read_columns(columns), None if topics is None else read_topic_map(topics)
    )


def import_shown(
    store: Store, paths: Sequence[Path], formats: Sequence[Format], *, report_file: Path | None, verbose: bool
) -> bool:
    """Import, show how far it is, tell what was refused and skipped, and write the report where one is asked for.

    Returns
    -------
    bool
        Whether nothing was refused, and something came of each path: one that was named was meant.
    """
    from palpate.store.importing.items import Fate
    from palpate.store.importing.report import Report
    from palpate.store.importing.zips import Zips

    report, fruitless = Report(), Fruitless(paths)
    with Zips() as zips:
        try:
            _import(store, paths, formats, zips, report, fruitless, verbose=verbose)
            report.complete = True
        finally:
            if not report.complete:
                counts = counts_line(report)
                print(
                    f"broken off after {counts}: what is new stays, and the same command goes on from there",
                    file=sys.stderr,
                )
            if report_file is not None:
                report_file.write_text(json.dumps(report.plain(), indent=1) + "\n", encoding="utf-8")
        for line in report_lines(report):
            console().out(line)
        left = fruitless.without_more(formats, zips)
    if left:
        more = f" and {len(left) - 1} more of the paths" if len(left) > 1 else ""
        print(f"palpate: nothing came of {left[0]}{more}, expected what can be imported", file=sys.stderr)
    return not (left or report.count(Fate.REFUSED))


def _import(
    store: Store,
    paths: Sequence[Path],
    formats: Sequence[Format],
    zips: Zips,
    report: Report,
    fruitless: Fruitless,
    *,
    verbose: bool,
) -> None:
    from palpate.store.importing.finding import count_items
    from palpate.store.importing.intake import import_paths

    with bar(lambda: count_items(paths, formats, zips)) as step:
        for outcome in import_paths(store, paths, formats, zips=zips):
            report.add(outcome)
            fruitless.strike(outcome)
            step()
            for line in outcome_lines(outcome) if verbose else ():
                console().out(line)
