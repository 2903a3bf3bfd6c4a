"""`palpate store export`: measurements for other programs and other people."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place, Which

__all__ = ["export"]

TERMS, FRAMES = "What others are told (not for archive)", "Frames (lerobot)"


@spread
def export(
    which: Which,
    place: Place,
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="The folder to make.")],
    form: Annotated[str, typer.Option("--format", help="archive, parquet, hugging-face or lerobot.")] = "archive",
    title: Annotated[str | None, typer.Option(help="Of the data set.", rich_help_panel=TERMS)] = None,
    author: Annotated[
        list[str] | None,
        typer.Option(help="'Family name, Given name' or a group; may be repeated.", rich_help_panel=TERMS),
    ] = None,
    licence: Annotated[
        str | None, typer.Option(help="Of all recordings, such as CC-BY-4.0.", rich_help_panel=TERMS)
    ] = None,
    include_private: Annotated[
        bool, typer.Option("--include-private", help="Also what is not public.", rich_help_panel=TERMS)
    ] = False,
    fps: Annotated[int | None, typer.Option(min=1, help="Frames per second (30).", rich_help_panel=FRAMES)] = None,
    resample: Annotated[str | None, typer.Option(help="nearest or linear (nearest).", rich_help_panel=FRAMES)] = None,
    assumed_rate: Annotated[
        float | None, typer.Option(help="Samples per second where none is stated.", rich_help_panel=FRAMES)
    ] = None,
    leave_out_damaged: Annotated[
        bool, typer.Option("--leave-out-damaged", help="Export the others where some are damaged, and name these.")
    ] = False,
) -> None:
    """Write recordings as an archive, which can be imported again, or in a format for others."""
    from palpate.cli.exporting import Wishes, naming_options, tell_written
    from palpate.cli.progress_view import bar
    from palpate.cli.storing import LeftOut, check_known
    from palpate.store.exporting.writing import export as write
    from palpate.store.listing import list_recordings

    wishes = Wishes(form, title, tuple(author or ()), licence, include_private, fps, resample, assumed_rate)
    how = wishes.format()
    with naming_options(), place.opened() as found, bar("exporting") as told:
        wanted = which.filter(found)
        left = LeftOut()
        if not (list_recordings(found, wanted, limit=1, damaged=left.damaged.append).rows or left.damaged):
            check_known(found, wanted)
        written = write(found, how, folder, wanted, told, leave_out_damaged=leave_out_damaged)
    tell_written(folder, written)
