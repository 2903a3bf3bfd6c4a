"""`palpate store units` and `palpate store unit`: what decides the dimension of a property, and taking it back."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place

__all__ = ["unit", "units"]


@spread
def units(place: Place, as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False) -> None:
    """List properties, the unit that decides the dimension of each, and how many results count and do not."""
    from palpate.cli.cells_view import units_table
    from palpate.cli.terminal import console
    from palpate.store.units import list_units

    with place.opened() as store:
        found = list_units(store)
    if as_json:
        print(json.dumps([vars(one) for one in found], indent=1))
    else:
        console().print(units_table(found))


@spread
def unit(
    property_: Annotated[str, typer.Argument(metavar="PROPERTY", help="A property that the store has.")],
    unit: Annotated[str, typer.Argument(metavar="UNIT", help="Any unit of the right dimension.")],
    place: Place,
    wrong: Annotated[
        bool, typer.Option("--wrong", help="The results in a unit of another dimension are wrong: do not count them.")
    ] = False,
    who: Annotated[str | None, typer.Option("--who", help="Who decided it (default: whoever is logged in).")] = None,
) -> None:
    """Let another unit decide the dimension of a property; no recording is changed."""
    from palpate.cli.knowing import who_of
    from palpate.store.units import change_unit
    from palpate.wording import plural

    with place.opened() as store:
        changed = change_unit(store, property_, unit, wrong=wrong, who=who_of(who))
    left = f", {changed.wrong} in another dimension do not" if changed.wrong else ""
    print(f"{property_}: {unit} decides; {plural(changed.results, 'result')} count{'s' * (changed.results == 1)}{left}")
