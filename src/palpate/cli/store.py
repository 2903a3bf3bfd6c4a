"""`palpate store`: what is in a store, and whether it is whole; archives of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(help="Show, list, verify, repair, export or import measurements.")

StoreOption = Annotated[
    str | None,
    typer.Option("--store", help="SQLite file or postgresql+psycopg://... (default: PALPATE_STORE, or your own)."),
]
BlobsOption = Annotated[
    str | None,
    typer.Option("--blobs", help="Folder or s3://... for large bytes (default: PALPATE_BLOBS, or beside the file)."),
]
WHICH, HOW = "Which recordings", "How they are listed"


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
def list_(
    thing: Annotated[
        str | None, typer.Option("--object", help="Name, common name or alias.", rich_help_panel=WHICH)
    ] = None,
    dataset: Annotated[str | None, typer.Option(help="Dataset of the object.", rich_help_panel=WHICH)] = None,
    action: Annotated[str | None, typer.Option(help="What the robot did.", rich_help_panel=WHICH)] = None,
    property_: Annotated[
        str | None, typer.Option("--property", help="What there is a result of.", rich_help_panel=WHICH)
    ] = None,
    label: Annotated[
        list[str] | None,
        typer.Option(help="PROPERTY=LABEL, the most probable one; may be repeated.", rich_help_panel=WHICH),
    ] = None,
    device: Annotated[str | None, typer.Option(help="Any device of the setup.", rich_help_panel=WHICH)] = None,
    gripper: Annotated[str | None, typer.Option(help="Gripper of the setup.", rich_help_panel=WHICH)] = None,
    setup: Annotated[str | None, typer.Option(help="Digest of the setup.", rich_help_panel=WHICH)] = None,
    owner: Annotated[str | None, typer.Option(help="Whose they are.", rich_help_panel=WHICH)] = None,
    since: Annotated[str | None, typer.Option(help="Recorded at this time or later.", rich_help_panel=WHICH)] = None,
    until: Annotated[str | None, typer.Option(help="Recorded before this time.", rich_help_panel=WHICH)] = None,
    truth: Annotated[
        bool | None,
        typer.Option("--ground-truth/--no-ground-truth", help="Known to be true, or not.", rich_help_panel=WHICH),
    ] = None,
    text: Annotated[str | None, typer.Option(help="Part of a name or notice.", rich_help_panel=WHICH)] = None,
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
    from palpate.cli.storing import labels_of, moment_of, opened
    from palpate.cli.terminal import console
    from palpate.store.filters import Filter, Sort
    from palpate.store.listing import list_recordings

    wanted = Filter(
        thing=thing,
        dataset=dataset,
        action=action,
        owner=owner,
        property=property_,
        labels=labels_of(label or []),
        device=device,
        gripper=gripper,
        setup=setup,
        since=moment_of("--since", since),
        until=moment_of("--until", until),
        ground_truth=truth,
        text=text,
    )
    with opened(place, blobs) as found:
        page = list_recordings(found, wanted, Sort(sort, not ascending), limit=limit, cursor=cursor)
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


@app.command("export")
def export(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder to make.")],
    place: StoreOption = None,
    blobs: BlobsOption = None,
) -> None:
    """Write all recordings as an archive: Parquet, blobs, and a manifest with digests."""
    from palpate.cli.storing import opened
    from palpate.figures.wording import plural
    from palpate.store.archive import export_archive

    with opened(place, blobs) as found:
        count = export_archive(found, folder)
    print(f"{folder}: {plural(count, 'recording')}")


@app.command("import")
def import_(
    paths: Annotated[list[Path] | None, typer.Argument(metavar="[PATH]...", help="Files, or folders of them.")] = None,
    example: Annotated[bool, typer.Option("--example", help="Import the example that the package ships.")] = False,
    columns: Annotated[
        Path | None, typer.Option(help="What the columns of CSV files mean, in TOML; without it they are skipped.")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write what became of everything to this file as JSON.")] = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every decision on how a file was read.")
    ] = False,
    place: StoreOption = None,
    blobs: BlobsOption = None,
) -> None:
    """Put recordings from files into the store; what is there already stays as it is."""
    from palpate.cli.importing import check_paths, formats_of, import_shown
    from palpate.cli.storing import opened
    from palpate.store.importing.items import Fate
    from palpate.store.importing.own_formats import EXAMPLE

    wanted = [*(paths or ()), *([EXAMPLE] if example else [])]
    check_paths(wanted, report)
    formats = formats_of(columns)
    with opened(place, blobs) as found:
        done = import_shown(found, wanted, formats, report_file=report, verbose=verbose)
    raise typer.Exit(1 if done.count(Fate.REFUSED) else 0)
