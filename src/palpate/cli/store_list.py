"""`palpate store list`, `table`, `curves` and `devices`: what was measured, in rows."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.cli.rows import Form
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place, Which, WideOption

if TYPE_CHECKING:
    from palpate.store.filters import Filter, Sort
    from palpate.store.store import Store

__all__ = ["curves", "devices", "list_", "table"]

HOW = "How they are listed"
PAGE = 50

FormOption = Annotated[
    Form | None, typer.Option("--format", help="What is printed or written (default: table).", rich_help_panel=HOW)
]
JsonOption = Annotated[bool, typer.Option("--json", help="The same as --format json.", rich_help_panel=HOW)]
OutputOption = Annotated[Path | None, typer.Option("--output", "-o", help="The file to write.", rich_help_panel=HOW)]


@dataclass(frozen=True)
class Written:
    """In which form rows are given, and where."""

    form: FormOption = None
    as_json: JsonOption = False
    output: OutputOption = None

    @property
    def chosen(self) -> Form:
        """The form, once it is found to fit the file."""
        from palpate.cli.rows import check_output
        from palpate.errors import PalpateError

        if self.as_json and self.form not in (None, Form.JSON):
            raise PalpateError(
                f"--json: is --format json, and --format {self.form.value} was found; expected one of them"
            )
        form = Form.JSON if self.as_json else self.form or Form.TABLE
        check_output(form, self.output)
        return form


@dataclass(frozen=True)
class How:
    """How recordings are listed."""

    sort: Annotated[str, typer.Option(help="recorded, uploaded or action.", rich_help_panel=HOW)] = "recorded"
    ascending: Annotated[bool, typer.Option("--ascending", help="The first first.", rich_help_panel=HOW)] = False
    limit: Annotated[
        int | None,
        typer.Option(min=1, help="Recordings of a page (default: 50; all as CSV or Parquet).", rich_help_panel=HOW),
    ] = None
    cursor: Annotated[str | None, typer.Option(help="What the page before ended with.", rich_help_panel=HOW)] = None
    wide: WideOption = False


@spread
def list_(which: Which, how: How, written: Written, place: Place) -> None:
    """List recordings, the last ones first; as CSV or Parquet the results, a row for each."""
    from palpate.cli.rows import write_text
    from palpate.cli.store_view import page_json, page_table, tell_next
    from palpate.cli.storing import LeftOut, check_known, check_name
    from palpate.cli.terminal import is_terminal, print_whole
    from palpate.errors import PalpateError
    from palpate.store.filters import SORTS, Filter, Sort
    from palpate.store.listing import list_recordings

    check_name("--sort", how.sort, SORTS)
    form, sort = written.chosen, Sort(how.sort, not how.ascending)
    if form.is_flat and how.cursor is not None:
        raise PalpateError("--cursor: is for pages, and CSV and Parquet have none; expected --format table or json")
    with place.opened() as store:
        wanted = which.filter(store)
        if form.is_flat:
            _write_results(store, wanted, sort, how.limit, form, written.output)
            return
        left, limit = LeftOut(), how.limit or PAGE
        page = list_recordings(store, wanted, sort, limit=limit, cursor=how.cursor, damaged=left.damaged.append)
        if not (page.rows or left.damaged):
            check_known(store, wanted)
    if form is Form.JSON:
        write_text(page_json(page), written.output)
    elif page.rows or left.damaged:
        print_whole(page_table(page, whole=how.wide or not is_terminal()))
        tell_next(page.cursor)
    else:
        print("no recording matches" if wanted != Filter() else "no recordings yet")
    left.tell()


def _write_results(
    store: Store, wanted: Filter, sort: Sort, limit: int | None, form: Form, output: Path | None
) -> None:
    """Write the results of recordings, and tell which are left out as they are damaged."""
    from palpate.cli.rows import write_rows
    from palpate.cli.storing import LeftOut, check_known
    from palpate.store.entries_table import entries_table

    left = LeftOut()
    results = entries_table(store, wanted, sort, limit=limit, damaged=left.damaged.append)
    if not (results.num_rows or left.damaged):
        check_known(store, wanted)
    write_rows(results, form, output)
    left.tell()


@spread
def table(written: Written, place: Place) -> None:
    """Print objects x properties: mean and SD of what was measured, how often, and how far devices differ."""
    from palpate.cli.cells_view import cells_table
    from palpate.cli.rows import write_rows, write_text
    from palpate.cli.terminal import print_whole
    from palpate.store.summary import cells_to_arrow, objects_by_properties

    form = written.chosen
    with place.opened() as store:
        cells = objects_by_properties(store)
    if form.is_flat:
        write_rows(cells_to_arrow(cells), form, written.output)
    elif form is Form.JSON:
        write_text(json.dumps([vars(cell) for cell in cells], indent=1), written.output)
    else:
        print_whole(cells_table(cells) if cells else "no measured values yet")


@spread
def curves(
    gripper: Annotated[str, typer.Option("--gripper", help="Gripper of the setup.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The file to write: .npz or .parquet.")],
    place: Place,
    action: Annotated[str | None, typer.Option("--action", help="Only recordings of this action.")] = None,
) -> None:
    """Write all curves recorded with a gripper to a file."""
    from palpate.cli.files import check_writable, replacing
    from palpate.cli.storing import check_known
    from palpate.store.curve_files import check_curve_file, write_curves
    from palpate.store.filters import Filter
    from palpate.wording import plural

    check_curve_file("--output", output)
    check_writable("--output", output)
    with place.opened() as store, replacing(output) as draft:
        count = write_curves(store, gripper, draft, action=action)
        if not count:
            check_known(store, Filter(gripper=gripper, action=action))
    print(f"{output}: {plural(count, 'channel')}")


@spread
def devices(
    place: Place,
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="Only devices of this name.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List devices, each with its calibrations in the order of their dates."""
    from palpate.cli.cells_view import devices_table
    from palpate.cli.storing import check_known
    from palpate.cli.terminal import print_whole
    from palpate.store.calibrations import devices_of
    from palpate.store.filters import Filter

    with place.opened() as store:
        found = devices_of(store, name)
        if name is not None and not found:
            check_known(store, Filter(device=name), {"device": "NAME"})
    if as_json:
        print(json.dumps([{**vars(one.device), "recordings": one.recordings} for one in found], indent=1))
    else:
        print_whole(devices_table(found) if found else "no devices yet")
