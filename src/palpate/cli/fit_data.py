"""Where data of `palpate network fit` and `palpate calibrate` are from: a store, or CSV tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from palpate.cli.fit_options import OfStore, Tables
from palpate.cli.store_options import Place
from palpate.errors import PalpateError

if TYPE_CHECKING:
    from palpate.fitting.csv_tables import Column
    from palpate.fitting.data import Data
    from palpate.network.model import Network

__all__ = ["DataFrom", "From", "columns_of"]


class DataFrom(Protocol):
    """Where data are from."""

    def check(self) -> None:
        """Refuse what cannot be, before anything is done."""

    def read(self, network: Network) -> Data:
        """Read the data."""

    @property
    def words(self) -> list[object]:
        """What was typed; passwords are no part of it."""


@dataclass(frozen=True)
class From:
    """Where data are from: a store, or CSV tables where there are any."""

    place: Place
    of_store: OfStore
    tables: Tables

    def check(self) -> None:
        """Refuse options of the one with the other."""
        tables, typed = self.tables, self.of_store.typed
        if tables.csv is None and (tables.csv_readings or tables.column):
            raise PalpateError("--csv-readings, --column: for tables alone, expected --csv")
        places = {"--store": self.place.place, "--blobs": self.place.blobs}
        of_store = [name for name, value in {**places, **typed}.items() if value is not None]
        if tables.csv is not None and of_store:
            raise PalpateError(f"{', '.join(of_store)}: for a store alone, and --csv was found; expected one of them")

    def read(self, network: Network) -> Data:
        """Read the data."""
        tables = self.tables
        if tables.csv is not None:
            from palpate.fitting.csv_tables import read_tables

            return read_tables(network, tables.csv, tables.csv_readings, columns_of(tables.column or ()))
        return self._read_store(network)

    def _read_store(self, network: Network) -> Data:
        from palpate.cli.storing import check_installed, check_known, moment_of

        check_installed()
        from palpate.fitting.store_data import read_store
        from palpate.store.filters import Filter

        asked = self.of_store
        since, until = moment_of("--since", asked.since), moment_of("--until", asked.until)
        wanted = Filter(dataset=asked.dataset, device=asked.device, gripper=asked.gripper, since=since, until=until)
        with self.place.opened() as store:
            check_known(store, wanted)
            data = read_store(store, network, wanted)
            if self.place.place is None and data.specimens:
                # nobody has named it
                print(f"data from {store.engine.url!r}, as neither --store nor --csv was given")
            return data

    @property
    def words(self) -> list[object]:
        """What was typed; passwords are no part of it."""
        tables = self.tables
        if tables.csv is None:
            words: list[object] = ["--store", _shown(self.place.place)] if self.place.place is not None else []
            return words + [word for option in self.of_store.typed.items() for word in option]
        words = ["--csv", tables.csv]
        words += ["--csv-readings", tables.csv_readings] if tables.csv_readings else []
        return words + [word for text in tables.column or () for word in ("--column", text)]


def columns_of(texts: Sequence[str]) -> Mapping[str, Column]:
    """``COLUMN=PROPERTY [UNIT]`` as pairs; ``COLUMN=`` is a column that is left out."""
    from palpate.fitting.csv_tables import Column

    columns = {}
    for text in texts:
        name, equals, held = text.partition("=")
        if not (name and equals):
            raise PalpateError(f"--column: {text!r} was found, expected COLUMN=PROPERTY, COLUMN='PROPERTY [UNIT]'")
        columns[name.strip()] = Column.parse(held)
    return columns


def _shown(place: str) -> str:
    if "://" not in place:
        return place
    from sqlalchemy import make_url

    return make_url(place).render_as_string(hide_password=True)
