"""Lists of episodes: by object and time, in pages."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, select, tuple_

from palpate.store import schema
from palpate.store.embargo import embargo_of
from palpate.store.filters import Sort, moment_us, things_named
from palpate.store.legible import reading
from palpate.store.page_ends import Lists, PageEnd
from palpate.store.rows import moment_at
from palpate.store.sayings import knows_name
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_words import seen_names

__all__ = ["EpisodePage", "ListedEpisode", "list_episodes"]

BY_TIME = Sort()


@dataclass(frozen=True)
class ListedEpisode:
    """An episode as it stands in a list; `stop` is None where it was interrupted."""

    id: UUID
    digest: str
    started_at: datetime
    dataset: str
    thing: str
    common_name: str | None
    owner: str | None
    visibility: str
    embargoed_until: datetime | None
    network: str
    objective: str
    policy: str
    robot: str
    actions: int
    stop: str | None


@dataclass(frozen=True)
class EpisodePage:
    """Some rows of a list, and the cursor that the next page begins after; None where there is none."""

    rows: tuple[ListedEpisode, ...]
    cursor: str | None


def list_episodes(
    store: Store,
    *,
    thing: str | None = None,
    dataset: str | None = None,
    since: datetime | None = None,
    until: datetime | None = None,
    viewer: Viewer | None = None,
    limit: int = 50,
    cursor: str | None = None,
) -> EpisodePage:
    """List episodes, the last one first, a page at a time.

    Parameters
    ----------
    store
        Where to look.
    thing, dataset
        The object, as in `palpate.store.filters.Filter`.
    since, until
        When they began, from the first to before the second.
    viewer
        Who looks; all are there unless given.
    limit, cursor
        Rows of a page, and the cursor of the page before.

    Raises
    ------
    StoreError
        If the cursor is not of a list of episodes, or a time has no time zone.
    """
    episodes, things = schema.episodes, schema.things
    lists = Lists(episodes, BY_TIME, "started_us", viewer or Viewer(everything=True))
    asked = (
        select(episodes, things.c.dataset, things.c.name, things.c.common_name)
        .join(things, things.c.id == episodes.c.thing_id)
        .where(*_conditions(thing, dataset, since, until, viewer))
        .order_by(episodes.c.started_us.desc(), episodes.c.id.desc())
        .limit(limit)
    )
    if viewer is not None:
        asked = asked.where(viewer.of(episodes))
    with reading(store.engine) as connection:
        if cursor is not None:
            after = lists.end_at(connection, cursor)
            asked = asked.where(tuple_(episodes.c.started_us, episodes.c.id) < tuple_(after.value, after.row))
        rows = connection.execute(asked).mappings().all()
        names = {row["thing_id"]: row["common_name"] for row in rows}
        seen = names if viewer is None else seen_names(connection, viewer, names)
        listed = tuple(_listed(row, seen[row["thing_id"]]) for row in rows)
    if not rows or len(rows) < limit:
        return EpisodePage(listed, None)
    return EpisodePage(listed, lists.cursor_after(PageEnd(rows[-1]["started_us"], rows[-1]["id"]), rows[-1]))


def _conditions(
    thing: str | None, dataset: str | None, since: datetime | None, until: datetime | None, viewer: Viewer | None
) -> Iterator[ColumnElement[bool]]:
    columns = schema.episodes.c
    if thing is not None or dataset is not None:
        yield columns.thing_id.in_(
            things_named(thing, dataset, None if viewer is None else partial(knows_name, viewer))
        )
    if since is not None:
        yield columns.started_us >= moment_us("since", since)
    if until is not None:
        yield columns.started_us < moment_us("until", until)


def _listed(row: Mapping[Any, Any], common_name: str | None) -> ListedEpisode:
    header = json.loads(row["document"])["header"]
    told: dict[str, Any] = {name: str(header.get(name, "")) for name in ("objective", "policy", "robot")}
    same = ("dataset", "owner", "visibility", "actions", "stop")
    return ListedEpisode(
        id=UUID(bytes=row["uuid"]),
        digest=row["digest"].hex(),
        started_at=moment_at(row["started_us"]),
        thing=row["name"],
        common_name=common_name,
        embargoed_until=embargo_of(row["embargoed_us"]),
        network=str(header.get("network", {}).get("name", "")),
        **told,
        **{name: row[name] for name in same},
    )
