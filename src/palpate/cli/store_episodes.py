"""`palpate store episodes` and `palpate store episode`: explorations that are kept with their recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place

__all__ = ["episode", "episodes"]


@spread
def episodes(
    place: Place,
    thing: Annotated[str | None, typer.Option("--object", help="Name, common name, alias or DATASET/NAME.")] = None,
    dataset: Annotated[str | None, typer.Option("--dataset", help="Dataset of the object.")] = None,
    since: Annotated[str | None, typer.Option("--since", help="Begun at this time or later.")] = None,
    until: Annotated[str | None, typer.Option("--until", help="Begun before this time.")] = None,
    limit: Annotated[int, typer.Option("--limit", min=1, help="Rows of a page.")] = 50,
    cursor: Annotated[str | None, typer.Option("--cursor", help="What the page before ended with.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List explorations, the last ones first."""
    from palpate.cli.episode_view import episodes_json, episodes_table
    from palpate.cli.storing import moment_of
    from palpate.cli.terminal import console
    from palpate.store.listing_episodes import list_episodes

    first, end = moment_of("--since", since), moment_of("--until", until)
    with place.opened() as store:
        page = list_episodes(store, thing=thing, dataset=dataset, since=first, until=end, limit=limit, cursor=cursor)
    if as_json:
        print(episodes_json(page))
        return
    console().print(episodes_table(page))
    if page.cursor is not None:
        print(f"more: --cursor {page.cursor}")


@spread
def episode(
    key: Annotated[str, typer.Argument(metavar="EPISODE", help="Id or digest of an episode.")],
    place: Place,
    log: Annotated[Path | None, typer.Option("--log", help="Write its log to this file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON: the lines of its log, with recordings.")] = False,
) -> None:
    """Show the steps of an exploration with their recordings, or write its log."""
    from palpate.cli.episode_view import episode_json, episode_view, write_log
    from palpate.cli.files import check_writable
    from palpate.cli.replaying import episode_key
    from palpate.cli.terminal import console
    from palpate.store.keeping_episodes import get_episode

    if log is not None:
        check_writable("--log", log)
    with place.opened() as store:
        found = get_episode(store, episode_key(key))
    if log is not None:
        write_log(found, log)
    if as_json:
        print(episode_json(found))
    else:
        console().print(episode_view(found))
