"""Names of objects in addresses: any text as one part of a path, readable where it can be."""

from __future__ import annotations

import re
from urllib.parse import quote

from palpate.store.records import ThingRef

__all__ = ["escape", "thing_address", "unescape"]

# a path takes slashes and dots for itself; a tilde begins what stands for one of them
UNSAFE = re.compile(r"[~/\\\x00-\x1f\x7f]|^\.")
ESCAPED = re.compile(r"~([0-9a-f]{2})")


def escape(name: str) -> str:
    """A name without what a path would take apart.

    Examples
    --------
    >>> escape("our lab/cup 1"), escape("..")
    ('our lab~2fcup 1', '~2e.')
    """
    return UNSAFE.sub(lambda found: f"~{ord(found[0]):02x}", name)


def unescape(part: str) -> str:
    """What `escape` was given.

    Examples
    --------
    >>> unescape("our lab~2fcup 1")
    'our lab/cup 1'
    """
    return ESCAPED.sub(lambda found: chr(int(found[1], 16)), part)


def thing_address(thing: ThingRef) -> str:
    """The end of an object's address: ``ycb/025_mug``."""
    return f"{quote(escape(thing.dataset), safe='')}/{quote(escape(thing.id), safe='')}"
