"""One recording in the terminal, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from palpate.cli.store_view import entry_words
from palpate.cli.terminal import ENDLESS, bullets, folding_table
from palpate.store.content import in_utc, setup_plain, thing_plain
from palpate.wording import number, plural

if TYPE_CHECKING:
    from palpate.store.records import Channel, Device, Pose, Recording, Setup, ThingRef

__all__ = ["recording_json", "recording_view"]

SEEN_BY = {"private": "the owner", "lab": "the lab", "public": "everybody"}

ALL, LOG_LINES = 1000, 20


def recording_view(recording: Recording) -> RenderableType:
    """All of a recording but its numbers and the bytes of its files."""
    thing = recording.thing
    parts: list[RenderableType] = [
        Text.assemble((recording.action, "bold"), " of ", (thing.common_name or thing.id, "bold")),
        Text(),
        _facts(recording),
    ]
    for title, part in (
        ("results", _results(recording)),
        ("series", _series(recording)),
        ("files", _files(recording)),
        ("setup", _devices(recording.setup)),
        ("poses", _poses(recording)),
    ):
        if part is not None:
            parts += [Text(), Text(title, style="bold underline"), part]
    if recording.notices:
        parts += [Text(), Text("what was odd", style="bold underline")]
        parts.append(bullets(recording.notices))
    if recording.log:
        parts += [Text(), Text("log", style="bold underline"), *_log(recording.log)]
    return Group(*parts)


def recording_json(recording: Recording) -> str:
    """The same for programs, valid whatever it is printed on."""
    plain = json.loads(recording.document)
    setup = {kind: value for kind, value in setup_plain(recording.setup).items() if value}
    shown = {**plain, "id": str(recording.id), "digest": recording.digest, "visibility": recording.visibility}
    if recording.embargoed_until is not None:
        shown["embargoed_until"] = in_utc(recording.embargoed_until)
    shown |= {"thing": thing_plain(recording.thing), "setup": setup, "log": recording.log}
    return json.dumps({name: value for name, value in shown.items() if value not in (None, [], "")}, indent=1)


def _facts(recording: Recording) -> Table:
    table = Table.grid(padding=(0, 2))
    told: Mapping[str, str | None] = {
        "recording": str(recording.id),
        "digest": recording.digest,
        "recorded (UTC)": f"{recording.recorded_at:%Y-%m-%d %H:%M:%S}",
        "object": _thing(recording.thing),
        "ground truth": "yes" if recording.ground_truth else None,
        "owner": recording.owner,
        "licence": recording.licence,
        "visible to": SEEN_BY.get(recording.visibility),
        "embargoed until": in_utc(recording.embargoed_until) if recording.embargoed_until else None,
        "software": recording.software,
        "repository": recording.repository,
        "grasp": _words(recording.grasp) if recording.grasp else None,
    }
    for name, value in told.items():
        if value:
            table.add_row(name, Text(value, overflow="fold"))
    return table


def _thing(thing: ThingRef) -> str:
    more = {"called": thing.common_name, "maker": thing.maker, "aliases": ", ".join(thing.aliases)}
    words = [f"{name} {value}" for name, value in more.items() if value]
    words += [f"{name} {_words(value)}" for name, value in thing.attributes.items()]
    return " ".join([f"{thing.dataset}/{thing.id}", *([f"({'; '.join(words)})"] if words else [])])


def _results(recording: Recording) -> RenderableType | None:
    lines = [Text(entry_words(entry, most=ALL), overflow="fold") for entry in recording.entries]
    return Group(*lines) if lines else None


def _series(recording: Recording) -> Table | None:
    table = folding_table("series", "channel", "quantity", "unit", "samples", "rate", right=(4,))
    for series in recording.series:
        for channel in series.channels:
            samples = " x ".join(map(str, channel.values.shape))
            unit = channel.unit or "not stated"
            table.add_row(series.name, channel.name, channel.quantity, unit, samples, _rate(channel))
    return table if table.row_count else None


def _rate(channel: Channel) -> str:
    if channel.time_s is not None and len(channel.time_s):
        return f"stamps, {number(channel.time_s.min())} to {number(channel.time_s.max())} s"
    return "not known" if channel.rate_hz is None else f"{channel.rate_hz:g} Hz"


def _files(recording: Recording) -> Table | None:
    table = folding_table("file", "type", "bytes", right=(2,))
    for item in recording.files:
        size = len(item.data) if isinstance(item.data, bytes) else item.data.stat().st_size
        table.add_row(item.name, item.media_type, f"{size:,}")
    return table if recording.files else None


def _devices(setup: Setup) -> RenderableType:
    return _Devices(setup.devices) if setup.devices else Text("none stated")


@dataclass(frozen=True)
class _Devices:
    """The devices of a setup: a table where a row is a line, else one below the other, each as wide as there is room.

    Parameters of simulated devices are many, and in a column of a narrow table a word would be a line.
    """

    devices: Sequence[Device]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Lay the devices out for the width there is."""
        table = folding_table("kind", "device", "maker", "parameters", "calibration")
        for device in self.devices:
            table.add_row(device.kind, device.name, device.maker or "", _words(device.parameters), _calibrated(device))
        if console.measure(table, options=options.update(max_width=ENDLESS)).maximum <= options.max_width:
            yield table
            return
        for device in self.devices:
            maker = f" by {device.maker}" if device.maker else ""
            yield Text.assemble(f"{device.kind}  ", (device.name, "bold"), maker, overflow="fold")
            for title, told in (("", _words(device.parameters)), ("calibration ", _calibrated(device))):
                if told:
                    yield Padding(Text(f"{title}{told}", overflow="fold"), (0, 0, 0, 2))


def _calibrated(device: Device) -> str:
    return " ".join(filter(None, (device.calibrated_on, _words(device.calibration))))


def _poses(recording: Recording) -> Table | None:
    table = folding_table("of", "x, y, z [m]", "quaternion w, x, y, z", "frame")
    poses: Mapping[str, Pose | None] = {"gripper": recording.gripper_pose, "object": recording.object_pose}
    for name, pose in poses.items():
        if pose is not None:
            turn = "not known" if pose.quaternion is None else _numbers(pose.quaternion)
            table.add_row(name, _numbers(pose.translation_m), turn, pose.frame)
    return table if table.row_count else None


def _numbers(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.4g}" for value in values)


def _log(text: str) -> Iterator[Text]:
    lines = text.splitlines()
    yield from map(Text, lines[:LOG_LINES])
    if len(lines) > LOG_LINES:
        yield Text(f"and {plural(len(lines) - LOG_LINES, 'more line')} (--json has them all)", style="dim")


def _words(value: Any) -> str:
    """Anything that JSON can hold, in a line."""
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_words(part)}" for name, part in value.items())
    return value if isinstance(value, str) else json.dumps(value)
