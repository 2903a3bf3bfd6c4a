"""What `palpate network fit` does: data read, a network fitted, scored, written whole and told."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING

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
    """Where data are from: a store, or CSV tables."""

    store: str | None = None
    blobs: str | None = None
    wanted: Mapping[str, str] = field(default_factory=dict)
    csv: Path | None = None
    readings: Path | None = None
    columns: Sequence[str] = ()

    def check(self) -> None:
        """Refuse both, none, and options of the one with the other."""
        if (self.store is None) == (self.csv is None):
            found = "both --store and --csv" if self.csv else "neither --store nor --csv"
            raise PalpateError(f"network fit: found {found}; expected one of them")
        if self.csv is None and (self.readings or self.columns):
            raise PalpateError("--csv-readings, --column: for tables alone, expected --csv")
        if self.csv is not None and (self.wanted or self.blobs):
            raise PalpateError(
                f"{', '.join(f'--{name}' for name in self.wanted) or '--blobs'}: for a store alone, expected --store"
            )

    def read(self, network: Network) -> Data:
        """Read the data."""
        if self.csv is not None:
            from palpate.fitting.csv_tables import read_tables

            return read_tables(network, self.csv, self.readings, columns_of(self.columns))
        return self._read_store(network)

    def _read_store(self, network: Network) -> Data:
        from palpate.cli.storing import check_installed, check_known, moment_of, opened

        check_installed()
        assert self.store is not None
        from palpate.fitting.store_data import read_store
        from palpate.store.filters import Filter

        since, until = (moment_of(f"--{name}", self.wanted.get(name)) for name in ("since", "until"))
        dataset, device, gripper = (self.wanted.get(name) for name in ("dataset", "device", "gripper"))
        wanted = Filter(dataset=dataset, device=device, gripper=gripper, since=since, until=until)
        with opened(self.store, self.blobs) as store:
            check_known(store, wanted)
            return read_store(store, network, wanted)


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


def fit_network(like: str, data_from: From, output: Path, settings: Settings, folds: int, day: str | None) -> None:
    """Fit, score, write and tell."""
    from palpate import __version__
    from palpate.cli.files import check_writable
    from palpate.cli.fit_view import fit_report
    from palpate.cli.terminal import console
    from palpate.fitting.documenting import Provenance, document
    from palpate.fitting.fit import fit
    from palpate.fitting.template import read_template

    data_from.check()
    check_writable("--output", output)
    moment = _day(day)
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
    words: list[object] = ["palpate", "network", "fit", "--like", like]
    if data_from.store is not None:
        words += ["--store", _shown(data_from.store)]
        words += [word for name, value in data_from.wanted.items() for word in (f"--{name}", value)]
    else:
        words += ["--csv", data_from.csv]
        words += ["--csv-readings", data_from.readings] if data_from.readings else []
        words += [word for text in data_from.columns for word in ("--column", text)]
    words += ["--pseudo-count", f"{settings.pseudo_count:g}"]
    words += [word for name in settings.keep for word in ("--keep", name)]
    return shlex.join(str(word) for word in (*words, "--output", output))


def _shown(place: str) -> str:
    if "://" not in place:
        return place
    from sqlalchemy import make_url

    return make_url(place).render_as_string(hide_password=True)
