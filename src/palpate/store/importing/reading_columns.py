"""Reading a column map from TOML.

::

    action = "squeezing"                # what was done
    series = "robotiq_2f85"             # optional: the name of the gripper, or the action
    rate_hz = 100                       # samples per second, or [time], or neither
    owner = "our lab"                   # optional, as licence, visibility and ground_truth = true
    keep_file = true                    # optional: keep the CSV as a file too

    [time]
    column = "t"
    unit = "ms"

    [channels.position]                 # one for each channel
    column = "pos"                      # optional: the name of the channel
    quantity = "length"                 # optional: the name of the channel
    unit = "mm"                         # optional: nobody knows it

    [results.elasticity]                # any number of them, by property
    column = "E"
    unit = "kPa"                        # optional
    sd = 10                             # or sd_column = "E_sd", optional

    [object]
    dataset = "our lab"
    id = "sponge 3"                     # or column = "object", or pattern = '(?P<id>.+)_[0-9]+[.]csv' on the name
    maker = "somebody"                  # optional, as common_name, beside an id

    [recorded]                          # optional: the time of the file's last change
    column = "time"                     # its first cell; or pattern = '(?P<time>[0-9]{8})' on the name
    format = "%d.%m.%Y %H:%M"           # as Python has it, or "unix"; optional: ISO 8601
    zone = "Europe/Prague"              # optional: UTC

    [setup.gripper]                     # optional, as in the setup of the recorder
    name = "robotiq_2f85"

    [csv]                               # optional, and what stands here unless given
    delimiter = ","
    quote = '"'
    decimal = "."
    encoding = "utf-8"
    lines_before = 0                    # before the names of the columns
"""

from __future__ import annotations

import codecs
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime, tzinfo
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np

from palpate.errors import NetworkError
from palpate.network.document import Section, open_layer
from palpate.store.checks import check
from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.importing.column_times import FileTime, Moment, MomentColumn, MomentInName, TimeColumn, TimeForm
from palpate.store.importing.columns import (
    ChannelColumn,
    ColumnMap,
    NamedThing,
    ResultColumn,
    Thing,
    ThingColumn,
    ThingInName,
)
from palpate.store.importing.csv_table import CsvForm
from palpate.store.importing.setup_tables import setup_from_tables
from palpate.store.records import Channel, Recording, Series, Setup, ThingRef

__all__ = ["read_columns"]

ABOUT = ("owner", "licence", "visibility")
KEYS = ("action", "series", "rate_hz", *ABOUT, "ground_truth", "keep_file")
NEEDED = {
    "action": 'what the robot did, as action = "squeezing"',
    "object": "a table [object] with dataset, and one of id, column and pattern",
}
"""Keys that a map cannot do without, and what they say."""
NONE = np.zeros(0)
TABLES = ("time", "channels", "results", "object", "recorded", "setup", "csv")


def read_columns(path: Path) -> ColumnMap:
    """Read a column map.

    Raises
    ------
    StoreError
        If the file cannot be read, or a key is missing, unknown, or holds something that no recording can have.
    """
    try:
        layer = open_layer(path)
        document = Section(layer.tables, [layer])
        document.only((*KEYS, *TABLES))
        found = _column_map(document)
        _check(found)
    except (NetworkError, StoreError) as error:
        text = str(error)
        raise StoreError(text if text.startswith(str(path)) else f"{path}: {text}") from None
    return found


def _column_map(document: Section) -> ColumnMap:
    for key, what in NEEDED.items():
        if key not in document:
            raise document.error(f"found no {key!r}; expected {what}")
    setup = setup_from_tables(document.section("setup").tables, "setup") if "setup" in document else Setup()
    action = document.text("action")
    if "time" in document and "rate_hz" in document:
        raise document.error("found time stamps as well as a rate; expected one of them", "rate_hz")
    about = {key: document.text(key) for key in ABOUT if key in document}
    return ColumnMap(
        action=action,
        thing=_thing(document.section("object")),
        series=document.text("series", setup.gripper.name if setup.gripper else action),
        channels=tuple(_channel(name, part) for name, part in _channels(document).items()),
        recorded=_moment(document.section("recorded")) if "recorded" in document else FileTime(),
        setup=setup,
        results=tuple(_result(name, part) for name, part in document.sections("results").items()),
        time=_time(document.section("time")) if "time" in document else None,
        rate_hz=document.positive("rate_hz") if "rate_hz" in document else None,
        about={**about, "ground_truth": document.flag("ground_truth")},
        keep_file=document.flag("keep_file"),
        form=_form(document.section("csv")) if "csv" in document else CsvForm(),
    )


def _channels(document: Section) -> Mapping[str, Section]:
    found = document.sections("channels")
    if not found:
        raise document.error("found no channels; expected a table [channels.NAME] for each column with samples")
    return found


def _thing(section: Section) -> Thing:
    ways = [key for key in ("id", "column", "pattern") if key in section]
    if len(ways) != 1:
        found = " and ".join(ways) or "none of id, column and pattern"
        raise section.error(f"found {found}; expected one of them to name the object")
    if ways == ["id"]:
        section.only(("dataset", "id", "maker", "common_name"))
        maker, common_name = (section.text(key) if key in section else None for key in ("maker", "common_name"))
        return NamedThing(ThingRef(section.text("dataset"), section.text("id"), maker, common_name))
    section.only(("dataset", *ways))
    if ways == ["column"]:
        return ThingColumn(section.text("column"), section.text("dataset"))
    pattern = _pattern(section, "id")
    return ThingInName(pattern, None if "dataset" in pattern.groupindex else section.text("dataset"))


def _moment(section: Section) -> Moment:
    section.only(("column", "pattern", "format", "zone"))
    if ("column" in section) == ("pattern" in section):
        found = "both column and pattern" if "column" in section else "neither column nor pattern"
        raise section.error(f"found {found}; expected one of them to say when it was recorded")
    form = TimeForm(section.text("format") if "format" in section else None, _zone(section))
    if "column" in section:
        return MomentColumn(section.text("column"), form)
    return MomentInName(_pattern(section, "time"), form)


def _pattern(section: Section, group: str) -> re.Pattern[str]:
    try:
        with warnings.catch_warnings():
            # what it may mean to a later Python is none of the user's
            warnings.simplefilter("ignore", FutureWarning)
            pattern = re.compile(section.text("pattern"))
    except re.error as error:
        raise section.error(f"found no regular expression ({error})", "pattern") from None
    if group not in pattern.groupindex:
        raise section.error(f"found {pattern.pattern!r}; expected a group (?P<{group}>...) in it", "pattern")
    return pattern


def _zone(section: Section) -> tzinfo | None:
    if "zone" not in section:
        return None
    name = section.text("zone")
    try:
        return ZoneInfo(name)
    except (OSError, ValueError, KeyError):
        raise section.error(f"found {name!r}; expected a time zone such as 'Europe/Prague' or 'UTC'", "zone") from None


def _channel(name: str, section: Section) -> ChannelColumn:
    section.only(("column", "quantity", "unit"))
    unit = section.text("unit") if "unit" in section else None
    return ChannelColumn(name, section.text("column", name), section.text("quantity", name), unit)


def _result(name: str, section: Section) -> ResultColumn:
    section.only(("column", "unit", "sd", "sd_column"))
    return ResultColumn(
        property=name,
        column=section.text("column", name),
        unit=section.text("unit") if "unit" in section else None,
        sd=section.positive("sd") if "sd" in section else None,
        sd_column=section.text("sd_column") if "sd_column" in section else None,
    )


def _time(section: Section) -> TimeColumn:
    section.only(("column", "unit"))
    return TimeColumn(section.text("column"), section.text("unit"))


def _form(section: Section) -> CsvForm:
    section.only(("delimiter", "quote", "decimal", "encoding", "lines_before"))
    form = CsvForm(
        delimiter=section.text("delimiter", ","),
        quote=section.text("quote", '"'),
        decimal=section.text("decimal", "."),
        encoding=_encoding(section),
        lines_before=int(section.between("lines_before", 0, 10_000, 0)),
    )
    for key in ("delimiter", "quote"):
        if len(getattr(form, key)) != 1 or getattr(form, key) in "\r\n":
            raise section.error(f"found {getattr(form, key)!r}; expected one character", key)
    if form.decimal not in (".", ","):
        raise section.error(f"found {form.decimal!r}; expected '.' or ','", "decimal")
    if form.delimiter in (form.decimal, form.quote):
        raise section.error(f"found {form.delimiter!r} for two things; expected another character", "delimiter")
    return form


def _encoding(section: Section) -> str:
    name = section.text("encoding", "utf-8")
    try:
        # what some programs write before UTF-8 is no part of the first name
        return "utf-8-sig" if codecs.lookup(name).name == "utf-8" else name
    except LookupError:
        raise section.error(f"found {name!r}; expected an encoding such as 'utf-8' or 'latin-1'", "encoding") from None


def _check(found: ColumnMap) -> None:
    """Refuse what no recording may have, before there is one, by the words of the map."""
    thing = found.thing.ref if isinstance(found.thing, NamedThing) else ThingRef("some", "object")
    plain = Recording(datetime(1970, 1, 2, tzinfo=UTC), found.action, thing, found.setup, **found.about)
    with _told_as("thing", "object"), _told_as("series[0].name", "series"):
        check(replace(plain, series=(Series(found.series, ()),)))
    channels = {f"channels.{one.name}": Channel(one.name, one.quantity, one.unit, NONE) for one in found.channels}
    if found.time is not None:
        channels["time"] = Channel("time", "time", found.time.unit, NONE)
    for where, channel in channels.items():
        with _told_as(f"series[0].{channel.name}", where):
            check(replace(plain, series=(Series(found.series, (channel,)),)))
    for one in found.results:
        with _told_as("entries[0]", f"results.{one.property}"):
            check(replace(plain, entries=(Value(one.property, 0.0, one.sd, one.unit),)))


@contextmanager
def _told_as(place: str, where: str) -> Iterator[None]:
    """Let an error about a place in a recording name the place in the map that it comes from."""
    try:
        yield
    except StoreError as error:
        text = str(error)
        raise StoreError(where + text.removeprefix(place) if text.startswith(place) else text) from None
