"""Recordings as they are sent."""

import io
from zipfile import ZIP_DEFLATED, ZipFile

from palpate.store.importing.package import pack
from palpate.store.records import Recording


def package(recording: Recording) -> bytes:
    """A recording as the client sends it."""
    sent = io.BytesIO()
    pack(recording, sent)
    return sent.getvalue()


def repacked(recording: Recording, changed: dict[str, bytes]) -> bytes:
    """The same with other bytes in the place of some of its files, or with more files."""
    sent = io.BytesIO()
    with ZipFile(io.BytesIO(package(recording))) as old, ZipFile(sent, "w", ZIP_DEFLATED) as new:
        for name in old.namelist():
            new.writestr(name, changed.pop(name, b"") or old.read(name))
        for name, data in changed.items():
            new.writestr(name, data)
    return sent.getvalue()
