"""Whether a recording may be kept; the error names the field that is wrong."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

from palpate.errors import choices
from palpate.network.units import UnitError, dimension_of, factor, unit_of
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.errors import StoreError
from palpate.store.implausible import implausible
from palpate.store.known_units import are_alike
from palpate.store.quantities import check_quantity
from palpate.store.records import DEVICE_KINDS, VISIBILITIES, Device, FileItem, Pose, Recording, Setup, ThingRef
from palpate.store.signals import check_series
from palpate.store.sizes import check_amounts, check_sizes
from palpate.store.texts import (
    LARGEST_SI,
    check_encoding,
    check_json,
    check_length,
    check_name,
    check_number,
    check_numbers,
    check_text,
    check_visible,
)

__all__ = ["check", "check_embargo", "check_entry", "check_moment", "check_thing", "check_unit", "check_unit_of"]

CLOCKS_DIFFER = timedelta(minutes=1)
SUM_TOLERANCE = 1e-6
# numbers of entries
NEEDED = ("value", "low", "high")
OPTIONAL = ("sd", "above", "below")


def check(
    recording: Recording,
    *,
    units: Mapping[str, str | None] | None = None,
    now: datetime | None = None,
    is_new: bool = True,
) -> None:
    """Refuse a recording that cannot be kept.

    Parameters
    ----------
    recording
        What is to be kept.
    units
        For each property whose dimension is known, a unit of that dimension.
    now
        The present, to which a recording may be ahead by a minute, as clocks differ.
    is_new
        Whether no store has had it. What one has kept may be older than the dimension of a quantity that everybody
        knows by now (see `palpate.store.quantities`) and than the limits of `palpate.store.sizes` and of names, and
        is not held to them.

    Raises
    ------
    StoreError
        Naming the field: an empty name, one that is too long or has a letter that nobody sees, an unknown unit
        or one of another dimension, a number that is not finite, probabilities that do not sum to one,
        channels that do not fit together, a time in the future or without a time zone, a result that is said to be
        true and cannot be, a file that is not there, a value that JSON cannot hold, more than one measurement says.

    Examples
    --------
    >>> from palpate.store.records import ThingRef
    >>> moment = datetime(2024, 5, 1, tzinfo=UTC)
    >>> mug = ThingRef("ycb", "025_mug")
    >>> check(Recording(moment, "weighing", mug, entries=(Value("mass", float("nan"), unit="g"),)))
    Traceback (most recent call last):
    palpate.store.errors.StoreError: entries[0].value: found nan, expected a finite number
    """
    if is_new:
        check_amounts(recording)
    check_moment("recorded_at", recording.recorded_at, now or datetime.now(UTC))
    check_name("action", recording.action)
    check_thing(recording.thing, is_new=is_new)
    _check_setup(recording.setup)
    if recording.visibility not in VISIBILITIES:
        raise StoreError(f"visibility: found {recording.visibility!r}; {choices(VISIBILITIES)}")
    check_embargo(recording.embargoed_until)
    for field in ("owner", "licence", "software", "repository"):
        check_text(field, getattr(recording, field))
    if is_new:
        _check_visible(recording)
    check_json("grasp", recording.grasp)
    _check_pose("gripper_pose", recording.gripper_pose)
    _check_pose("object_pose", recording.object_pose)
    check_series(recording.series, are_new=is_new)
    _check_files(recording.files)
    for place, entry in enumerate(recording.entries):
        check_entry(f"entries[{place}]", entry, units or {}, is_new=is_new)
    if is_new and recording.ground_truth and (faults := implausible(recording)):
        raise StoreError(faults[0])
    check_encoding("log", recording.log)
    for place, notice in enumerate(recording.notices):
        check_text(f"notices[{place}]", notice)
    if is_new:
        check_sizes(recording)


def check_moment(where: str, moment: datetime, now: datetime) -> None:
    """Refuse a time without a time zone, in the future or before there were robots that record."""
    if moment.utcoffset() is None:
        raise StoreError(f"{where}: {moment.isoformat()} has no time zone; expected one, such as UTC")
    if moment > now + CLOCKS_DIFFER:
        raise StoreError(f"{where}: {moment.isoformat()} is in the future; expected a time before {now:%F %T} UTC")
    if moment.year < 1970:
        raise StoreError(f"{where}: {moment.isoformat()} is before 1970; expected the time of the measurement")


def check_embargo(moment: datetime | None) -> None:
    """Refuse the end of an embargo that has no time zone, or is not of this age."""
    if moment is None:
        return
    if moment.utcoffset() is None:
        raise StoreError(f"embargoed_until: {moment.isoformat()} has no time zone; expected one, such as UTC")
    if not 1970 < moment.year < 9999:
        raise StoreError(f"embargoed_until: found the year {moment.year}, expected one after 1970 and before 9999")


def _check_visible(recording: Recording) -> None:
    """Refuse names of which a part is hidden, or that are too long; what a store has kept may be older than this."""
    setup = recording.setup
    devices = [(f"setup.{kind}", getattr(setup, kind)) for kind in DEVICE_KINDS[:-1]]
    devices += [(f"setup.other[{place}]", device) for place, device in enumerate(setup.other)]
    check_visible("action", recording.action)
    check_visible("owner", recording.owner)
    for where, device in devices:
        if device is not None:
            check_visible(f"{where}.name", device.name)
            check_visible(f"{where}.maker", device.maker)


def check_thing(thing: ThingRef, *, is_new: bool = False) -> None:
    """Refuse a description of an object that cannot be kept; of a new one also names that `check_visible` refuses."""
    check_name("thing.dataset", thing.dataset)
    check_name("thing.id", thing.id)
    check_text("thing.maker", thing.maker)
    check_text("thing.common_name", thing.common_name)
    if not isinstance(thing.attributes, Mapping):
        raise StoreError(f"thing.attributes: found {type(thing.attributes).__name__}, expected names with values")
    check_json("thing.attributes", thing.attributes)
    for place, alias in enumerate(thing.aliases):
        check_name(f"thing.aliases[{place}]", alias)
    if is_new:
        names = {name: getattr(thing, name) for name in ("dataset", "id", "maker", "common_name")}
        names |= {f"aliases[{place}]": alias for place, alias in enumerate(thing.aliases)}
        for name, text in names.items():
            check_visible(f"thing.{name}", text)


def _check_setup(setup: Setup) -> None:
    for kind in DEVICE_KINDS[:-1]:
        device = getattr(setup, kind)
        if device is not None:
            _check_device(f"setup.{kind}", device)
            if device.kind != kind:
                raise StoreError(f"setup.{kind}.kind: found {device.kind!r}, expected {kind!r}")
    for place, device in enumerate(setup.other):
        _check_device(f"setup.other[{place}]", device)


def _check_device(where: str, device: Device) -> None:
    if device.kind not in DEVICE_KINDS:
        raise StoreError(f"{where}.kind: found {device.kind!r}; {choices(DEVICE_KINDS)}")
    check_name(f"{where}.name", device.name)
    check_text(f"{where}.maker", device.maker)
    _check_date(f"{where}.calibrated_on", device.calibrated_on)
    check_json(f"{where}.parameters", device.parameters)
    check_json(f"{where}.calibration", device.calibration)


def _check_date(where: str, date: object) -> None:
    check_text(where, date)
    try:
        datetime.fromisoformat(str(date or "2024-05-01"))
    except ValueError:
        raise StoreError(f"{where}: found {date!r}, expected a date such as 2024-05-01") from None


def _check_pose(where: str, pose: Pose | None) -> None:
    if pose is None:
        return
    check_numbers(f"{where}.translation_m", pose.translation_m, 3)
    if pose.quaternion is not None:
        check_numbers(f"{where}.quaternion", pose.quaternion, 4)
        if abs(math.hypot(*pose.quaternion) - 1) > 1e-3:
            raise StoreError(f"{where}.quaternion: length {math.hypot(*pose.quaternion):.4g}, expected 1")
    check_name(f"{where}.frame", pose.frame)
    check_json(f"{where}.original", pose.original)


def _check_files(files: Sequence[FileItem]) -> None:
    names = [item.name for item in files]
    for place, item in enumerate(files):
        check_name(f"files[{place}].name", item.name)
        check_name(f"files[{place}].media_type", item.media_type)
        if names.index(item.name) < place:
            raise StoreError(f"files[{place}].name: a second file {item.name!r}, expected names of their own")
        if isinstance(item.data, Path) and not item.data.is_file():
            raise StoreError(f"files[{place}].data: there is no file {str(item.data)!r}, expected one that can be read")


def check_entry(where: str, entry: Entry, units: Mapping[str, str | None], *, is_new: bool = True) -> None:
    """Refuse a result that cannot be kept; `units` and `is_new` as for `check`."""
    if is_new:
        _check_lengths(where, entry)
    if isinstance(entry, FailedEntry):
        check_name(f"{where}.reason", entry.reason)
        check_text(f"{where}.property", entry.property)
        return
    check_name(f"{where}.property", entry.property)
    if isinstance(entry, Distribution):
        _check_probabilities(where, entry.probabilities)
        return
    for name, value in vars(entry).items():
        if name in NEEDED or (name in OPTIONAL and value is not None):
            check_number(f"{where}.{name}", value)
    _check_order(where, entry)
    check_unit(f"{where}.unit", entry.unit, units.get(entry.property))
    if is_new:
        check_quantity(f"{where}.unit", entry.unit, entry.property)
        _check_magnitudes(where, entry)


def _check_lengths(where: str, entry: Entry) -> None:
    """Refuse a property or a label of which the name is too long."""
    check_length(f"{where}.property", entry.property)
    if isinstance(entry, Distribution):
        for label in entry.probabilities:
            check_length(f"{where}.probabilities", label)


def _check_magnitudes(where: str, entry: Value | Interval | Bound) -> None:
    """Refuse what no measurement gives, and of which not even the square is a number."""
    scale = 1.0 if entry.unit is None else unit_of(entry.unit).factor
    for name in (*NEEDED, *OPTIONAL):
        value = getattr(entry, name, None)
        if value is not None and abs(float(value) * scale) > LARGEST_SI:
            told = f"expected a number of which the amount in SI units is {LARGEST_SI:g} at most"
            raise StoreError(f"{where}.{name}: found {value}, {told}")


def _check_order(where: str, entry: Value | Interval | Bound) -> None:
    if isinstance(entry, Value) and entry.sd is not None and entry.sd < 0:
        raise StoreError(f"{where}.sd: found {entry.sd}, expected zero or more")
    if isinstance(entry, Interval) and entry.low > entry.high:
        raise StoreError(f"{where}.low: {entry.low} is above {entry.high}, expected the lower end")
    if isinstance(entry, Bound) and (entry.above is None) == (entry.below is None):
        raise StoreError(f"{where}: above is {entry.above} and below is {entry.below}, expected exactly one of them")


def check_unit(where: str, unit: str | None, known: str | None) -> None:
    """Refuse a unit that is unknown, or has another dimension than `known`."""
    if unit is None:
        return
    check_name(where, unit)
    try:
        unit_of(unit) if known is None else factor(unit, known)
    except UnitError as error:
        raise StoreError(f"{where}: {error}") from None


def check_unit_of(where: str, name: str, unit: str, known: str | None) -> None:
    """As `check_unit` for the unit that a store has of a property, which is not told: what is private may have it.

    Raises
    ------
    StoreError
        If the unit is unknown, or of another dimension.
    """
    check_unit(where, unit, None)
    if known is not None and not are_alike(unit, known):
        raise StoreError(
            f"{where}: unit {unit!r} is {dimension_of(unit)}; expected the dimension that {name} has in this store"
        )


def _check_probabilities(where: str, probabilities: Mapping[str, float]) -> None:
    for label, probability in probabilities.items():
        check_name(f"{where}.probabilities", label)
        check_number(f"{where}.probabilities[{label!r}]", probability)
        if probability < 0:
            raise StoreError(f"{where}.probabilities[{label!r}]: found {probability}, expected zero or more")
    total = math.fsum(probabilities.values())
    if abs(total - 1) > SUM_TOLERANCE:
        raise StoreError(f"{where}.probabilities: sum to {total:.7g}, expected 1")
