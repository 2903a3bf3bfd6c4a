"""The formats that can be imported."""

from __future__ import annotations

from palpate.store.importing.bags.format import Bags
from palpate.store.importing.bags.topics import TopicMap
from palpate.store.importing.butler import ButlerExperiments
from palpate.store.importing.columns import ColumnMap
from palpate.store.importing.items import Format
from palpate.store.importing.own_formats import Archives, Exports, RecordingFolders
from palpate.store.importing.squeezes import Squeezes
from palpate.store.importing.uploads import UploadDictionaries

__all__ = ["all_formats"]


def all_formats(columns: ColumnMap | None = None, topics: TopicMap | None = None) -> tuple[Format, ...]:
    """All formats, in the order in which they are asked whether a path is theirs.

    Parameters
    ----------
    columns
        What the columns of CSV files mean; without it they are skipped, with a sentence on what is needed.
    topics
        What the topics of bags become; likewise.
    """
    own = (Archives(), Exports(), RecordingFolders())
    return (*own, ButlerExperiments(), UploadDictionaries(), Squeezes(columns), Bags(topics))
