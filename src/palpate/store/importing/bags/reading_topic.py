"""Reading what becomes of one topic: a table of the map."""

from __future__ import annotations

from enum import Enum
from typing import TypeVar

import numpy as np

from palpate.errors import choices
from palpate.network.document import Section
from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import FieldPath
from palpate.store.importing.bags.topics import (
    ChannelFrom,
    Clock,
    FilesFrom,
    Posed,
    PoseFrom,
    ResultFrom,
    SoundFrom,
    Take,
    Topic,
)
from palpate.store.importing.paths import check_name
from palpate.store.quantities import check_quantity

__all__ = ["path_in", "read_topic"]

USES = ("series", "files", "sound", "pose", "result", "log")
SAMPLES = ("uint8", "int16", "int32", "float32")
One = TypeVar("One", bound=Enum)


def read_topic(name: str, section: Section, above: Section) -> Topic:
    """Read a topic; the clock is that of the section above unless it has its own."""
    section.only(["required", "clock", *USES])
    topic = Topic(
        name=name,
        required=section.flag("required"),
        clock=_one(section if "clock" in section else above, "clock", Clock, Clock.HEADER),
        channels=_channels(section),
        files=_files(_short(section, "files", "folder")) if "files" in section else None,
        sound=_sound(_short(section, "sound", "file")) if "sound" in section else None,
        pose=_pose(_short(section, "pose", "of")) if "pose" in section else None,
        result=_result(section.section("result")) if "result" in section else None,
        log=section.flag("log"),
    )
    if not any((topic.channels, topic.files, topic.sound, topic.pose, topic.result, topic.log)):
        raise section.error(f"found nothing that it becomes; {choices(USES)}")
    return topic


def path_in(section: Section, key: str, default: str | None = None) -> FieldPath:
    """The path of a field."""
    text = section.text(key, default)
    try:
        return FieldPath.parse(text)
    except StoreError as error:
        raise section.error(f"found {error}", key) from None


def _short(section: Section, key: str, only: str) -> Section:
    """A table, or the text that stands for a table with this key alone."""
    value = section.need(key, "a table")
    if not isinstance(value, str):
        return section.section(key)
    return Section({only: value}, section.layers, (*section.path, key))


def _one(section: Section, key: str, kind: type[One], default: One | None = None) -> One:
    if key not in section and default is not None:
        return default
    value = section.text(key)
    valid = [one.value for one in kind]
    if value not in valid:
        raise section.error(f"found {value!r}; {choices(valid)}", key)
    return kind(value)


def _channels(section: Section) -> tuple[ChannelFrom, ...]:
    return tuple(
        _channel(series, name, table.section(name, 'a table such as {field = "data"}'))
        for series, table in section.sections("series").items()
        for name in table
    )


def _channel(series: str, name: str, section: Section) -> ChannelFrom:
    section.only(["field", "quantity", "unit"])
    quantity = section.text("quantity", name)
    return ChannelFrom(series, name, path_in(section, "field"), quantity, _unit(section, quantity))


def _unit(section: Section, name: str) -> str | None:
    """A unit that is known, and of the dimension of a quantity or property; None where nobody states one."""
    unit = section.text("unit") if "unit" in section else None
    try:
        check_quantity("unit", unit, name)
    except StoreError as error:
        raise section.error(str(error).removeprefix("unit: "), "unit") from None
    return unit


def _files(section: Section) -> FilesFrom:
    section.only(["folder", "every"])
    return FilesFrom(_name(section, "folder"), _count(section, "every") or 1)


def _sound(section: Section) -> SoundFrom:
    section.only(["file", "rate_hz", "channels", "sample"])
    sample = section.text("sample") if "sample" in section else None
    if sample is not None and sample not in SAMPLES:
        raise section.error(f"found {sample!r}; {choices(SAMPLES)}", "sample")
    dtype = None if sample is None else np.dtype(sample).newbyteorder("<")
    return SoundFrom(_name(section, "file"), _count(section, "rate_hz"), _count(section, "channels"), dtype)


def _pose(section: Section) -> PoseFrom:
    section.only(["of", "field", "frame", "take"])
    take = _one(section, "take", Take, Take.FIRST)
    if take is Take.ALL:
        raise section.error("found 'all'; a recording has one pose, choose from 'first', 'last'", "take")
    path = path_in(section, "field") if "field" in section else None
    return PoseFrom(_one(section, "of", Posed), path, section.text("frame") if "frame" in section else None, take)


def _result(section: Section) -> ResultFrom:
    section.only(["property", "field", "unit", "sd", "sd_field", "labels", "take"])
    if "sd" in section and "sd_field" in section:
        raise section.error("found an SD and a field for it; expected one of them", "sd_field")
    return ResultFrom(
        property=section.text("property"),
        path=path_in(section, "field", "data"),
        unit=_unit(section, section.text("property")),
        sd=section.between("sd", 0, 1e100) if "sd" in section else None,
        sd_path=path_in(section, "sd_field") if "sd_field" in section else None,
        labels=section.names("labels", ()),
        take=_one(section, "take", Take, Take.LAST),
    )


def _name(section: Section, key: str) -> str:
    try:
        return check_name(section.text(key), "found").rstrip("/")
    except StoreError as error:
        raise section.error(str(error).replace("found: ", "found "), key) from None


def _count(section: Section, key: str) -> int | None:
    if key not in section:
        return None
    value = section.positive(key)
    if not value.is_integer():
        raise section.error(f"found {value:g}; expected a whole number", key)
    return int(value)
