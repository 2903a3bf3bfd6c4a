"""One upload in its folder: what was sent, the store in which it waits, and notes of what became of it."""

from __future__ import annotations

import json
import time
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from fastapi import Request

from palpate.server.security.accounts import Account
from palpate.server.security.who import COOKIE, SESSION
from palpate.store.importing.items import Fate

__all__ = ["ABOUT", "FOUND", "HOLDS_S", "KEPT", "OF_OTHERS", "TASK", "Preview", "holder_of"]

ABOUT, TASK, FOUND, KEPT = "about.json", "task.json", "found.json", "kept.json"
HOLDS_S = 3600.0
OF_OTHERS = "of others"
"""In a note on what was found: why it is refused, unless the store has it and who has sent it sees that."""
OVER: Mapping[str, Any] = {"holder": "", "account": None, "expires": 0.0}
"""What is told of one whose notes are damaged."""


def refused(one: dict[str, Any]) -> dict[str, Any]:
    """A note on what was found in the name of somebody else, as it is refused."""
    return {**one, "fate": Fate.REFUSED.value, "reason": one[OF_OTHERS], "digest": None}


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

    def about(self) -> Mapping[str, Any] | None:
        """Whose it is and until when; None where it was removed, or is being made, by another worker."""
        try:
            plain: Any = json.loads((self.folder / ABOUT).read_text(encoding="utf-8"))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except ValueError:
            return OVER
        is_whole = isinstance(plain, dict) and isinstance(plain.get("holder"), str)
        return plain if is_whole and isinstance(plain.get("expires"), float) else OVER

    def begin(self, holder: str, account: str) -> None:
        """Make its folder, and note whose it is; only this makes that note."""
        self.sent.mkdir(parents=True, mode=0o700)
        self._write_about({"holder": holder, "account": account, "expires": time.time() + HOLDS_S})

    def note(self, **about: object) -> bool:
        """Note something beside whose it is; False where it was removed, and then nothing of it is made again."""
        before = self.about()
        if before is None:
            return False
        try:
            self._write_about({**before, **about})
        except FileNotFoundError:
            # it was removed between the two
            return False
        return True

    def _write_about(self, told: dict[str, Any]) -> None:
        # whoever reads it meanwhile finds the one or the other, and never a half
        part = self.folder / f"{ABOUT}.part"
        part.write_text(json.dumps(told), encoding="utf-8")
        part.replace(self.folder / ABOUT)

    @property
    def account(self) -> str | None:
        """Whose it is; None where that is not known."""
        account: str | None = (self.about() or OVER)["account"]
        return account

    @property
    def ends_at(self) -> float:
        """When its time is over; of one that does not tell, it is counted from when its folder was last written."""
        about = self.about()
        if about is not None:
            return float(about["expires"])
        try:
            return self.folder.stat().st_mtime + HOLDS_S
        except FileNotFoundError:
            # another worker has just removed it
            return 0.0

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

    def refuse_of_others(self, seen: Collection[str]) -> None:
        """Refuse what is in the name of somebody else and is not seen, by its digest, in the store."""
        told = [refused(one) if one.get(OF_OTHERS) and one["digest"] not in seen else one for one in self.found()]
        (self.folder / FOUND).write_text(json.dumps(told), encoding="utf-8")

    def note_kept(self, outcomes: list[dict[str, Any]]) -> None:
        """Note what became of each item when it was to be kept."""
        (self.folder / KEPT).write_text(json.dumps(outcomes), encoding="utf-8")

    def kept(self) -> list[dict[str, Any]]:
        """What became of each item when it was to be kept."""
        plain: list[dict[str, Any]] = json.loads((self.folder / KEPT).read_text(encoding="utf-8"))
        return plain
