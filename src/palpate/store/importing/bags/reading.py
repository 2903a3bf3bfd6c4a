"""Reading the messages of a bag and decoding those that are wanted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from typing import Any

from palpate.store.errors import StoreError
from palpate.store.importing.bags.cutting import Span, Texts, spans_of
from palpate.store.importing.bags.definitions import Decode, Decoders, releases
from palpate.store.importing.bags.opening import Bag
from palpate.store.importing.bags.packets import LATEST_NS, Kind, Packet, translated
from palpate.store.importing.bags.topics import TextFrom, TopicMap

__all__ = ["Reading"]


class Reading:
    """Reads a bag: first what tells where its recordings are, where the map asks for that, then the messages.

    Attributes
    ----------
    counts
        Topic to how many messages were read, once they were.
    """

    def __init__(self, bag: Bag, topics: TopicMap) -> None:
        self._bag, self._map = bag, topics
        stated = bag.distribution if bag.distribution in releases() else None
        self._decoders = Decoders(topics.definitions, topics.distribution or stated)
        self._decodes: dict[Kind, Decode] = {}
        self._texts: dict[TextFrom, Texts] = {}
        self.counts: Counter[str] = Counter()

    def spans(self) -> list[Span]:
        """Where the recordings of the bag are; one span for all there is unless the map says otherwise."""
        marker, told = self._map.marker, [one for one in (self._map.action_from, self._map.id_from) if one]
        if not (marker or told or self._map.cuts):
            return [Span(0, LATEST_NS + 1)]
        wanted = [*told, *([TextFrom(marker.topic, marker.path)] if marker else [])]
        messages: dict[str, list[tuple[int, Any]]] = {one.topic: [] for one in wanted}
        for packet in self.packets(messages):
            with translated(f"{packet.kind.topic}: a message cannot be read", f"one of type {packet.kind.type!r}"):
                messages[packet.kind.topic].append((packet.log_ns, self.decoded(packet)))
        self._texts = {one: Texts(messages[one.topic], one.path, one.topic) for one in wanted}
        return spans_of(self._map, self.first_ns, self._texts[wanted[-1]] if marker else ())

    def text(self, wanted: TextFrom, span: Span) -> str:
        """What the bag tells of a recording, once `spans` was asked for."""
        return self._texts[wanted].at(span)

    def packets(self, wanted: Collection[str]) -> Iterator[Packet]:
        """The messages of some topics, file by file."""
        self.counts.clear()
        for source in self._bag.sources:
            for packet in source.packets(wanted):
                self.counts[packet.kind.topic] += 1
                yield packet

    def decoded(self, packet: Packet) -> Any:
        """What a message says; whatever decoders raise for one that is damaged."""
        decode = self._decodes.get(packet.kind)
        if decode is None:
            decode = self._decodes[packet.kind] = self._decoders.decoder(packet.kind)
        return decode(packet.data)

    @property
    def first_ns(self) -> int:
        """When the first message of any topic was written, once the packets were read."""
        first = [source.first_ns for source in self._bag.sources if source.first_ns is not None]
        if not first:
            raise StoreError("holds no message, expected a bag with some")
        return min(first)

    @property
    def topics(self) -> list[str]:
        """All topics of the bag, once the packets were read."""
        return sorted(set().union(*(source.topics for source in self._bag.sources)))

    def notices(self) -> Iterator[str]:
        """What is odd about the bag, once the packets were read."""
        for source in self._bag.sources:
            yield from source.notices
        yield from self._decoders.notices
        for topic, count in self.counts.items():
            stated = self._bag.counts.get(topic, count)
            if stated != count:
                yield f"{topic}: the bag's metadata speak of {stated} messages, and it holds {count}"
