"""`palpate store`: what is in a store, and whether it is whole; archives of it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli import store_episodes, store_list, store_objects, store_sharing, store_units
from palpate.cli.export import export
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place, WideOption

__all__ = ["app"]

app = typer.Typer(help="Show, list, verify, repair, export or import measurements.")


@app.callback()
def store() -> None:
    """Show, list, verify, repair, export or import measurements."""
    from palpate.cli.storing import check_installed

    check_installed()


@app.command("show")
@spread
def show(
    place: Place,
    key: Annotated[
        str | None,
        typer.Argument(metavar="[RECORDING]", help="Id or digest of one recording, or how it begins."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one recording as JSON.")] = False,
    wide: WideOption = False,
) -> None:
    """Show objects, setups and the last recordings with what was odd about them; or all of one recording."""
    from palpate.cli.recording_view import recording_json, recording_view
    from palpate.cli.store_view import overview
    from palpate.cli.storing import LeftOut
    from palpate.cli.terminal import is_terminal, print_whole
    from palpate.errors import PalpateError
    from palpate.store.keys import recording_id

    if as_json and key is None:
        raise PalpateError("--json: is for one recording, expected its id; `palpate store list --json` has all")
    with place.opened() as found:
        if key is None:
            left = LeftOut()
            print_whole(overview(found, left.damaged.append, whole=wide or not is_terminal()))
            left.tell()
            return
        recording = found.get(recording_id(found, key))
    if as_json:
        print(recording_json(recording))
    else:
        print_whole(recording_view(recording))


app.command("list")(store_list.list_)
app.command("table")(store_list.table)
app.command("curves")(store_list.curves)
app.command("devices")(store_list.devices)
app.command("units")(store_units.units)
app.command("unit")(store_units.unit)
app.command("share")(store_sharing.share)
app.command("objects")(store_objects.objects)
app.add_typer(store_objects.app, name="object")
app.command("episodes")(store_episodes.episodes)
app.command("episode")(store_episodes.episode)


@app.command("verify")
@spread
def verify(place: Place) -> None:
    """Check every digest and every reference; exit with code 1 where something is not as it was written."""
    from palpate.cli.fault_view import tell_found
    from palpate.store.verifying import verify as faults_of

    with place.opened() as found:
        faults = tell_found(faults_of(found))
    raise typer.Exit(1 if faults else 0)


@app.command("repair")
@spread
def repair(place: Place) -> None:
    """Verify, and take only steps that cannot lose anything; exit with code 1 where something could not be mended."""
    from palpate.cli.fault_view import tell_mended
    from palpate.store.verifying import repair as mend

    with place.opened() as found:
        faults = tell_mended(mend(found))
    raise typer.Exit(0 if all(fault.mended for fault in faults) else 1)


app.command("export")(export)


@app.command("import")
@spread
def import_(
    place: Place,
    paths: Annotated[
        list[Path] | None, typer.Argument(metavar="[PATH]...", help="Files, or folders of them, also as zip files.")
    ] = None,
    example: Annotated[bool, typer.Option("--example", help="Import the example that the package ships.")] = False,
    columns: Annotated[
        Path | None, typer.Option(help="What the columns of CSV files mean, in TOML; without it they are skipped.")
    ] = None,
    topics: Annotated[
        Path | None, typer.Option(help="What the topics of ROS 2 bags and MCAP files become; without it, likewise.")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Write what became of everything to this file as JSON.")] = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Print every decision on how a file was read.")
    ] = False,
) -> None:
    """Put recordings from files into the store; what is there already stays as it is.

    The exit code is 1 where something was refused, or nothing came of a path.
    """
    from palpate.cli.importing import check_paths, formats_of, import_shown
    from palpate.store.importing.own_formats import EXAMPLE

    wanted = [*(paths or ()), *([EXAMPLE] if example else [])]
    check_paths(wanted, report)
    formats = formats_of(columns, topics)
    with place.opened(make=True) as found:
        is_well = import_shown(found, wanted, formats, report_file=report, verbose=verbose)
    raise typer.Exit(0 if is_well else 1)


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
