"""Where uploads wait until somebody keeps them: a folder for each, of one session, for a while.

What became of one that was kept stays in its folder for as long, so that whichever worker is asked can tell it.
"""

from __future__ import annotations

import asyncio
import logging
import re
import secrets
import shutil
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from hmac import compare_digest
from pathlib import Path
from tempfile import TemporaryDirectory

from palpate.server.uploading.preview import ABOUT, HOLDS_S, KEPT, Preview

__all__ = ["MOST_OF_ACCOUNT", "Previews"]

_log = logging.getLogger("palpate.server")
ID = re.compile("[A-Za-z0-9_-]{43}")
ASIDE = "kept-"
"""Stands before the id in the name of the folder of what is being kept just now."""
SWEPT_EACH_S = 300.0
MOST_OF_ACCOUNT = 3
MOST_KEPT_OF_ACCOUNT = 20
MOST = 100


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
        """Make one that is to be read; None where too many of others wait."""
        self.sweep()
        there = [one for one in self._all() if not one.is_kept]
        own = [one for one in there if one.account == account]
        if len(there) >= MOST and len(own) < MOST_OF_ACCOUNT:
            return None
        # those that were read make room when there is something to keep in this one
        self._make_room(one for one in own if not one.is_read)
        made = Preview(secrets.token_urlsafe(32), Path())
        made = Preview(made.id, self.root / made.id)
        made.begin(holder, account)
        return made

    def admit(self, preview: Preview) -> bool:
        """Let one that was read wait: the account's oldest make room. False where it is gone.

        Where nothing of it can be kept it takes no place, and what became of it is told as of one that was kept.
        """
        if preview.ends_at < time.time() or preview.about() is None or not preview.is_read:
            # newer ones of the account took its place before it was read to the end
            return False
        own = [one for one in self._all() if one.account == preview.account and one.id != preview.id]
        found = preview.found()
        if any(one["digest"] is not None or one["episode"] is not None for one in found):
            waiting = (one for one in own if one.is_read and not one.is_kept)
            return preview.note(dropped=self._make_room(waiting))
        self._make_room((one for one in own if one.is_kept), MOST_KEPT_OF_ACCOUNT)
        preview.note_kept(found)
        _empty(preview)
        return True

    def get(self, id: str, holder: str) -> Preview | None:
        """The one of an id that was read, where it waits and is theirs."""
        found = self._of(id, holder)
        return found if found is not None and found.is_read else None

    def get_kept(self, id: str, holder: str) -> Preview | None:
        """The one of an id that was kept a while ago, where it is theirs; only what became of it is left."""
        found = self._of(id, holder)
        return found if found is not None and found.is_kept else None

    def is_being_kept(self, id: str, holder: str) -> bool:
        """Whether it is theirs, and is being kept just now."""
        return self._of(id, holder, ASIDE) is not None

    def of(self, holder: str) -> list[Preview]:
        """All that wait and are theirs, the oldest first."""
        found = [one for one in self._all() if self.get(one.id, holder) is not None]
        return sorted(found, key=lambda one: (one.ends_at, one.id))

    def _of(self, id: str, holder: str, before: str = "") -> Preview | None:
        found = Preview(id, self.root / f"{before}{id}") if ID.fullmatch(id) else None
        about = None if found is None else found.about()
        if about is None or about["expires"] < time.time() or not compare_digest(about["holder"], holder):
            return None
        return found

    @contextmanager
    def taken(self, preview: Preview) -> Iterator[Preview | None]:
        """One that nobody else removes or keeps meanwhile; None where others were first.

        Of it is left only what was noted of what became of it.
        """
        # only names that are ids are looked at by others; it comes back where it could not be kept
        aside = Preview(preview.id, self.root / f"{ASIDE}{preview.id}")
        try:
            preview.folder.rename(aside.folder)
        except FileNotFoundError:
            yield None
            return
        if not aside.is_read:
            # somebody else has kept it since it was looked for
            aside.folder.rename(preview.folder)
            yield None
            return
        try:
            # where this worker is killed meanwhile, others sweep it when that time is over
            aside.note(expires=time.time() + HOLDS_S)
            yield aside
        except BaseException:
            aside.folder.rename(preview.folder)
            raise
        self._settle(aside, preview)

    def _settle(self, aside: Preview, preview: Preview) -> None:
        if not aside.is_kept:
            shutil.rmtree(aside.folder, ignore_errors=True)
            return
        _empty(aside)
        own = (one for one in self._all() if one.is_kept and one.account == aside.account)
        self._make_room(own, MOST_KEPT_OF_ACCOUNT)
        aside.note(expires=time.time() + HOLDS_S)
        aside.folder.rename(preview.folder)

    def drop(self, id: str) -> None:
        """Remove one; nothing happens where another worker has."""
        _remove(self.root / id)

    def sweep(self) -> None:
        """Remove all whose time is over, also those of a worker that was killed while it made, read or kept them."""
        for path in [] if self._root is None else list(self.root.iterdir()):
            try:
                is_over = ID.fullmatch(path.name.removeprefix(ASIDE)) and Preview(path.name, path).ends_at < time.time()
                if is_over:
                    _remove(path)
            except OSError as error:
                # the others are swept none the less
                _log.warning("an upload that waits cannot be swept: %s", error)

    async def watch(self) -> None:
        """Sweep now and then."""
        while True:
            await asyncio.sleep(SWEPT_EACH_S)
            try:
                await asyncio.to_thread(self.sweep)
            except OSError as error:
                # what is wrong now may be well the next time
                _log.warning("uploads that wait cannot be swept: %s", error)

    def _all(self) -> list[Preview]:
        """Each that nobody is keeping just now."""
        if self._root is None:
            return []
        found = (Preview(path.name, path) for path in self.root.iterdir() if ID.fullmatch(path.name))
        return [one for one in found if one.about() is not None]

    def _make_room(self, of_account: Iterable[Preview], most: int = MOST_OF_ACCOUNT) -> int:
        """Remove the oldest of an account, without which there is room for one more; how many these are."""
        oldest = sorted((one.ends_at, one.id) for one in of_account)
        dropped = oldest[: max(0, len(oldest) - most + 1)]
        for _, id in dropped:
            self.drop(id)
        return len(dropped)


def _remove(folder: Path) -> None:
    # whoever still writes into it finds no place for a file, and then sees by this that the folder is gone
    (folder / ABOUT).unlink(missing_ok=True)
    shutil.rmtree(folder, ignore_errors=True)


def _empty(preview: Preview) -> None:
    """Leave nothing but the notes on whose it is and what became of it."""
    for path in preview.folder.iterdir():
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        elif path.name not in (ABOUT, KEPT):
            path.unlink()
