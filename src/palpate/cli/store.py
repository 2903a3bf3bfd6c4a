"""`palpate store`: what is in a store, and whether it is whole; archives of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli import store_episodes, store_list, store_objects
from palpate.cli.store_options import BlobsOption, StoreOption

__all__ = ["app"]

app = typer.Typer(help="Show, list, verify, repair, export or import measurements.")


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


app.command("list")(store_list.list_)
app.command("table")(store_list.table)
app.command("curves")(store_list.curves)
app.command("devices")(store_list.devices)
app.command("objects")(store_objects.objects)
app.add_typer(store_objects.app, name="object")
app.command("episodes")(store_episodes.episodes)
app.command("episode")(store_episodes.episode)


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


@app.command("schema")
def schema(
    picture: Annotated[Path, typer.Argument(metavar="PICTURE", help="The file to draw: .png, .svg or .pdf.")],
) -> None:
    """Draw the tables of a store, their columns, and which refer to which."""
    from palpate.cli.files import check_picture, replacing
    from palpate.figures.schema import draw_schema

    check_picture("PICTURE", picture)
    with replacing(picture) as draft:
        draw_schema(draft)
