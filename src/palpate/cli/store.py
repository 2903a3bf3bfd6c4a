"""`palpate store`: what is in a store, and whether it is whole; archives of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.export import export
from palpate.cli.store_options import BlobsOption, StoreOption
from palpate.cli.which import Which, selecting

__all__ = ["app"]

app = typer.Typer(help="Show, list, verify, repair, export or import measurements.")

HOW = "How they are listed"


@app.callback()
def store() -> None:
    """Show, list, verify, repair, export or import measurements."""
    from palpate.cli.storing import check_installed

    check_installed()


@app.command("show")
def show(
    key: Annotated[
        str | None, typer.Argument(metavar="[RECORDING]", help="Id or digest of one recording, to show it whole.")
    ] = None,
    place: StoreOption = None,
    blobs: BlobsOption = None,
) -> None:
    """Show objects, setups and the last recordings with what was odd about them; or one recording."""
    from palpate.cli.store_view import overview, recording_view
    from palpate.cli.storing import found_recording, opened
    from palpate.cli.terminal import console

    with opened(place, blobs) as found:
        console().print(overview(found) if key is None else recording_view(found_recording(found, key)))


@app.command("list")
@selecting
def list_(
    which: Which,
    sort: Annotated[str, typer.Option(help="recorded, uploaded or action.", rich_help_panel=HOW)] = "recorded",
    ascending: Annotated[bool, typer.Option("--ascending", help="The first first.", rich_help_panel=HOW)] = False,
    limit: Annotated[int, typer.Option(min=1, max=10_000, help="Rows of a page.", rich_help_panel=HOW)] = 50,
    cursor: Annotated[str | None, typer.Option(help="What the page before ended with.", rich_help_panel=HOW)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.", rich_help_panel=HOW)] = False,
    place: StoreOption = None,
    blobs: BlobsOption = None,
) -> None:
    """List recordings, the last ones first."""
    from palpate.cli.store_view import page_json, page_table
    from palpate.cli.storing import opened
    from palpate.cli.terminal import console
    from palpate.store.filters import Sort
    from palpate.store.listing import list_recordings

    with opened(place, blobs) as found:
        page = list_recordings(found, which.filter(), Sort(sort, not ascending), limit=limit, cursor=cursor)
    if as_json:
        print(page_json(page))
        return
    console().print(page_table(page))
    if page.cursor is not None:
        print(f"more: --cursor {page.cursor}")


@app.command("verify")
def verify(place: StoreOption = None, blobs: BlobsOption = None) -> None:
    """Check every digest and every reference; exit with code 1 where something is not as it was written."""
    from palpate.cli.storing import opened, tell_faults
    from palpate.store.verifying import verify as faults_of

    with opened(place, blobs) as found:
        faults = tell_faults(faults_of(found))
    raise typer.Exit(1 if faults else 0)


@app.command("repair")
def repair(place: StoreOption = None, blobs: BlobsOption = None) -> None:
    """Verify, and take only steps that cannot lose anything; exit with code 1 where something could not be mended."""
    from palpate.cli.storing import opened, tell_faults
    from palpate.store.verifying import repair as mend

    with opened(place, blobs) as found:
        faults = mend(found)
    tell_faults(faults)
    raise typer.Exit(1 if any(fault.remedy is None for fault in faults) else 0)


app.command("export")(export)


@app.command("import")
def import_(
    paths: Annotated[
        list[Path], typer.Argument(metavar="PATH...", help="Archives, upload dictionaries, or folders of them.")
    ],
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every decision on how a file was read.")
    ] = False,
    place: StoreOption = None,
    blobs: BlobsOption = None,
) -> None:
    """Put archives or upload dictionaries into the store; what is there already stays as it is."""
    from palpate.cli.storing import check_there, import_path, opened

    check_there(paths)
    with opened(place, blobs) as found:
        refused = sum(import_path(found, path, verbose=verbose) for path in paths)
    raise typer.Exit(1 if refused else 0)
