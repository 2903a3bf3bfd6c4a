"""Devices of a store, and how each was calibrated over time."""

from __future__ import annotations

from typing import NamedTuple

from sqlalchemy import func, select

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.records import Device
from palpate.store.seals import checked_document
from palpate.store.store import Store

__all__ = ["KnownDevice", "devices_of"]


class KnownDevice(NamedTuple):
    """A device as it was at one time, and how many recordings it took part in so."""

    device: Device
    recordings: int


def devices_of(store: Store, name: str | None = None) -> tuple[KnownDevice, ...]:
    """All devices, or those of a name: each with its calibrations, the first first, those without a date before.

    A device that is calibrated, or set up otherwise, is another one by content: its earlier recordings keep the
    calibration that held.
    """
    devices, links, recordings = schema.devices, schema.setup_devices.c, schema.recordings.c
    counts = (
        select(links.device_id, func.count().label("count"))
        .join(schema.recordings, recordings.setup_id == links.setup_id)
        .group_by(links.device_id)
        .subquery()
    )
    asked = select(devices.c.digest, devices.c.document, counts.c["count"]).outerjoin(
        counts, counts.c.device_id == devices.c.id
    )
    if name is not None:
        asked = asked.where(devices.c.name == name)
    with reading(store.engine) as connection:
        found = [
            KnownDevice(_device(row[0], row[1]), row[2] or 0)
            for row in connection.execute(asked.order_by(devices.c.id))
        ]
    return tuple(sorted(found, key=lambda one: (one.device.kind, one.device.name, one.device.calibrated_on or "")))


def _device(digest: bytes, document: str) -> Device:
    return Device(**checked_document("devices", digest, document))
