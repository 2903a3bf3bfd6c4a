"""What the messages of one topic become in one recording, gathered as they come and put in order at the end."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.store.entries import Entry
from palpate.store.importing.bags.files import Files, Spill
from palpate.store.importing.bags.logs import log_line
from palpate.store.importing.bags.poses import pose_in
from palpate.store.importing.bags.results import result_in
from palpate.store.importing.bags.samples import Samples
from palpate.store.importing.bags.sounds import Sound
from palpate.store.importing.bags.stamps import oddities, order_of, seconds, stamp_of
from palpate.store.importing.bags.topics import Clock, PoseFrom, ResultFrom, Take, Topic
from palpate.store.records import Channel, FileItem, Pose

__all__ = ["Gathering"]


class Gathering:
    """Gathers the messages of one topic; the other methods are for when all were taken."""

    def __init__(self, topic: Topic, spill: Spill) -> None:
        self.topic, self.spill = topic, spill
        self._stamps, self._logged = array("q"), array("q")
        self._absent = self._unset = 0
        self._told: Counter[str] = Counter()
        self._samples = [Samples(topic.name, channel) for channel in topic.channels]
        self._files = Files(topic.files, topic.name, spill) if topic.files else None
        self._sound = Sound(topic.sound, topic.name) if topic.sound else None
        self._chosen = [Chosen(use) for use in (topic.pose, topic.result) if use]
        self._lines: list[tuple[int, str]] = []

    def __len__(self) -> int:
        """How many messages there are."""
        return len(self._stamps)

    def take(self, message: Any, log_ns: int) -> None:
        """Add a message, and when it was written [ns]; StoreError where it is none for what the map says."""
        stamp_ns = stamp_of(message) if self.topic.clock is Clock.HEADER else log_ns
        if not stamp_ns:
            self._unset += stamp_ns is not None
            self._absent += stamp_ns is None
            stamp_ns = log_ns
        place = len(self)
        self._stamps.append(stamp_ns)
        self._logged.append(log_ns)
        for samples in self._samples:
            samples.take(message, place)
        if self._files:
            self._files.take(message, place)
        if self._sound:
            self._sound.take(message, log_ns)
        for chosen in self._chosen:
            chosen.take(message, log_ns)
        if self.topic.log:
            self._lines.append((stamp_ns, log_line(message, self.topic.name)))

    def channels(self, start_ns: int) -> Iterator[tuple[str, Channel]]:
        """Series and channel of what becomes samples, and of where files and sounds are in time."""
        everything = np.arange(len(self))
        for samples in self._samples:
            values, places = samples.values(), np.frombuffer(samples.places, np.int64)
            order = order_of(self.logged_ns[places])
            made = samples.channel
            time_s = seconds(self.stamps_ns[places[order]], start_ns)
            yield made.series, Channel(made.name, made.quantity, made.unit, values[order], time_s=time_s)
        if self._files:
            places = everything[:: self._files.wanted.every]
            order = places[order_of(self.logged_ns[places])]
            yield self._files.wanted.folder, _index("file", np.arange(len(order)), self.stamps_ns[order], start_ns)
        if self._sound:
            stamps_ns = self.stamps_ns[order_of(self.logged_ns)]
            yield self._sound.wanted.file, _index(self._sound.counts, self._sound.beginnings(), stamps_ns, start_ns)

    def files(self) -> Iterator[FileItem]:
        """Images, clouds and sounds."""
        if self._files:
            yield from self._files.items(order_of(self.logged_ns[:: self._files.wanted.every]))
        if self._sound:
            yield self._sound.item(self.spill)

    def pose(self) -> Pose | None:
        """The pose, where the topic has one."""
        for chosen in self._chosen:
            if isinstance(chosen.use, PoseFrom):
                return pose_in(chosen.messages[0], chosen.use, self.topic.name, self._tell)
        return None

    def entries(self) -> list[Entry]:
        """The results."""
        return [
            result_in(message, chosen.use, self.topic.name, self._tell)
            for chosen in self._chosen
            if isinstance(chosen.use, ResultFrom)
            for message in chosen.messages
        ]

    def lines(self) -> list[tuple[int, str]]:
        """Lines of the log, each with its time [ns]."""
        return self._lines

    def notices(self, start_ns: int) -> Iterator[str]:
        """What was odd; for after all else was asked."""
        name = self.topic.name
        # a type without stamps is no surprise
        lacking = self._unset + self._absent
        if lacking and self._absent < len(self):
            yield f"{name}: {lacking} of {len(self)} messages have no time stamp: when they were written is taken"
        order = order_of(self.logged_ns)
        yield from oddities(name, self.stamps_ns[order], self.logged_ns[order], start_ns)
        for samples in self._samples:
            if without := len(self) - len(samples.places):
                path = samples.channel.path.text
                yield f"{name}: {without} of {len(self)} messages hold no {path}: the channel has the others"
        for chosen in self._chosen:
            if chosen.use.take is not Take.ALL and len(self) > 1:
                use = "result" if isinstance(chosen.use, ResultFrom) else chosen.use.of.value
                yield f"{name}: the {use} is the {chosen.use.take.value} of {len(self)} messages"
        if self._files and self._files.wanted.every > 1:
            yield f"{name}: {self._files.count} of {len(self)} messages became files, as the map says"
        for text, count in self._told.items():
            yield text if count == 1 else f"{text} ({count} times)"

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """Time stamps [ns], in the order in which messages were taken."""
        return np.array(self._stamps, np.int64)

    @property
    def logged_ns(self) -> NDArray[np.int64]:
        """When the messages were written [ns], in that order."""
        return np.array(self._logged, np.int64)

    def _tell(self, text: str) -> None:
        self._told[text] += 1


class Chosen:
    """The messages of which one use wants the first, the last or all."""

    def __init__(self, use: PoseFrom | ResultFrom) -> None:
        self.use = use
        self._taken: list[tuple[int, Any]] = []

    def take(self, message: Any, log_ns: int) -> None:
        """Add a message, or let it go."""
        take = self.use.take
        if take is Take.ALL or not self._taken:
            self._taken.append((log_ns, message))
        elif log_ns < self._taken[0][0] if take is Take.FIRST else log_ns >= self._taken[0][0]:
            self._taken = [(log_ns, message)]

    @property
    def messages(self) -> list[Any]:
        """What was chosen, in the order in which it was written."""
        return [message for _, message in sorted(self._taken, key=lambda one: one[0])]


def _index(name: str, values: NDArray[np.int64], stamps_ns: NDArray[np.int64], start_ns: int) -> Channel:
    return Channel(name, "index", None, values, time_s=seconds(stamps_ns, start_ns))
