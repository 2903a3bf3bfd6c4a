"""A data set for the Hugging Face Hub: the tables, with a card."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from palpate.markdown import cell
from palpate.store.exporting.card import contents_part, front_matter, measured_part, quoting_part
from palpate.store.exporting.columns import RECORDINGS
from palpate.store.exporting.publication import Terms, publication
from palpate.store.exporting.selection import Selection
from palpate.store.exporting.shards import SHARD_BYTES
from palpate.store.exporting.tables import withheld, write_tables
from palpate.store.exporting.writing import Told, Written

__all__ = ["HuggingFace"]


@dataclass(frozen=True)
class HuggingFace:
    """What `palpate.store.exporting.tables.Tables` writes, and ``README.md``, the card that the Hub shows.

    Attributes
    ----------
    terms
        Title, authors and licence.
    shard_bytes
        A file that is so large [B] is followed by another.
    """

    terms: Terms = field(default_factory=Terms)
    shard_bytes: int = SHARD_BYTES

    def write(self, selection: Selection, folder: Path, told: Told) -> Written:
        """Write tables, card, and what describes them."""
        given, data = publication(selection, self.terms)
        shards = write_tables(given, data, folder, told, self.shard_bytes)
        rows = {table: sum(shard.rows for shard in files) for table, files in shards.items()}
        configs = {table.name: f"data/{table.name}-*.parquet" for table in rows}
        parts = [
            front_matter(data, data.census.recordings, [], configs),
            f"# {cell(data.title)}",
            measured_part(data),
            contents_part(rows),
            _joining(),
            quoting_part(data),
        ]
        (folder / "README.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")
        return Written(data.census.recordings, withheld=withheld(selection, data))


def _joining() -> str:
    return (
        f"`{RECORDINGS.columns[0].name}` joins the tables about recordings, `dataset` and `object` lead to objects, "
        "`setup` to setups. Columns that end in `_json` hold JSON. What is not known is null."
    )
