"""Decoding messages by the definitions of their types, which stand in the bag, in the map, or in a release of ROS."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any

from palpate.errors import choices, near
from palpate.store.errors import StoreError
from palpate.store.importing.bags.packets import Kind, translated

if TYPE_CHECKING:
    from rosbags.interfaces.typing import Typesdict
    from rosbags.typesys.store import Typestore

__all__ = ["Decode", "Decoders", "releases"]

Decode = Callable[[bytes], Any]

TYPE = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)+", re.ASCII)
FIELD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
LARGEST_DEFINITION = 1 << 20
LARGEST_ARRAY = 4096
"""Elements of an array of fixed length; a line of code is made for each where they are no numbers."""

IDL = "=" * 80 + "\n"


class Decoders:
    """Makes decoders.

    Parameters
    ----------
    definitions
        Type to its definition, for types that a bag does not define.
    distribution
        The release of ROS 2 whose types are used by a bag without definitions; the latest known where it is None,
        which is noticed.

    Attributes
    ----------
    notices
        What was assumed.
    """

    def __init__(self, definitions: Mapping[str, str], distribution: str | None) -> None:
        self.definitions, self.distribution = definitions, distribution
        self.notices: list[str] = []

    def decoder(self, kind: Kind) -> Decode:
        """A function that decodes the messages of a topic.

        Raises
        ------
        StoreError
            If they are encoded in a way that is not supported, or the type is not defined.
        """
        if kind.encoding == "json":
            return _from_json
        if kind.encoding in ("cdr", "ros1"):
            with translated(f"{kind.topic}: the definition of {kind.type!r}", "one that ROS writes"):
                return self._by_type(kind)
        found = f"{kind.topic}: its messages are encoded as {kind.encoding!r}, which is not supported"
        raise StoreError(f"{found}; expected 'cdr' or 'json'")

    def _by_type(self, kind: Kind) -> Decode:
        from rosbags.typesys import Stores, get_typestore

        types = (
            _types(kind.topic, kind.type, kind.language, kind.definition)
            if kind.definition
            else self._known_types(kind)
        )
        # a store of its own, as bags may define one type in two ways
        store = get_typestore(Stores.EMPTY)
        store.register(types)
        name = next(iter(types))
        store.get_msgdef(name)
        if kind.encoding == "ros1":
            return lambda data: store.deserialize_ros1(data, name)
        return lambda data: store.deserialize_cdr(data, name)

    def _known_types(self, kind: Kind) -> Typesdict:
        """A type that the bag does not define, and those it is made of."""
        release, given = self._release().fielddefs, self._given
        known = {**release, **given}
        if kind.type not in known:
            wanted = f"it under [definitions] of the map{near(kind.type, given)}"
            raise StoreError(f"{kind.topic}: the bag does not define the type {kind.type!r}; expected {wanted}")
        found, waiting = {}, [kind.type]
        while waiting:
            name = waiting.pop()
            if name in known and name not in found:
                found[name] = known[name]
                waiting += filter(None, (_named(described) for _, described in known[name][1]))
        if self.distribution is None and not found.keys() <= given.keys():
            told = "the bag does not define all its types: those of a recent ROS 2 are assumed"
            self.notices += [told] if told not in self.notices else []
        return found

    @cached_property
    def _given(self) -> Typesdict:
        found: Typesdict = {}
        for name, text in self.definitions.items():
            found.update(_types("[definitions]", name, "ros2msg", text))
        return found

    def _release(self) -> Typestore:
        from rosbags.typesys import Stores, get_typestore

        known = releases()
        if self.distribution is not None and self.distribution not in known:
            told = near(self.distribution, known)
            raise StoreError(f"distribution {self.distribution!r}{told} is unknown; {choices(known)}")
        return get_typestore(Stores.LATEST if self.distribution is None else Stores(f"ros2_{self.distribution}"))


def releases() -> list[str]:
    """The releases of ROS 2 whose types are known."""
    from rosbags.typesys import Stores

    return [store.value.removeprefix("ros2_") for store in Stores if store.value.startswith("ros2_")]


def _from_json(data: bytes) -> Any:
    return json.loads(data)


def _types(where: str, name: str, language: str, text: str) -> Typesdict:
    """The types of a definition; of names and sizes that can become code, as the library makes code of them."""
    from rosbags.typesys import get_types_from_idl, get_types_from_msg

    if len(text) > LARGEST_DEFINITION:
        raise StoreError(f"{where}: {len(text)} characters define {name!r}, expected {LARGEST_DEFINITION} at most")
    if language in ("ros2idl", "omgidl"):
        types: Typesdict = {}
        for part in text.split(IDL) if text.startswith(IDL) else [text]:
            types.update(
                get_types_from_idl(part.partition("\n")[2] if part.startswith("IDL: ") else part) if part else {}
            )
        types = {name: types[name], **types}
    elif language in ("ros2msg", "ros1msg"):
        types = get_types_from_msg(text, name)
    else:
        raise StoreError(f"{where}: {name!r} is defined in {language!r}, expected 'ros2msg' or 'ros2idl'")
    for type, (constants, fields) in types.items():
        names = [*(name for name, _, _ in constants), *(name for name, _ in fields)]
        if not TYPE.fullmatch(type) or not all(map(FIELD.fullmatch, names)):
            raise StoreError(f"{where}: {type!r} has the fields {names}, expected names of ROS")
        for field, described in fields:
            _check(f"{where}: {type}.{field}", described)
    return types


def _check(where: str, described: Any) -> None:
    """Refuse names that are none, and arrays of fixed length for which too much code would be made."""
    from rosbags.interfaces import Nodetype

    named = _named(described)
    if named is not None and not TYPE.fullmatch(named):
        raise StoreError(f"{where} is of type {named!r}, expected a name of ROS")
    if described[0] == Nodetype.ARRAY:
        inner, length = described[1]
        if length > LARGEST_ARRAY and (named or "string" in inner[1][0]):
            raise StoreError(f"{where} has {length} elements, expected {LARGEST_ARRAY} at most")


def _named(described: Any) -> str | None:
    from rosbags.interfaces import Nodetype

    if described[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        described = described[1][0]
    return described[1] if described[0] == Nodetype.NAME else None
