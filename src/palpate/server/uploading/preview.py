"""One upload in its folder: what was sent, the store in which it waits, and notes of what became of it."""

from __future__ import annotations

import json
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from fastapi import Request

from palpate.server.security.accounts import Account
from palpate.server.security.who import COOKIE, SESSION

__all__ = ["ABOUT", "FOUND", "KEPT", "TASK", "Preview", "holder_of"]

ABOUT, TASK, FOUND, KEPT = "about.json", "task.json", "found.json", "kept.json"


def holder_of(request: Request, who: Account) -> str:
    """Who may open a preview: an account in the session, or with the token, by which it was made."""
    given = (request.headers.get("authorization"), request.cookies.get(SESSION), request.cookies.get(COOKIE))
    return sha256(json.dumps([who.name, *given]).encode("utf-8", "surrogatepass")).hexdigest()


@dataclass(frozen=True)
class Preview:
    """One upload that waits.

    Attributes
    ----------
    id
        Random, so that nobody guesses it.
    folder
        Where all of it is; ``sent`` holds the files.
    """

    id: str
    folder: Path

    @property
    def sent(self) -> Path:
        """Where the files are, unpacked."""
        return self.folder / "sent"

    @property
    def place(self) -> Path:
        """The store in which the recordings wait."""
        return self.folder / "store.sqlite"

    @property
    def blobs(self) -> Path:
        """The large bytes of that store."""
        return self.folder / "blobs"

    def about(self) -> dict[str, Any] | None:
        """Whose it is and until when; None where it was removed, or is being made, by another worker."""
        try:
            plain: dict[str, Any] = json.loads((self.folder / ABOUT).read_text(encoding="utf-8"))
        except (FileNotFoundError, NotADirectoryError, ValueError):
            return None
        return plain

    def note(self, **about: object) -> None:
        """Note whose it is and until when, beside what was noted of that before."""
        told = {**(self.about() or {}), **about}
        (self.folder / ABOUT).write_text(json.dumps(told), encoding="utf-8")

    @property
    def dropped(self) -> int:
        """How many older ones of the account were dropped to make room for it."""
        return int((self.about() or {}).get("dropped", 0))

    @property
    def is_read(self) -> bool:
        """Whether it was read, and waits."""
        return (self.folder / FOUND).is_file()

    @property
    def is_kept(self) -> bool:
        """Whether it was kept, and all that is left is what became of it."""
        return (self.folder / KEPT).is_file()

    def found(self) -> list[dict[str, Any]]:
        """What became of each item when it was read."""
        plain: list[dict[str, Any]] = json.loads((self.folder / FOUND).read_text(encoding="utf-8"))
        return plain

    def note_kept(self, outcomes: list[dict[str, Any]]) -> None:
        """Note what became of each item when it was to be kept."""
        (self.folder / KEPT).write_text(json.dumps(outcomes), encoding="utf-8")

    def kept(self) -> list[dict[str, Any]]:
        """What became of each item when it was to be kept."""
        plain: list[dict[str, Any]] = json.loads((self.folder / KEPT).read_text(encoding="utf-8"))
        return plain
