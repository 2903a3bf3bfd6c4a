"""What maps beside the files of an upload say of columns and of topics, and what a file without one is told."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from palpate.errors import PalpateError
from palpate.store.errors import StoreError
from palpate.store.importing import squeezes
from palpate.store.importing.bags import format
from palpate.store.importing.bags.reading_topics import read_topic_map
from palpate.store.importing.bags.topics import TopicMap
from palpate.store.importing.columns import ColumnMap
from palpate.store.importing.items import Fate, Outcome
from palpate.store.importing.reading_columns import read_columns

__all__ = ["Maps"]

NONE_SENT = {
    squeezes.UNMAPPED: "is CSV, and nothing says what its columns mean: send a column map (.toml) with it",
    format.UNMAPPED: "is a bag, and nothing says what its topics become: send a map of topics (.toml) with it",
}
"""In place of sentences that speak of the command line."""
REFUSED = {
    squeezes.UNMAPPED: "is CSV, and what its columns mean is not known, as {} is refused",
    format.UNMAPPED: "is a bag, and what its topics become is not known, as {} is refused",
}


@dataclass(frozen=True)
class Maps:
    """The maps of an upload.

    Attributes
    ----------
    columns, topics
        The first of each kind; None where there is none that is right.
    refused
        What became of the others.
    wrong
        Name of the first map that is wrong, by what a file that it could be of is told without a map.
    """

    columns: ColumnMap | None
    topics: TopicMap | None
    refused: Sequence[Outcome]
    wrong: Mapping[str, str]

    @classmethod
    def taken_from(cls, sent: Path) -> Maps:
        """Read those in a folder, and take them out of it."""
        columns, topics, refused, wrong = None, None, list[Outcome](), dict[str, str]()
        for path in sorted(sent.glob("*.toml")):
            aside = sent.parent / path.name
            path.rename(aside)
            # of a file that is no TOML it is not known which map it was to be
            kinds = [squeezes.UNMAPPED, format.UNMAPPED]
            try:
                plain = tomllib.loads(aside.read_text(encoding="utf-8"))
                kinds = [format.UNMAPPED if "topics" in plain else squeezes.UNMAPPED]
                if "topics" in plain and topics is None:
                    topics = read_topic_map(aside)
                elif "topics" not in plain and columns is None:
                    columns = read_columns(aside)
                else:
                    raise StoreError(
                        "is a second map of its kind, expected one: upload the files of the other by themselves"
                    )
            except (PalpateError, OSError, ValueError, RecursionError) as error:
                reason = str(error).removeprefix(f"{aside}: ").replace(str(aside), path.name)
                refused.append(Outcome(str(path), Fate.REFUSED, reason))
                wrong = dict.fromkeys(kinds, path.name) | wrong
        return cls(columns, topics, refused, wrong)

    def told(self, reason: str | None) -> str | None:
        """Why a file was left out, for who fills a form."""
        if reason not in NONE_SENT:
            return reason
        return REFUSED[reason].format(self.wrong[reason]) if reason in self.wrong else NONE_SENT[reason]
