"""Making recordings of the messages of a bag."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime

from palpate.errors import choices, near
from palpate.store.errors import StoreError
from palpate.store.importing.bags.cutting import Span
from palpate.store.importing.bags.files import Spill
from palpate.store.importing.bags.gathering import Gathering
from palpate.store.importing.bags.packets import LATEST_NS, translated
from palpate.store.importing.bags.reading import Reading
from palpate.store.importing.bags.topics import Posed, TopicMap
from palpate.store.records import Channel, Pose, Recording, Series, ThingRef
from palpate.store.rows import moment_at

__all__ = ["Making"]

BEFORE_BAGS = datetime(2007, 1, 1, tzinfo=UTC)
"""Before there was ROS: a clock that says so is that of a simulation."""

Gathered = Mapping[str, Gathering]


class Making:
    """Makes recordings."""

    def __init__(self, topics: TopicMap, reading: Reading, spill: Spill) -> None:
        self._map, self._reading, self._spill = topics, reading, spill

    def recordings(self) -> Iterator[Recording]:
        """All recordings, once all messages are read.

        Raises
        ------
        StoreError
            If the bag does not hold what the map asks for.
        """
        spans = self._reading.spans()
        gathered = [{topic.name: Gathering(topic, self._spill) for topic in self._map.topics} for _ in spans]
        for packet in self._reading.packets({topic.name for topic in self._map.topics}):
            name = packet.kind.topic
            takers = [into[name] for span, into in zip(spans, gathered, strict=True) if packet.log_ns in span]
            if takers:
                with translated(f"{name}: a message cannot be read", f"one of type {packet.kind.type!r}"):
                    message = self._reading.decoded(packet)
                    for taker in takers:
                        taker.take(message, packet.log_ns)
        for span, into in zip(spans, gathered, strict=True):
            start_ns = max(span.start_ns, self._reading.first_ns)
            with translated("cannot be read", "messages that fit together"):
                yield self._recording(replace(span, start_ns=start_ns), into)

    def _recording(self, span: Span, gathered: Gathered) -> Recording:
        found = {name: gathering for name, gathering in gathered.items() if len(gathering)}
        self._refuse_missing(found, span)
        # recordings know microseconds, and their time stamps count from there
        start_ns = span.start_ns // 1000 * 1000
        recorded_at = moment_at(start_ns // 1000)
        action = span.cut.action or self._map.action
        if self._map.action_from and not span.cut.action:
            action = self._reading.text(self._map.action_from, span)
        recording = Recording(
            recorded_at=recorded_at,
            action=action,
            thing=self._thing(span),
            setup=self._map.setup,
            owner=self._map.owner,
            licence=self._map.licence,
            visibility=self._map.visibility,
            ground_truth=self._map.ground_truth,
            software=self._map.software,
            repository=self._map.repository,
            gripper_pose=_pose(found, Posed.GRIPPER),
            object_pose=_pose(found, Posed.OBJECT),
            series=_series(found, start_ns),
            files=tuple(item for gathering in found.values() for item in gathering.files()),
            entries=tuple(entry for gathering in found.values() for entry in gathering.entries()),
            log=_log(found, start_ns),
        )
        return replace(recording, notices=tuple(self._notices(span, found, recorded_at, start_ns)))

    def _thing(self, span: Span) -> ThingRef:
        if span.cut.thing is not None or self._map.id_from is None:
            return span.cut.thing or self._map.thing
        return replace(self._map.thing, id=self._reading.text(self._map.id_from, span))

    def _refuse_missing(self, found: Gathered, span: Span) -> None:
        topics = self._reading.topics
        for topic in self._map.topics:
            if topic.required and topic.name not in found:
                told = f"{near(topic.name, topics)}; {choices(topics)}" if topics else ", nor of any other topic"
                raise StoreError(f"{_place(span)}there is no message of {topic.name}, which the map requires{told}")
        if not found:
            raise StoreError(f"{_place(span)}there is no message of a topic of the map; it has {', '.join(topics)}")

    def _notices(self, span: Span, found: Gathered, recorded_at: datetime, start_ns: int) -> Iterator[str]:
        if recorded_at < BEFORE_BAGS:
            yield f"the bag's clock begins at {recorded_at:%F %T}, which may be a simulation's: it is kept"
        yield from self._reading.notices()
        yield from span.notices
        topics = self._reading.topics
        if lacking := [topic.name for topic in self._map.topics if topic.name not in found]:
            yield f"{_place(span)}there is no message of {', '.join(lacking)}, which the map names"
        known = {topic.name for topic in self._map.topics} | self._map.told_by
        if unnamed := [name for name in topics if name not in known]:
            yield f"the map does not name {', '.join(unnamed)}: what the bag holds there is not imported"
        for gathering in found.values():
            yield from gathering.notices(start_ns)


def _place(span: Span) -> str:
    """Which recording, where there are several."""
    return "" if span.stop_ns > LATEST_NS else f"up to {moment_at(span.stop_ns // 1000):%F %T} "


def _pose(found: Gathered, of: Posed) -> Pose | None:
    held = (gathering for gathering in found.values() if gathering.topic.pose and gathering.topic.pose.of is of)
    return next((pose for gathering in held if (pose := gathering.pose()) is not None), None)


def _series(found: Gathered, start_ns: int) -> tuple[Series, ...]:
    series: dict[str, list[Channel]] = {}
    for gathering in found.values():
        for name, channel in gathering.channels(start_ns):
            series.setdefault(name, []).append(channel)
    return tuple(Series(name, tuple(channels)) for name, channels in series.items())


def _log(found: Gathered, start_ns: int) -> str:
    lines = sorted((line for gathering in found.values() for line in gathering.lines()), key=lambda line: line[0])
    return "".join(f"{(stamp_ns - start_ns) / 1e9:.6f} {text}\n" for stamp_ns, text in lines)
