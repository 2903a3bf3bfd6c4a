"""Where uploads wait until somebody keeps them: a folder for each, of one session, for a while.

What became of one that was kept stays in its folder for as long, so that whichever worker is asked can tell it.
"""

from __future__ import annotations

import asyncio
import json
import re
import secrets
import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from hmac import compare_digest
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fastapi import Request

from palpate.server.security.accounts import Account
from palpate.server.security.who import COOKIE, SESSION

__all__ = ["MOST_OF_ACCOUNT", "Preview", "Previews", "holder_of"]

ID = re.compile("[A-Za-z0-9_-]{43}")
ABOUT, TASK, FOUND, KEPT = "about.json", "task.json", "found.json", "kept.json"
HOLDS_S = 3600.0
SWEPT_EACH_S = 300.0
MOST_OF_ACCOUNT = 3
MOST_KEPT_OF_ACCOUNT = 20
MOST = 100


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

    @property
    def dropped(self) -> int:
        """How many older ones of the account were dropped to make room for it."""
        about = json.loads((self.folder / ABOUT).read_text(encoding="utf-8"))
        return int(about.get("dropped", 0))

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


class Previews:
    """All uploads that wait; the workers of a server share the folder.

    Parameters
    ----------
    root
        Where they are; where it is None a folder of its own, which is made when the first one comes.
    """

    def __init__(self, root: Path | None = None) -> None:
        self._root = root
        self._own: TemporaryDirectory[str] | None = None
        self._making = threading.Lock()

    @property
    def root(self) -> Path:
        """Where they are."""
        with self._making:
            if self._root is None:
                self._own = TemporaryDirectory(prefix="palpate-previews-")
                self._root = Path(self._own.name)
            return self._root

    def close(self) -> None:
        """Remove the folder where it is one of its own."""
        if self._own is not None:
            self._own.cleanup()
            self._root = self._own = None

    def new(self, holder: str, account: str) -> Preview | None:
        """Make one; the account's oldest make room, and there is None where too many of others wait."""
        self.sweep()
        waiting = self._all(is_kept=False)
        oldest = _too_many(waiting, account, MOST_OF_ACCOUNT)
        for id in (*oldest, *_too_many(self._all(is_kept=True), account, MOST_KEPT_OF_ACCOUNT)):
            self.drop(id)
        if len(waiting) >= MOST:
            return None
        made = Preview(secrets.token_urlsafe(32), Path())
        made = Preview(made.id, self.root / made.id)
        made.sent.mkdir(parents=True, mode=0o700)
        about = {"holder": holder, "account": account, "expires": time.time() + HOLDS_S, "dropped": len(oldest)}
        (made.folder / ABOUT).write_text(json.dumps(about), encoding="utf-8")
        return made

    def get(self, id: str, holder: str) -> Preview | None:
        """The one of an id that was read, where it waits and is theirs."""
        return self._of(id, holder, FOUND)

    def get_kept(self, id: str, holder: str) -> Preview | None:
        """The one of an id that was kept a while ago, where it is theirs; only what became of it is left."""
        return self._of(id, holder, KEPT)

    def _of(self, id: str, holder: str, needed: str) -> Preview | None:
        about = self._about(id) if ID.fullmatch(id) else None
        if about is None or about["expires"] < time.time() or not compare_digest(about["holder"], holder):
            return None
        found = Preview(id, self.root / id)
        return found if (found.folder / needed).is_file() else None

    @contextmanager
    def taken(self, preview: Preview) -> Iterator[Preview | None]:
        """One that nobody else removes or keeps meanwhile; None where others were first.

        Of it is left only what was noted of what became of it.
        """
        # only names that are ids are looked at by others; it comes back where it could not be kept
        aside = Preview(preview.id, self.root / f"kept-{secrets.token_hex(8)}")
        try:
            preview.folder.rename(aside.folder)
        except FileNotFoundError:
            yield None
            return
        try:
            yield aside
        except BaseException:
            aside.folder.rename(preview.folder)
            raise
        self._settle(aside, preview)

    def _settle(self, aside: Preview, preview: Preview) -> None:
        if not (aside.folder / KEPT).is_file():
            shutil.rmtree(aside.folder, ignore_errors=True)
            return
        for path in aside.folder.iterdir():
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            elif path.name not in (ABOUT, KEPT):
                path.unlink()
        about = json.loads((aside.folder / ABOUT).read_text(encoding="utf-8"))
        about["expires"] = time.time() + HOLDS_S
        (aside.folder / ABOUT).write_text(json.dumps(about), encoding="utf-8")
        aside.folder.rename(preview.folder)

    def drop(self, id: str) -> None:
        """Remove one; nothing happens where another worker has."""
        shutil.rmtree(self.root / id, ignore_errors=True)

    def sweep(self) -> None:
        """Remove all whose time is over."""
        now = time.time()
        for id, about in self._all().items():
            if about["expires"] < now:
                self.drop(id)

    async def watch(self) -> None:
        """Sweep now and then."""
        while True:
            await asyncio.sleep(SWEPT_EACH_S)
            await asyncio.to_thread(self.sweep)

    def _all(self, *, is_kept: bool | None = None) -> dict[str, dict[str, Any]]:
        """What is told of each; of those alone that wait, or that were kept, where that is asked."""
        if self._root is None:
            return {}
        names = [
            path.name
            for path in self.root.iterdir()
            if ID.fullmatch(path.name) and is_kept in (None, (path / KEPT).is_file())
        ]
        told = {name: self._about(name) for name in names}
        return {name: about for name, about in told.items() if about is not None}

    def _about(self, id: str) -> dict[str, Any] | None:
        try:
            about: dict[str, Any] = json.loads((self.root / id / ABOUT).read_text(encoding="utf-8"))
        except (FileNotFoundError, ValueError):
            # it was removed, or is being made, by another worker
            return None
        return about


def _too_many(told: dict[str, dict[str, Any]], account: str, most: int) -> list[str]:
    """The oldest of an account, without which there is room for one more."""
    own = sorted((about["expires"], id) for id, about in told.items() if about["account"] == account)
    return [id for _, id in own[: max(0, len(own) - most + 1)]]
