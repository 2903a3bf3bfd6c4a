"""Episodes in a store: the steps, beliefs and choices of an exploration, linked to its recordings.

An episode is kept as its log (see `palpate.episode`): the records of its lines are what is hashed and stored. A step
names the recording of its action by digest.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property
from hashlib import sha256
from typing import Any
from uuid import UUID, uuid4

from palpate.errors import choices
from palpate.logfile import EPISODE_FORMAT
from palpate.store.checks import check_embargo, check_moment, check_thing
from palpate.store.content import in_utc, to_json
from palpate.store.decoding import moment_from
from palpate.store.errors import DamagedError, StoreError
from palpate.store.filters import digest_bytes
from palpate.store.legible import legible
from palpate.store.records import VISIBILITIES, ThingRef
from palpate.store.texts import check_json, check_text

__all__ = ["StoredEpisode", "StoredStep", "check_episode"]

Record = Mapping[str, Any]


@dataclass(frozen=True)
class StoredStep:
    """A line of an episode: an action with what it taught, or the reason why exploration stopped.

    Attributes
    ----------
    record
        What stands in the log.
    recording
        Digest of the recording of the action; None where there is none.
    """

    record: Record
    recording: str | None = None

    @cached_property
    def document(self) -> str:
        """The step as JSON: what is hashed and stored."""
        return to_json({"record": self.record, "recording": self.recording})

    @cached_property
    def flaw(self) -> str | None:
        """What of the record JSON cannot hold; looked for once, as an episode is checked again with each new step."""
        try:
            check_json("", self.record)
        except StoreError as error:
            return str(error)
        return None


@dataclass(frozen=True)
class StoredEpisode:
    """An exploration of one object, over or interrupted.

    Attributes
    ----------
    started_at
        When, with a time zone.
    thing
        The object.
    header
        The first line of the log: how it was explored, and the belief before.
    steps
        The other lines.
    owner, visibility
        Whose it is and who may see it: private, lab or public.
    embargoed_until
        Until when only those see it who would if it were private; with a time zone.
    id
        Its own, also while it grows.
    """

    started_at: datetime
    thing: ThingRef
    header: Record
    steps: tuple[StoredStep, ...] = ()
    owner: str | None = None
    visibility: str = "private"
    embargoed_until: datetime | None = None
    id: UUID = field(default_factory=uuid4)

    @cached_property
    def document(self) -> str:
        """All but id, visibility, embargo and steps, as JSON."""
        thing = [self.thing.dataset, self.thing.id]
        head = {"started_at": in_utc(self.started_at), "thing": thing, "owner": self.owner}
        return to_json({**head, "header": self.header})

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the document and of the steps, in hexadecimal digits."""
        return episode_digest(self.document, [step.document for step in self.steps])

    @property
    def records(self) -> tuple[Record, ...]:
        """The lines of its log, the header first."""
        return (self.header, *(step.record for step in self.steps))

    @property
    def stop(self) -> str | None:
        """Why it stopped; None where it was interrupted."""
        last = self.steps[-1].record if self.steps else {}
        return last.get("stop")

    @property
    def actions(self) -> int:
        """How many actions were taken."""
        return sum("action" in step.record for step in self.steps)

    def continued(self, record: Record, recording: str | None = None) -> StoredEpisode:
        """The same with one more line."""
        steps = (*self.steps, StoredStep(record, recording))
        return replace(self, steps=steps)


def episode_digest(document: str, steps: Sequence[str]) -> str:
    """The digest of an episode from its parts, as they are made and as they are stored."""
    return sha256("\n".join((document, *steps)).encode()).hexdigest()


def episode_from(
    document: str,
    steps: Sequence[str],
    digest: str,
    *,
    thing: ThingRef,
    visibility: str,
    id: UUID,
    embargoed_until: datetime | None = None,
) -> StoredEpisode:
    """Put an episode together and verify its digest.

    Raises
    ------
    DamagedError
        If it is not what was stored under that digest.
    """
    found = episode_digest(document, steps)
    if found != digest:
        raise DamagedError(f"episode {id}: digest {found}, expected {digest}")
    with legible(f"episode {id}"):
        plain = json.loads(document)
        lines = (json.loads(step) for step in steps)
        return StoredEpisode(
            started_at=moment_from(plain["started_at"]),
            thing=thing,
            header=plain["header"],
            steps=tuple(StoredStep(line["record"], line["recording"]) for line in lines),
            owner=plain["owner"],
            visibility=visibility,
            embargoed_until=embargoed_until,
            id=id,
        )


def check_episode(episode: StoredEpisode) -> None:
    """Refuse an episode that cannot be kept.

    Raises
    ------
    StoreError
        Naming the field: a time in the future or without a time zone, a header of no episode, steps that do not
        follow each other, a step after the end, a digest that is none, a value that JSON cannot hold.
    """
    check_moment("started_at", episode.started_at, datetime.now(UTC))
    check_thing(episode.thing)
    check_text("owner", episode.owner)
    if episode.visibility not in VISIBILITIES:
        raise StoreError(f"visibility: found {episode.visibility!r}; {choices(VISIBILITIES)}")
    check_embargo(episode.embargoed_until)
    check_json("header", episode.header)
    found = episode.header.get("format")
    if found != EPISODE_FORMAT:
        raise StoreError(f"header.format: found {found!r}, expected {EPISODE_FORMAT!r}")
    for where, step in _placed(episode):
        if step.flaw is not None:
            raise StoreError(f"{where}{step.flaw}")
        if step.recording is not None:
            digest_bytes(step.recording)


def _placed(episode: StoredEpisode) -> Iterator[tuple[str, StoredStep]]:
    """Each step with its place, once it is found to stand where it should."""
    for place, step in enumerate(episode.steps):
        where = f"steps[{place}]"
        if "stop" in step.record:
            if place != len(episode.steps) - 1:
                raise StoreError(f"{where}: exploration stopped, and steps follow; expected it as the last one")
        elif step.record.get("step") != place + 1 or not isinstance(step.record.get("action"), str):
            raise StoreError(f"{where}.step: found {step.record.get('step')!r}, expected {place + 1} with an action")
        yield where, step
