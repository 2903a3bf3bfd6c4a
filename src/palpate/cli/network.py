"""`palpate network`: check a network, show it, and fit one to data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(help="Check a network, show it, or fit one to data.", no_args_is_help=False)

DATA, HOW = "Data", "How it is fitted"


@app.command("check")
def check(
    file: Annotated[str, typer.Argument(metavar="FILE", help="TOML file, or the name of a shipped network.")],
) -> None:
    """Validate a network and say what is in it."""
    from palpate.figures.wording import plural
    from palpate.network.reading import load_network

    found = load_network(file)
    categorical = f"{len(found.categorical)} categorical with {plural(found.joint_states, 'joint state')}"
    properties = f"{len(found.properties)} properties ({categorical})"
    parts = [properties, plural(len(found.actions), "action"), plural(len(found.objects), "object")]
    print(f"{file}: the network {found.name!r} is valid: {', '.join(parts)}")


@app.command("show")
def show(
    name: Annotated[
        str, typer.Argument(metavar="[NAME|FILE]", help="A shipped network, or a TOML file.")
    ] = "household",
    dot: Annotated[bool, typer.Option("--dot", help="Print the graph as Graphviz text.")] = False,
    picture: Annotated[
        Path | None, typer.Option(help="Draw the graph and every prior density: .png, .svg or .pdf.")
    ] = None,
) -> None:
    """Show a network: its properties, actions and objects."""
    from palpate.network.reading import load_network

    network = load_network(name)
    if picture is not None:
        from palpate.cli.files import check_picture, replacing
        from palpate.figures.network import draw_network

        check_picture("--picture", picture)
        with replacing(picture) as draft:
            draw_network(network, draft)
    if dot:
        from palpate.network.drawing import dot as graph

        print(graph(network))
    elif picture is None:
        from palpate.cli.network_view import network_tables
        from palpate.cli.terminal import console

        console().print(network_tables(network))


@app.command("fit")
def fit(
    like: Annotated[
        str, typer.Option(metavar="NETWORK", help="Whose properties, actions and costs are kept: shipped, or a file.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The TOML file to write.")],
    store: Annotated[
        str | None, typer.Option(help="SQLite file or postgresql+psycopg://...", rich_help_panel=DATA)
    ] = None,
    blobs: Annotated[str | None, typer.Option(help="Where the store's large bytes are.", rich_help_panel=DATA)] = None,
    dataset: Annotated[str | None, typer.Option(help="Of the store: only its objects.", rich_help_panel=DATA)] = None,
    device: Annotated[
        str | None, typer.Option(help="Of the store: only readings of setups with it.", rich_help_panel=DATA)
    ] = None,
    gripper: Annotated[
        str | None, typer.Option(help="Of the store: only readings with it.", rich_help_panel=DATA)
    ] = None,
    since: Annotated[
        str | None, typer.Option(help="Of the store: readings at this time or later.", rich_help_panel=DATA)
    ] = None,
    until: Annotated[
        str | None, typer.Option(help="Of the store: readings before this time.", rich_help_panel=DATA)
    ] = None,
    csv: Annotated[
        Path | None, typer.Option(help="Table of objects, a column for each property.", rich_help_panel=DATA)
    ] = None,
    csv_readings: Annotated[
        Path | None, typer.Option(help="Table of readings: object, action, outcome.", rich_help_panel=DATA)
    ] = None,
    column: Annotated[
        list[str] | None,
        typer.Option(help="COLUMN='PROPERTY [UNIT]', or COLUMN= to leave it out; repeatable.", rich_help_panel=DATA),
    ] = None,
    pseudo_count: Annotated[float, typer.Option(help="Added to each count of a table.", rich_help_panel=HOW)] = 0.2,
    keep: Annotated[
        list[str] | None,
        typer.Option(help="A property or action whose numbers are kept; repeatable.", rich_help_panel=HOW),
    ] = None,
    folds: Annotated[
        int, typer.Option(help="Of the objects, to score the fit on those held out; 0: none.", rich_help_panel=HOW)
    ] = 10,
    date: Annotated[
        str | None, typer.Option(help="Of the network; that of the last recording unless given.", rich_help_panel=HOW)
    ] = None,
) -> None:
    """Make a network from your own data: its numbers are estimated from objects with known properties."""
    from palpate.cli.fitting import From, fit_network
    from palpate.fitting.settings import Settings

    asked = {"dataset": dataset, "device": device, "gripper": gripper, "since": since, "until": until}
    tables = (csv, csv_readings, tuple(column or ()))
    data = From(store, blobs, {name: value for name, value in asked.items() if value is not None}, *tables)
    fit_network(like, data, output, Settings(pseudo_count, tuple(keep or ())), folds, date)
