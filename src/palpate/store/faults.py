"""What verification finds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

__all__ = ["Fault", "Remedy"]


class Remedy(Enum):
    """A step that is safe, in words for before and after it."""

    REINDEX = "makes the rows for queries again", "the rows for queries were made again"
    SET_ASIDE = "sets it aside, so that importing or putting the recording again restores it", "it was set aside"
    REMOVE = "removes it", "it was removed"

    def __init__(self, before: str, after: str) -> None:
        self.before, self.after = before, after

    @property
    def mends(self) -> bool:
        """Whether the store is whole after it; what was set aside must come back from elsewhere."""
        return self is not Remedy.SET_ASIDE


@dataclass(frozen=True)
class Fault:
    """Something that is not as it was written.

    Attributes
    ----------
    where
        ``recording ...``, ``episode ...``, ``object ...``, ``blob ...``, ``setups ...`` or ``database``.
    what
        What was found.
    remedy
        What `palpate.store.verifying.repair` does about it; None where nothing is safe.
    done
        Whether it has done so.
    """

    where: str
    what: str
    remedy: Remedy | None = None
    done: bool = False

    @property
    def mended(self) -> bool:
        """Whether it is a fault no longer."""
        return self.done and self.remedy is not None and self.remedy.mends
