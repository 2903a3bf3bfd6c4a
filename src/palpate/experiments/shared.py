"""One network per process, however many tasks bring it along: what is worked out about it is kept."""

from __future__ import annotations

import pickle
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from palpate.network.model import Network

__all__ = ["SharedNetwork"]


@dataclass(frozen=True)
class SharedNetwork:
    """A network in a task: pickled copies of it come back as one and the same object.

    Examples
    --------
    >>> import palpate
    >>> shared = SharedNetwork(palpate.load_network("household"))
    >>> first, second = (pickle.loads(pickle.dumps(shared)) for _ in range(2))
    >>> first.network is second.network
    True
    """

    network: Network

    @cached_property
    def _content(self) -> bytes:
        return pickle.dumps(self.network)

    def __reduce__(self) -> tuple[Any, tuple[bytes]]:
        return _unpacked, (self._content,)


@lru_cache(maxsize=64)
def _unpacked(content: bytes) -> SharedNetwork:
    return SharedNetwork(pickle.loads(content))
