"""What `palpate network fit` does: data read, a network fitted, scored, written whole and told."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli.fit_options import How, OfStore, Tables
from palpate.cli.store_options import Place
from palpate.errors import PalpateError

if TYPE_CHECKING:
    from palpate.fitting.csv_tables import Column
    from palpate.fitting.data import Data
    from palpate.fitting.scores import Score
    from palpate.fitting.settings import Settings
    from palpate.fitting.template import Template
    from palpate.network.model import Network

__all__ = ["From", "columns_of", "fit_network"]


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
            return read_store(store, network, wanted)

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


def fit_network(like: str, data_from: From, output: Path, how: How, *, force: bool) -> None:
    """Fit, score, write and tell."""
    from palpate import __version__
    from palpate.cli.fit_view import fit_report
    from palpate.cli.terminal import console
    from palpate.fitting.documenting import Provenance, document
    from palpate.fitting.fit import fit
    from palpate.fitting.settings import Settings
    from palpate.fitting.template import read_template

    data_from.check()
    _check_output(output, force=force)
    settings, folds, moment = Settings(how.pseudo_count, tuple(how.keep or ())), _folds(how.folds), _day(how.date)
    template = read_template(like)
    data = data_from.read(template.network)
    fitted = fit(template, data.specimens, settings)
    if not fitted.estimated:
        raise PalpateError(
            f"network fit: found {len(data.specimens)} objects that say nothing of the network; expected objects with "
            "known properties and the states of their parents, or readings of these properties"
        )
    scores = _scores(template, data, settings, folds) if folds else {}
    made = Provenance(like, _command(like, data_from, settings, output), __version__, moment or _last(data))
    _write(output, document(template, fitted, data, settings, made, output.stem))
    console().print(fit_report(fitted, scores, data))
    print(f"{output}: written")


def _check_output(output: Path, *, force: bool) -> None:
    from palpate.cli.files import check_writable

    check_writable("--output", output)
    if output.exists() and not force:
        raise PalpateError(f"--output: {output} exists already, expected the name of a new file, or --force")


def _folds(folds: int) -> int:
    if folds < 2 and folds != 0:
        raise PalpateError(f"--folds: found {folds}, expected 2 at least, or 0 for no scores")
    return folds


def _write(output: Path, tables: Mapping[str, object]) -> None:
    """Write the file whole, once it can be read."""
    from palpate.cli.files import replacing
    from palpate.network.reading import load_network
    from palpate.network.writing import to_toml

    with replacing(output) as draft:
        draft.write_text(to_toml(tables), encoding="utf-8")
        load_network(draft)


def _scores(template: Template, data: Data, settings: Settings, folds: int) -> Mapping[tuple[str, str], Score]:
    from palpate.cli.terminal import console
    from palpate.fitting.scores import held_out_scores

    screen = console()
    with screen.status("Scoring on held-out objects ...") as status:
        return held_out_scores(
            template,
            data.specimens,
            settings,
            folds,
            lambda done, of: status.update(f"Scoring on held-out objects ... {done} of {of} folds"),
        )


def _day(text: str | None) -> str:
    if text is None:
        return ""
    try:
        return date.fromisoformat(text).isoformat()
    except ValueError:
        raise PalpateError(f"--date: {text!r} was found, expected a date such as 2024-05-01") from None


def _last(data: Data) -> str:
    """The day of the last recording."""
    return max((source.last for source in data.sources), default="")[:10]


def _command(like: str, data_from: From, settings: Settings, output: Path) -> str:
    """The command line again; passwords are no part of it."""
    words: list[object] = ["palpate", "network", "fit", "--like", like, *data_from.words]
    words += ["--pseudo-count", f"{settings.pseudo_count:g}"]
    words += [word for name in settings.keep for word in ("--keep", name)]
    return shlex.join(str(word) for word in (*words, "--output", output))


def _shown(place: str) -> str:
    if "://" not in place:
        return place
    from sqlalchemy import make_url

    return make_url(place).render_as_string(hide_password=True)
