"""`palpate network`: check a network, show it, and fit one to data."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.fit_options import How, Keep, OfStore, Tables
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place

__all__ = ["app"]

app = typer.Typer(help="Check a network, show it, or fit one to data.", no_args_is_help=False)


@app.command("check")
def check(
    file: Annotated[str, typer.Argument(metavar="FILE", help="TOML file, or the name of a shipped network.")],
) -> None:
    """Validate a network and say what is in it."""
    from palpate.network.reading import load_network
    from palpate.wording import plural

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
@spread
def fit(
    like: Annotated[
        str, typer.Option(metavar="NETWORK", help="Whose properties, actions and costs are kept: shipped, or a file.")
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The TOML file to write.")],
    place: Place,
    of_store: OfStore,
    tables: Tables,
    how: How,
    keep: Keep = None,
    force: Annotated[bool, typer.Option("--force", help="Replace the file if there is one.")] = False,
) -> None:
    """Make a network from your own data: its numbers are estimated from objects with known properties."""
    from palpate.cli.fit_data import From
    from palpate.cli.fitting import All, fit_network

    fit_network(like, From(place, of_store, tables), All(tuple(keep or ())), output, how, force=force)
