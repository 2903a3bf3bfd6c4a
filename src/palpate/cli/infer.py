"""`palpate infer`: the belief and the expected gains for given evidence."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from palpate.cli.answer import Inferred

__all__ = ["infer"]


def infer(
    evidence: Annotated[str, typer.Argument(metavar="FILE|-", help="JSON with the evidence; - is standard input.")],
    network: Annotated[str, typer.Option(help="Name of a shipped network, or a TOML file.")] = "household",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON for programs.")] = False,
    engine: Annotated[
        str, typer.Option(help="Inference engine: exact, or message-passing: the method of the paper.")
    ] = "exact",
    preset: Annotated[
        str | None,
        typer.Option(help="Message passing as-released (default), repaired or as-written."),
    ] = None,
) -> None:
    """Print the belief about every property and what every action would tell, given evidence.

    The evidence is JSON: {"evidence": [{"action": "weighing", "value": 118, "unit": "g"}, ...]}.
    """
    from palpate.cli import answer
    from palpate.cli.engines import prior_belief
    from palpate.network.reading import load_network

    name, document = answer.read_document(evidence)
    items = answer.read_evidence(name, document)
    inferred = answer.infer(name, prior_belief(engine, load_network(network), preset), items)
    # everything that can fail comes before the first line of output
    show = _json(inferred) if as_json else _tables(inferred)
    for notice in inferred.notices:
        print(f"note: {notice}", file=sys.stderr)
    show()


def _json(inferred: Inferred) -> Callable[[], None]:
    import json

    from palpate.cli.answer import answer

    text = json.dumps(answer(inferred), indent=2, allow_nan=False)
    return lambda: print(text)


def _tables(inferred: Inferred) -> Callable[[], None]:
    from palpate.cli.answer_view import answer_tables
    from palpate.cli.terminal import console

    tables = answer_tables(inferred)
    return lambda: console().print(tables)
