"""What a store holds as JSON can: the forms of `palpate.server.api.models`."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from palpate.server.names import thing_address
from palpate.store.content import device_plain, entry_plain, in_utc
from palpate.store.entries import Entry
from palpate.store.listing import Listed
from palpate.store.listing_episodes import ListedEpisode
from palpate.store.parts import Head
from palpate.store.records import ThingRef
from palpate.store.things import Thing
from palpate.store.visible_setups import SeenDevice, SeenSetup

__all__ = [
    "device_row",
    "entry",
    "episode_row",
    "files",
    "moment",
    "recording",
    "recording_row",
    "series_infos",
    "setup",
    "thing",
    "thing_name",
]

Plain = dict[str, Any]
ROOT = "/api/v1"


def moment(at: datetime | None) -> str | None:
    """A moment in UTC."""
    return None if at is None else in_utc(at)


def entry(found: Entry) -> Plain:
    """A result."""
    return entry_plain(found)


def thing_name(found: ThingRef) -> Plain:
    """An object by its dataset and name."""
    return {"dataset": found.dataset, "name": found.id}


def thing(found: Thing) -> Plain:
    """An object with what is known of it."""
    ref, address = found.ref, f"{ROOT}/objects/{thing_address(found.ref)}"
    images = [
        {"name": one.name, "media_type": one.media_type, "url": f"{address}/images/{place}"}
        for place, one in enumerate(found.images)
    ]
    return {
        **thing_name(ref),
        "common_name": ref.common_name,
        "maker": ref.maker,
        "aliases": list(ref.aliases),
        "attributes": dict(ref.attributes),
        "known": [{"entry": entry(one.entry), "source": one.source} for one in found.known],
        "images": images,
        "merged": [thing_name(one) for one in found.merged],
        "recordings": found.recordings,
        "url": address,
    }


def recording_row(row: Listed) -> Plain:
    """A recording as it stands in a list."""
    same = ("digest", "action", "common_name", "gripper", "owner", "visibility", "ground_truth")
    id = str(row.id)
    return {
        "id": id,
        **{name: getattr(row, name) for name in same},
        "ground_truth": bool(row.ground_truth),
        "recorded_at": moment(row.recorded_at),
        "uploaded_at": moment(row.uploaded_at),
        "embargoed_until": moment(row.embargoed_until),
        "object": {"dataset": row.dataset, "name": row.thing},
        "entries": [entry(one) for one in row.entries],
        "notices": list(row.notices),
        "url": f"{ROOT}/recordings/{id}",
    }


def recording(head: Head, *, with_sender: bool) -> Plain:
    """A recording whole, but for samples, what is in its files, and its log; who has sent it only where told so."""
    plain = head.document
    same = ("action", "owner", "licence", "ground_truth", "software", "repository", "setup", "grasp")
    more = ("gripper_pose", "object_pose", "entries", "notices")
    return {
        "id": str(head.id),
        "digest": head.digest,
        "recorded_at": plain["recorded_at"],
        "uploaded_at": moment(head.uploaded_at),
        "object": thing_name(head.thing),
        "common_name": head.thing.common_name,
        "visibility": head.visibility,
        "embargoed_until": moment(head.embargoed_until),
        "uploaded_by": head.uploaded_by if with_sender else None,
        **{name: plain[name] for name in (*same, *more)},
        "series": series_infos(head),
        "files": files(head),
        "url": address_of(head),
    }


def series_infos(head: Head) -> list[Plain]:
    """The series of a recording without their samples."""
    return [
        {
            "position": place,
            "name": series.name,
            "channels": [channel(one) for one in series.channels],
            "url": f"{address_of(head)}/series/{place}",
        }
        for place, series in enumerate(head.series)
    ]


def channel(found: Mapping[str, Any]) -> Plain:
    """A channel without its samples."""
    same = {name: found[name] for name in ("name", "quantity", "unit", "rate_hz", "timed")}
    return {**same, "shape": [found["count"], *found["shape"]]}


def files(head: Head) -> list[Plain]:
    """The files of a recording."""
    return [
        {"position": place, **vars(one), "url": f"{address_of(head)}/files/{place}"}
        for place, one in enumerate(head.files)
    ]


def address_of(head: Head) -> str:
    """Where a recording is."""
    return f"{ROOT}/recordings/{head.id}"


def setup(found: SeenSetup) -> Plain:
    """A setup."""
    devices = [device_plain(one) for one in found.setup.devices]
    return {"digest": found.digest, "devices": devices, "recordings": found.recordings}


def device_row(found: SeenDevice) -> Plain:
    """A device with the setups it is part of."""
    own = device_plain(found.device) or {}
    return {"digest": found.digest, **own, "setups": list(found.setups), "recordings": found.recordings}


def episode_row(row: ListedEpisode) -> Plain:
    """An exploration as it stands in a list."""
    same = (
        "digest",
        "common_name",
        "owner",
        "visibility",
        "network",
        "objective",
        "policy",
        "robot",
        "actions",
        "stop",
    )
    return {
        "id": str(row.id),
        **{name: getattr(row, name) for name in same},
        "started_at": moment(row.started_at),
        "embargoed_until": moment(row.embargoed_until),
        "object": {"dataset": row.dataset, "name": row.thing},
        "url": f"{ROOT}/episodes/{row.id}",
    }
