"""`palpate store share`: who may see a recording or an episode."""

from __future__ import annotations

from datetime import UTC, datetime
from enum import StrEnum
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place

__all__ = ["share"]


class Visibility(StrEnum):
    """Who may see it."""

    PRIVATE = "private"
    LAB = "lab"
    PUBLIC = "public"


@spread
def share(
    key: Annotated[str, typer.Argument(metavar="ID", help="The beginning of its id or digest.")],
    place: Place,
    visibility: Annotated[Visibility | None, typer.Option(help="Who may see it from now on.")] = None,
    embargo: Annotated[
        str | None, typer.Option(metavar="DATE", help='Others do not see it before; "none" ends an embargo.')
    ] = None,
    episode: Annotated[bool, typer.Option("--episode", help="It is an episode, and not a recording.")] = False,
    undo: Annotated[bool, typer.Option("--undo", help="Take back the last change that holds.")] = False,
    who: Annotated[str | None, typer.Option("--who", help="Who decided it (default: whoever is logged in).")] = None,
) -> None:
    """Set who may see a recording or an episode; nothing of what was measured changes."""
    from palpate.cli.knowing import who_of
    from palpate.errors import PalpateError
    from palpate.store import schema
    from palpate.store.keys import episode_id, recording_id
    from palpate.store.sharing import Sharing, undo_sharing
    from palpate.store.sharing import share as set_sharing

    if undo == (visibility is not None or embargo is not None):
        raise PalpateError("palpate store share: expected --visibility or --embargo, or else --undo alone")

    def edited(before: Sharing) -> Sharing:
        until = before.embargoed_until if embargo is None else _moment(embargo)
        return Sharing(before.visibility if visibility is None else visibility.value, until)

    with place.opened() as store:
        table, find = (schema.episodes, episode_id) if episode else (schema.recordings, recording_id)
        found, by = find(store, key), who_of(who)
        now = undo_sharing(store, table, found, who=by) if undo else set_sharing(store, table, found, edited, who=by)
    until = f", not before {now.embargoed_until:%Y-%m-%d %H:%M} UTC" if now.embargoed_until else ""
    print(f"{found}: {now.visibility}{until}")


def _moment(text: str) -> datetime | None:
    """A date or a moment, in UTC unless it says otherwise."""
    from palpate.errors import PalpateError

    if text == "none":
        return None
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        raise PalpateError(f'--embargo {text!r}: is no date, expected one as 2030-12-31, or "none"') from None
    return found.astimezone(UTC) if found.utcoffset() is not None else found.replace(tzinfo=UTC)
