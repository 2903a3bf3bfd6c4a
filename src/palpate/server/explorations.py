"""Explorations that others send, line by line, while they run: what is sent again does no harm, and nothing changes."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Annotated, Any
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag, TypeAdapter, ValidationError, model_validator

from palpate.episode.format import Episode, episode_of
from palpate.errors import LogError
from palpate.logfile import Line
from palpate.server.problems import problem, problem_of_store
from palpate.server.receiving import check_owner
from palpate.server.security.accounts import Account, Role
from palpate.server.state import State
from palpate.store.checks import check_moment, check_thing
from palpate.store.episodes import StoredEpisode, StoredStep, check_episode
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.importing.items import Fate
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.records import Receipt
from palpate.store.store import Store
from palpate.store.visible_episodes import episode_is_of, episode_is_there, episode_is_visible, recordings_of_digests

__all__ = ["MOST_LINES", "add", "begin", "check_whole", "fate_of_whole", "keep_whole", "last_at", "read_episode"]

MOST_LINES = 1_000
MOST_BYTES = 32 << 20
"""Of an exploration: each of its pages reads all of it."""
LARGEST = 2.0**53
"""Whole numbers beyond it are none to calculate with."""
QUANTILES = {"0.05", "0.5", "0.95"}
"""Those that a page draws by."""
Finite = Annotated[float, Field(allow_inf_nan=False, strict=True)]
Share = Annotated[float, Field(ge=0.0, le=1.0 + 1e-6, allow_inf_nan=False)]


class _States(BaseModel):
    """A belief about a property with states."""

    model_config = ConfigDict(extra="forbid")

    probabilities: dict[str, Share] = Field(min_length=1)
    entropy_bits: Finite


class _Number(BaseModel):
    """A belief about a number, or that there is none."""

    model_config = ConfigDict(extra="forbid")

    unit: str
    mean: Finite | None
    sd: Finite | None
    entropy_bits: Finite | None
    quantiles: dict[str, Finite]
    x: list[Finite] = Field(max_length=10_000)
    density: list[Finite] = Field(max_length=10_000)

    @model_validator(mode="after")
    def _curve(self) -> _Number:
        if len(self.x) != len(self.density):
            raise ValueError(f"{len(self.density)} densities, expected {len(self.x)}, as x has")
        if self.x and not self.quantiles.keys() >= QUANTILES:
            raise ValueError(f"quantiles of {', '.join(self.quantiles)}, expected 0.05, 0.5 and 0.95 among them")
        return self


def _kind(belief: Any) -> str:
    return "states" if isinstance(belief, dict) and "probabilities" in belief else "number"


Belief = Annotated[Annotated[_States, Tag("states")] | Annotated[_Number, Tag("number")], Discriminator(_kind)]
BELIEF = TypeAdapter(dict[str, Belief])
GAINS = TypeAdapter(dict[str, Finite])


def begin(state: State, who: Account, episode: StoredEpisode) -> tuple[int, bool]:
    """Keep an exploration without its lines; how many lines of it are here, and whether it is new."""
    try:
        _check(episode)
        check_owner(episode, who)
        if episode_is_there(state.store, episode.id):
            return _known(state, who, episode), False
        check_thing(episode.thing, is_new=True)
        receipt = put_episode(state.store, episode, uploader=who.name)
    except UnavailableError:
        raise
    except (StoreError, LogError) as error:
        raise problem_of_store(error) from None
    _check_id(episode, receipt)
    # where somebody else began the same at once, it is known as if they had done so before
    return (0, True) if receipt.new else (_known(state, who, episode), False)


def _check_id(episode: StoredEpisode, receipt: Receipt) -> None:
    """Refuse what the store knows under another id, as nothing was kept under this one."""
    if receipt.id != episode.id:
        raise problem(409, "this exploration is kept under another id already")


def _known(state: State, who: Account, episode: StoredEpisode) -> int:
    """How many lines there are of an exploration that has come already."""
    if episode_is_visible(state.store, who.viewer, episode.id):
        there = get_episode(state.store, episode.id)
        if there.document == episode.document:
            return len(there.steps)
    raise problem(409, f"id: {episode.id} is that of another exploration, expected an id of its own")


def add(
    state: State, who: Account, there: StoredEpisode, position: int, record: Mapping[str, Any], recording: str | None
) -> tuple[StoredEpisode, bool]:
    """Keep a line; the exploration by then, and whether the line is new.

    A line that is here already is known where it is the same. A line that comes before those in front of it, or is
    another one, is a 409.
    """
    if not _may_continue(state.store, who, there.id):
        raise problem(403, f"episode {there.id}: is not yours, expected one that this account has begun")
    lines = len(there.steps)
    if position > lines + 1:
        raise problem(409, f"line {position} came, and {lines} are here: expected line {lines + 1}")
    if position == lines + 1:
        return _grown(state, who, there, StoredStep(record, recording))
    if StoredStep(record, recording).document != there.steps[position - 1].document:
        raise problem(409, f"line {position} is here already and is another one; lines do not change")
    return there, False


def _grown(state: State, who: Account, there: StoredEpisode, step: StoredStep) -> tuple[StoredEpisode, bool]:
    grown = there.continued(step.record, step.recording)
    try:
        _check(grown)
        if step.recording is not None and not recordings_of_digests(state.store, who.viewer, [step.recording]):
            raise StoreError(f"recording: {step.recording} is not in the store, expected it to be sent first")
        # who was second of two that sent the same at once learns that it is here
        receipt = put_episode(state.store, grown, uploader=who.name)
    except (UnavailableError, DamagedError):
        raise
    except (StoreError, LogError) as error:
        now = len(get_episode(state.store, there.id).steps)
        if now > len(there.steps):
            # somebody else has just sent one
            raise problem(409, f"line {len(grown.steps)} came twice at once, and {now} are here") from None
        raise problem_of_store(error) from None
    _check_id(grown, receipt)
    return grown, receipt.new


def _check(episode: StoredEpisode) -> None:
    """Refuse what cannot be kept, or is no line of a log that a page could show."""
    check_episode(episode)
    last = episode.steps[-1].record if episode.steps else episode.header
    where = "record" if episode.steps else "header"
    _check_numbers(where, last)
    _check_all(where, episode)
    _check_forms(where, last)


def check_whole(episode: StoredEpisode) -> None:
    """Refuse an exploration that comes with all its lines, and cannot be kept or shown.

    Raises
    ------
    StoreError, LogError
        Naming the line.
    """
    check_episode(episode)
    if len(episode.steps) > MOST_LINES:
        raise StoreError(f"steps: {len(episode.steps)} lines, expected {MOST_LINES} at most")
    records = {f"steps[{number - 1}].record" if number else "header": one for number, one in enumerate(episode.records)}
    for where, record in records.items():
        _check_numbers(where, record)
    _check_all("steps", episode)
    for where, record in records.items():
        _check_forms(where, record)


def keep_whole(state: State, who: Account, episode: StoredEpisode) -> tuple[UUID, bool]:
    """Keep an exploration with all its lines, once `check_whole` has found nothing: under which id, and if it is new.

    Raises
    ------
    StoreError
        If it is not theirs, the id is that of another one, or a recording of its steps is none that they see.
    """
    check_owner(episode, who)
    fate = fate_of_whole(state.store, who, episode)
    if fate is Fate.REFUSED:
        raise StoreError(f"id: {episode.id} is that of another exploration, expected an id of its own")
    if fate is Fate.KNOWN:
        return episode.id, False
    digests = [step.recording for step in episode.steps if step.recording is not None]
    seen = recordings_of_digests(state.store, who.viewer, digests)
    missing = next((digest for digest in digests if digest not in seen), None)
    if missing is not None:
        raise StoreError(f"recording: {missing} is not in the store, expected it to be kept before")
    receipt = put_episode(state.store, episode, uploader=who.name)
    return receipt.id, receipt.new


def fate_of_whole(store: Store, who: Account, episode: StoredEpisode) -> Fate:
    """What `keep_whole` makes of an exploration: it is new, also where it has grown, known, or not kept."""
    if not episode_is_there(store, episode.id):
        return Fate.NEW
    is_theirs = _may_continue(store, who, episode.id)
    if not is_theirs and not episode_is_visible(store, who.viewer, episode.id):
        return Fate.REFUSED
    there = get_episode(store, episode.id)
    if there.digest == episode.digest:
        return Fate.KNOWN
    known, sent = ([step.document for step in one.steps] for one in (there, episode))
    both = min(len(known), len(sent))
    if not is_theirs or there.document != episode.document or known[:both] != sent[:both]:
        return Fate.REFUSED
    return Fate.NEW if len(sent) > len(known) else Fate.KNOWN


def _may_continue(store: Store, who: Account, key: UUID) -> bool:
    return who.role >= Role.ADMIN or episode_is_of(store, str(who.name), key)


def _check_all(where: str, episode: StoredEpisode) -> None:
    if len(episode.document) + sum(len(step.document) for step in episode.steps) > MOST_BYTES:
        raise StoreError(f"{where}: the exploration would be longer than {MOST_BYTES} bytes, expected fewer")
    read_episode(episode)


def _check_numbers(where: str, record: Mapping[str, Any]) -> None:
    _check_whole_numbers(where, record)
    if "done_at" in record:
        check_moment(f"{where}.done_at", done_at(record), datetime.now(UTC))


def _check_forms(where: str, record: Mapping[str, Any]) -> None:
    for name, form in (("belief", BELIEF), ("gains_bits", GAINS)):
        if name in record:
            try:
                form.validate_python(record[name])
            except ValidationError as error:
                first = error.errors()[0]
                place = ".".join(map(str, (name, *(first["loc"]))))
                raise StoreError(f"{where}: {place[:200]}: {first['msg']}") from None


def _check_whole_numbers(where: str, value: Any) -> None:
    """Refuse whole numbers that are none to calculate with; how deep it is nested was looked at before."""
    if isinstance(value, Mapping):
        for key, item in value.items():
            _check_whole_numbers(f"{where}.{key}", item)
    elif isinstance(value, list):
        for item in value:
            _check_whole_numbers(where, item)
    elif isinstance(value, int) and abs(value) > LARGEST:
        raise StoreError(f"{where}: a number of {value.bit_length()} bits was found, expected 53 at most")


def last_at(stored: StoredEpisode) -> datetime:
    """When the last thing was heard of an exploration: of its last line, where that tells it, or of its beginning."""
    last = stored.steps[-1].record if stored.steps else {}
    return done_at(last) if "done_at" in last else stored.started_at


def done_at(record: Mapping[str, Any]) -> datetime:
    """When a step was done; StoreError where that is no time."""
    try:
        found = datetime.fromisoformat(record["done_at"])
    except (TypeError, ValueError):
        raise StoreError(f"done_at: found {str(record['done_at'])[:40]!r}, expected a time in ISO 8601") from None
    return found


def read_episode(stored: StoredEpisode) -> Episode:
    """What the lines of an exploration say; LogError names the line that is incomplete."""
    return episode_of([Line(f"episode {stored.id} line {n}", record) for n, record in enumerate(stored.records, 1)])
