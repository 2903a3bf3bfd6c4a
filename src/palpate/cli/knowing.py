"""How an object is described, from the words of the command line."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from getpass import getuser
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.errors import PalpateError, choices

if TYPE_CHECKING:
    from palpate.store.store import Store
    from palpate.store.things import Image, Thing

__all__ = ["attributes_of", "images_of", "removed", "save_images", "who_of"]

REMOVABLE = ("maker", "common-name", "alias:NAME", "attribute:NAME", "image:NAME")


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
    """Pictures put into the blobs, under the names of their files; nothing is, unless all are pictures."""
    from palpate.store.describing import keep_image

    kinds = {path: _picture_type(path) for path in paths}
    return [keep_image(store, path.name, kind, path) for path, kind in kinds.items()]


def _picture_type(path: Path) -> str:
    from palpate.store.picture_files import picture_type

    if not path.is_file():
        raise PalpateError(f"--image: there is no file {str(path)!r}, expected a picture")
    return picture_type(path, "--image")


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
