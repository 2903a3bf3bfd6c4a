"""What lists can be asked: filters, sorting and paging, as parameters of addresses."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator

from palpate.store.cursors import place_of
from palpate.store.filters import Sort
from palpate.store.listing_episodes import EpisodePage, list_episodes
from palpate.store.store import Store
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_things import ThingFilter

__all__ = ["EpisodeQuery", "ObjectQuery", "PageQuery", "RecordingQuery"]

LONGEST_PAGE = 500


def _plain(text: str) -> str:
    # no database can look for a zero byte, and not each says so kindly
    if "\0" in text:
        raise ValueError("holds a zero byte, expected text")
    return text


def _no_bare_number(moment: object) -> object:
    # it would be taken for seconds since 1970
    try:
        float(str(moment))
    except ValueError:
        return moment
    raise ValueError("is a number, expected a date such as 2024-05-01T12:00:00Z")


def _in_utc(moment: datetime) -> datetime:
    return moment if moment.utcoffset() is not None else moment.replace(tzinfo=UTC)


def _place(cursor: str) -> str:
    # of which list it is the store finds out
    if place_of(cursor) is None:
        raise ValueError("is not of a list like this, expected the cursor of its last page")
    return cursor


Text = Annotated[str, Field(max_length=500), AfterValidator(_plain)]
LONGEST_CURSOR = 8_000
"""It holds the name at which a page ends, each letter as up to twelve."""
CursorText = Annotated[str, Field(max_length=LONGEST_CURSOR), AfterValidator(_plain), AfterValidator(_place)]
Moment = Annotated[datetime, BeforeValidator(_no_bare_number), AfterValidator(_in_utc)]
Pair = Annotated[str, Field(max_length=500, pattern=r"^[^:\x00]+:[^\x00]+$", examples=["material:wood"])]


class PageQuery(BaseModel):
    """A page of a list."""

    model_config = ConfigDict(extra="forbid")

    limit: int = Field(50, ge=1, le=LONGEST_PAGE, description="Rows of a page.")
    cursor: CursorText | None = Field(None, description="`next` of the page before.")
    fields: list[Text] = Field([], description="Only these fields of each item, separated by commas.")

    @model_validator(mode="before")
    @classmethod
    def without_empty(cls, given: Any) -> Any:
        """A form sends its empty fields too: they ask for nothing."""
        return {name: value for name, value in given.items() if value != ""} if isinstance(given, dict) else given


class ObjectQuery(PageQuery):
    """Which objects."""

    text: Text | None = Field(
        None, description="Words, each a part of a name, maker or alias, in any order and any case."
    )
    dataset: Text | None = None
    known: list[Pair] = Field([], description="PROPERTY:LABEL that the object is known to be.")
    action: Text | None = Field(None, description="It was measured by this action.")
    property: Text | None = Field(None, description="There is a result of this property.")
    gripper: Text | None = Field(None, description="It was measured with this gripper.")

    def filter(self) -> ThingFilter:
        """The same for the store."""
        same = {name: getattr(self, name) for name in ("text", "dataset", "action", "property", "gripper")}
        return ThingFilter(known=tuple(pairs(self.known)), **same)


class RecordingQuery(PageQuery):
    """Which recordings, and in which order."""

    object: Text | None = Field(None, description="Name, common name, alias or DATASET/NAME.")
    dataset: Text | None = None
    category: Text | None = Field(None, description="The same as known=category:...")
    material: Text | None = Field(None, description="The same as known=material:...")
    known: list[Pair] = Field([], description="PROPERTY:LABEL that the object is known to be.")
    label: list[Pair] = Field([], description="PROPERTY:LABEL that was measured as the most probable.")
    action: Text | None = None
    property: Text | None = Field(None, description="There is a result of this property.")
    device: Text | None = None
    gripper: Text | None = None
    setup: str | None = Field(None, pattern="^([0-9a-f]{64})?$", description="Digest of the setup.")
    owner: Text | None = None
    since: Moment | None = Field(None, description="Recorded then or later; in UTC unless it says otherwise.")
    until: Moment | None = Field(None, description="Recorded before.")
    ground_truth: bool | None = None
    text: Text | None = Field(
        None, description="Words, each a part of a name, a notice or an owner, in any order and any case."
    )
    sort: Literal["recorded", "uploaded", "action"] = "recorded"
    order: Literal["descending", "ascending"] = "descending"

    def filter(self, viewer: Viewer) -> VisibleFilter:
        """The same for the store, with who looks."""
        same = ("dataset", "action", "property", "device", "gripper", "setup", "owner")
        more = ("since", "until", "ground_truth", "text")
        said = [(name, label) for name in ("category", "material") if (label := getattr(self, name)) is not None]
        return VisibleFilter(
            thing=self.object,
            labels=_by_property(pairs(self.label)),
            known=_by_property([*pairs(self.known), *said]),
            viewer=viewer,
            **{name: getattr(self, name) for name in (*same, *more)},
        )

    def sorting(self) -> Sort:
        """The same for the store."""
        return Sort(self.sort, self.order == "descending")


class EpisodeQuery(PageQuery):
    """Which explorations, the last one first."""

    object: Text | None = Field(None, description="Name, common name, alias or DATASET/NAME.")
    dataset: Text | None = None
    since: Moment | None = None
    until: Moment | None = None

    def found(self, store: Store, viewer: Viewer) -> EpisodePage:
        """The page of them that this viewer may see."""
        return list_episodes(
            store,
            thing=self.object,
            dataset=self.dataset,
            since=self.since,
            until=self.until,
            viewer=viewer,
            limit=self.limit,
            cursor=self.cursor,
        )


def pairs(texts: Sequence[str]) -> list[tuple[str, str]]:
    """``PROPERTY:LABEL`` apart."""
    return [(name, label) for name, _, label in (text.partition(":") for text in texts)]


def _by_property(found: Sequence[tuple[str, str]]) -> dict[str, list[str]]:
    labels = defaultdict[str, list[str]](list)
    for name, label in found:
        labels[name].append(label)
    return dict(labels)
