"""One measurement that somebody types, as from a kitchen scale."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from palpate.errors import choices
from palpate.server.security.accounts import Account
from palpate.server.typed_entries import typed_entry
from palpate.store.checks import check
from palpate.store.errors import StoreError
from palpate.store.importing.items import identified
from palpate.store.records import Device, Recording, Setup, ThingRef

__all__ = ["recording_by_hand"]

OTHER = "other"
KINDS = ("gripper", "arm", "camera", "microphone")


def recording_by_hand(fields: Mapping[str, str], who: Account) -> Recording:
    """The recording of a form's fields; the same fields give the same recording again.

    Raises
    ------
    StoreError
        Naming the field that is wrong.

    Examples
    --------
    >>> from palpate.server.security.accounts import Role
    >>> given = {"dataset": "our lab", "object": "mug", "action": "weighing", "property": "mass", "value": "118.5"}
    >>> given |= {"unit": "g", "recorded_at": "2024-05-01T12:00"}
    >>> recording_by_hand(given, Account("ann", Role.OWNER)).entries
    (Value(property='mass', value=118.5, sd=None, unit='g'),)
    """
    device, kind = fields.get("device", ""), fields.get("kind") or OTHER
    if kind not in (OTHER, *KINDS):
        raise StoreError(f"kind: found {kind[:40]!r}; {choices((OTHER, *KINDS))}")
    found = Recording(
        recorded_at=_moment(fields.get("recorded_at", "")),
        action=fields.get("action", ""),
        thing=ThingRef(fields.get("dataset", ""), fields.get("object", "")),
        setup=_setup(device, kind),
        owner=who.name,
        licence=fields.get("licence") or None,
        visibility=fields.get("visibility") or "private",
        ground_truth=fields.get("ground_truth") == "yes",
        entries=(typed_entry(fields),),
        notices=("this was typed into a form, and there is no signal behind it",),
    )
    # what is no finite number has no digest, and without one there is no id
    check(found)
    return identified(found)


def _setup(name: str, kind: str) -> Setup:
    if not name:
        return Setup()
    if kind == OTHER:
        return Setup(other=(Device("other", name),))
    named: dict[str, Any] = {kind: Device(kind, name)}
    return Setup(**named)


def _moment(text: str) -> datetime:
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        raise StoreError(f"when: found {text[:40]!r}, expected a day and a time such as 2024-05-01T12:00") from None
    return found.replace(tzinfo=UTC) if found.tzinfo is None else found.astimezone(UTC)
