"""What every form is made of."""

from __future__ import annotations

from datetime import datetime
from typing import Generic, TypeVar

from pydantic import BaseModel, ConfigDict

__all__ = ["Page", "Strict", "Undoable"]

Item = TypeVar("Item")


class Strict(BaseModel):
    """Holds what it says and nothing else."""

    model_config = ConfigDict(extra="forbid")


class Page(Strict, Generic[Item]):
    """Some items, and the cursor of the next page; null where there is none."""

    items: list[Item]
    next: str | None


class Undoable(Strict):
    """When something was changed and by whom, and whether it was taken back."""

    at: datetime
    who: str | None
    undone_at: datetime | None
    undone_by: str | None
