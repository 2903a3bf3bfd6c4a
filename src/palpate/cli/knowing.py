"""What is known of an object, and how it is described, from the words of the command line."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from getpass import getuser
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.errors import PalpateError, choices
from palpate.store.entries import Bound, Distribution, Entry, Interval, Value

if TYPE_CHECKING:
    from palpate.store.store import Store
    from palpate.store.things import Image, Thing

__all__ = ["attributes_of", "entry_of", "images_of", "removed", "save_images", "who_of"]

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
FORMS = ("118 g", "above 95 kPa", "below 5 kPa", "90 to 100 kPa", "ceramic", "ceramic=0.8,glass=0.2")
REMOVABLE = ("maker", "common-name", "alias:NAME", "attribute:NAME", "image:NAME")


def entry_of(name: str, text: str, sd: float | None = None) -> Entry:
    """What is known of a property.

    Examples
    --------
    >>> entry_of("mass", "118 g", 2.0)
    Value(property='mass', value=118.0, sd=2.0, unit='g')
    >>> entry_of("elasticity", "above 95 kPa")
    Bound(property='elasticity', above=95.0, below=None, unit='kPa')
    >>> entry_of("material", "ceramic=0.8,glass=0.2")
    Distribution(property='material', probabilities={'ceramic': 0.8, 'glass': 0.2})
    """
    entry = _entry(name, text.strip())
    if sd is not None:
        if not isinstance(entry, Value):
            raise PalpateError(f"--sd: {text!r} is no number, expected a value such as '118 g'")
        entry = replace(entry, sd=sd)
    return entry


def _entry(name: str, text: str) -> Entry:
    if found := re.fullmatch(rf"({NUMBER})\s*(.*)", text):
        value, rest = float(found[1]), found[2].strip()
        if between := re.fullmatch(rf"to\s+({NUMBER})\s*(.*)", rest):
            return Interval(name, value, float(between[1]), between[2].strip() or None)
        return Value(name, value, unit=rest or None)
    if found := re.fullmatch(rf"(above|below)\s+({NUMBER})\s*(.*)", text):
        end: dict[str, Any] = {found[1]: float(found[2])}
        return Bound(name, **end, unit=found[3].strip() or None)
    # a number that is none is no label either
    if not text or re.match(r"[-+]?(nan|inf(inity)?)\b", text, re.IGNORECASE):
        raise PalpateError(f"VALUE: {text!r} was found; {choices(FORMS)}")
    return Distribution(name, _probabilities(text))


def _probabilities(text: str) -> dict[str, float]:
    if "=" not in text:
        return {text: 1.0}
    found = {}
    for part in text.split(","):
        label, _, number = part.rpartition("=")
        if not label.strip() or not re.fullmatch(NUMBER, number.strip()):
            raise PalpateError(f"VALUE: {part!r} was found, expected LABEL=PROBABILITY as in 'ceramic=0.8,glass=0.2'")
        found[label.strip()] = float(number)
    return found


def attributes_of(texts: Iterable[str]) -> Mapping[str, Any]:
    """``NAME=VALUE`` as attributes: the value is JSON where it can be read so, else text."""
    found: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not (name and equals):
            raise PalpateError(f"--attribute: {text!r} was found, expected NAME=VALUE")
        try:
            found[name] = json.loads(value)
        except ValueError:
            found[name] = value
    return found


def images_of(store: Store, paths: Iterable[Path]) -> list[Image]:
    """Pictures put into the blobs, under the names of their files."""
    from palpate.store.describing import keep_image
    from palpate.store.importing.paths import media_type_of

    for path in paths:
        if not path.is_file():
            raise PalpateError(f"--image: there is no file {str(path)!r}, expected a picture")
    return [keep_image(store, path.name, media_type_of(path.name), path) for path in paths]


def save_images(store: Store, thing: Thing, folder: Path) -> None:
    """Write the pictures of an object into a folder, under their names."""
    from palpate.store.importing.paths import inside

    folder.mkdir(parents=True, exist_ok=True)
    for image in thing.images:
        path = inside(folder, image.name, f"image of {thing.path}")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(store.blobs.get(image.sha256))


def removed(thing: Thing, text: str) -> Thing:
    """The object without a part of its description."""
    kind, _, name = text.partition(":")
    edits: Mapping[str, Callable[[], Thing]] = {
        "alias": lambda: thing.described(aliases=tuple(one for one in thing.ref.aliases if one != name)),
        "attribute": lambda: thing.described(
            attributes={key: one for key, one in thing.ref.attributes.items() if key != name}
        ),
        "image": lambda: replace(thing, images=tuple(one for one in thing.images if one.name != name)),
    }
    if text in ("maker", "common-name"):
        return thing.described(**{text.replace("-", "_"): None})
    if kind not in edits or not name:
        raise PalpateError(f"--remove: {text!r} was found; {choices(REMOVABLE)}")
    changed = edits[kind]()
    if changed == thing:
        raise PalpateError(f"--remove: {thing.path} has no {kind} {name!r}")
    return changed


def who_of(who: str | None) -> str | None:
    """Who makes a change: as told, else whoever is logged in; None where nobody is."""
    if who is not None:
        return who
    try:
        return getuser()
    except (KeyError, OSError):
        return None
