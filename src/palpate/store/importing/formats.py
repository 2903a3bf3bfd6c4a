"""The formats that can be imported."""

from __future__ import annotations

from palpate.store.importing.butler import ButlerExperiments
from palpate.store.importing.items import Format
from palpate.store.importing.own_formats import Archives, RecordingFolders
from palpate.store.importing.uploads import UploadDictionaries

__all__ = ["all_formats"]


def all_formats() -> tuple[Format, ...]:
    """All formats, in the order in which they are asked whether a path is theirs."""
    return (Archives(), RecordingFolders(), ButlerExperiments(), UploadDictionaries())
