"""What an object is called, and by whom it is made, by nothing but what somebody sees of it.

Recordings that are seen describe it, the one that came first before others, and persons who are heard change that: what
the last of them says of a field counts, and what they take away no recording says again.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from palpate.store.records import ThingRef

__all__ = ["Description", "Line", "Words", "changes_of"]

Field = tuple[str, ...]


@dataclass(frozen=True)
class Description:
    """What a recording says of its object beside dataset and name, and when it came."""

    said_us: int
    maker: str | None
    common_name: str | None
    aliases: tuple[str, ...]


@dataclass(frozen=True)
class Line:
    """What a person has changed of an object, as the audit notes it, and when."""

    at_us: int
    changes: Sequence[Any]


@dataclass
class Words:
    """What is said of an object, in the order in which it was said: by recordings, and then by persons.

    Examples
    --------
    >>> words = Words([Description(1, "Acme", "cup", ("pot",)), Description(3, None, "mug", ())])
    >>> words.of(ThingRef("ycb", "025_mug")).aliases
    ('pot', 'mug')
    >>> words.hear(Line(2, [{"field": ["common_name"], "after": "beaker"}, {"field": ["aliases", "pot"]}]))
    >>> found = words.of(ThingRef("ycb", "025_mug"))
    >>> found.maker, found.common_name, found.aliases
    ('Acme', 'beaker', ('mug',))
    """

    descriptions: Sequence[Description] = ()
    told: dict[Field, Any] = field(default_factory=dict)
    taken: set[Field] = field(default_factory=set)
    replaced: set[str | None] = field(default_factory=set)

    def hear(self, line: Line) -> None:
        """Let a line count, after those that came before."""
        for change in line.changes:
            where = tuple(change["field"])
            self.told.pop(where, None)
            self.taken.discard(where)
            if "after" in change:
                self.told[where] = change["after"]
            else:
                self.taken.add(where)
            if where == ("common_name",):
                names = (one.common_name for one in self.descriptions if one.said_us <= line.at_us)
                self.replaced.add(next((name for name in names if name is not None), None))

    @property
    def common_name(self) -> str | None:
        """What it is called first."""
        return self._first("common_name")

    def of(self, thing: ThingRef) -> ThingRef:
        """The object, of which only dataset and name are asked, with these words."""
        attributes = {where[1]: value for where, value in self.told.items() if where[:-1] == ("attributes",)}
        aliases = tuple(name for name in dict.fromkeys(self._names()) if name != self.common_name)
        return ThingRef(thing.dataset, thing.id, self._first("maker"), self.common_name, attributes, aliases)

    def _first(self, name: str) -> str | None:
        if (name,) in self.told or (name,) in self.taken:
            return self.told.get((name,))
        said = (getattr(one, name) for one in self.descriptions)
        is_name = name == "common_name"
        return next((text for text in said if text and not (is_name and ("aliases", text) in self.taken)), None)

    def _names(self) -> Iterator[str]:
        for one in self.descriptions:
            own = (one.common_name,) if one.common_name is not None and one.common_name not in self.replaced else ()
            yield from (name for name in (*own, *one.aliases) if ("aliases", name) not in self.taken)
        yield from (value for where, value in self.told.items() if where[:-1] == ("aliases",))


def changes_of(detail: str) -> list[Any]:
    """What a line of the audit says of fields."""
    try:
        found = json.loads(detail)
    except ValueError:
        # damaged: nobody has said anything by it
        return []
    return [one for one in found if _is_change(one)] if isinstance(found, list) else []


def _is_change(one: Any) -> bool:
    where = one.get("field") if isinstance(one, dict) else None
    return isinstance(where, list) and len(where) > 0 and all(isinstance(name, str) for name in where)
