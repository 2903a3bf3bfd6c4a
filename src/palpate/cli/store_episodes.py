"""`palpate store episodes` and `palpate store episode`: explorations that are kept with their recordings."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place, WideOption

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
    wide: WideOption = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """List explorations, the last ones first."""
    from palpate.cli.episode_view import episodes_json, episodes_table
    from palpate.cli.store_view import tell_next
    from palpate.cli.storing import check_known, moment_of
    from palpate.cli.terminal import is_terminal, print_whole
    from palpate.store.filters import Filter
    from palpate.store.listing_episodes import list_episodes

    first, end = moment_of("--since", since), moment_of("--until", until)
    with place.opened() as store:
        page = list_episodes(store, thing=thing, dataset=dataset, since=first, until=end, limit=limit, cursor=cursor)
        if not page.rows:
            check_known(store, Filter(thing=thing, dataset=dataset))
    if as_json:
        print(episodes_json(page))
    elif page.rows:
        print_whole(episodes_table(page, whole=wide or not is_terminal()))
        tell_next(page.cursor)
    else:
        print("no episode matches" if (thing, dataset, first, end) != (None,) * 4 else "no episodes yet")


@spread
def episode(
    key: Annotated[str, typer.Argument(metavar="EPISODE", help="Id or digest of an episode, or how it begins.")],
    place: Place,
    log: Annotated[Path | None, typer.Option("--log", help="Write its log to this file.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON: the lines of its log, with recordings.")] = False,
) -> None:
    """Show the steps of an exploration with their recordings, or write its log."""
    from palpate.cli.episode_view import episode_json, episode_view, write_log
    from palpate.cli.files import check_writable
    from palpate.cli.terminal import is_terminal, print_whole
    from palpate.store.keeping_episodes import get_episode
    from palpate.store.keys import episode_id

    if log is not None:
        check_writable("--log", log)
    with place.opened() as store:
        found = get_episode(store, episode_id(store, key))
    if log is not None:
        write_log(found, log)
    if as_json:
        print(episode_json(found))
    else:
        print_whole(episode_view(found, whole=not is_terminal()))
