"""What `palpate network fit` and `palpate calibrate` do: data read, a network fitted, scored, written and told."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from palpate.cli.fit_data import DataFrom
from palpate.cli.fit_options import How
from palpate.errors import PalpateError, plural

if TYPE_CHECKING:
    from palpate.fitting.data import Data
    from palpate.fitting.scores import Score
    from palpate.fitting.settings import Settings
    from palpate.fitting.template import Template
    from palpate.network.model import Network

__all__ = ["All", "Part", "fit_network"]


class Part(Protocol):
    """What of a network is fitted."""

    @property
    def command(self) -> tuple[str, ...]:
        """The command that fits it."""

    def settings(self, network: Network, how: How) -> Settings:
        """How the network is fitted."""

    @property
    def words(self) -> list[str]:
        """What was typed."""


@dataclass(frozen=True)
class All:
    """All of it, but what is kept."""

    kept: tuple[str, ...]

    @property
    def command(self) -> tuple[str, ...]:
        """The command that fits it."""
        return ("network", "fit")

    def settings(self, network: Network, how: How) -> Settings:
        """How the network is fitted."""
        from palpate.fitting.errors import FittingError
        from palpate.fitting.settings import Settings

        try:
            settings = Settings(how.pseudo_count, self.kept)
            settings.check(network)
        except FittingError as error:
            # fields are called as the options are
            raise PalpateError(f"--{error}") from None
        return settings

    @property
    def words(self) -> list[str]:
        """What was typed."""
        return [word for name in self.kept for word in ("--keep", name)]


def fit_network(like: str, data_from: DataFrom, part: Part, output: Path, how: How, *, force: bool) -> None:
    """Fit, score, write and tell."""
    from palpate import __version__
    from palpate.cli.fit_view import fit_report
    from palpate.cli.terminal import console
    from palpate.fitting.documenting import Provenance, document
    from palpate.fitting.fit import fit
    from palpate.fitting.template import read_template

    data_from.check()
    _check_output(output, force=force)
    folds, moment, template = _folds(how.folds), _day(how.date), read_template(like)
    settings = part.settings(template.network, how)
    data = data_from.read(template.network)
    fitted = fit(template, data.specimens, settings)
    if not fitted.estimated:
        raise PalpateError(
            f"{' '.join(part.command)}: found {plural(len(data.specimens), 'object')}, from which nothing of the "
            "network can be estimated; expected more of them, with known properties and the states of their parents, "
            "or readings of these properties"
        )
    scores = _scores(template, data, settings, folds) if folds else {}
    words = ["palpate", *part.command, "--like", like, *data_from.words, "--pseudo-count", f"{how.pseudo_count:g}"]
    command = shlex.join(str(word) for word in (*words, *part.words, "--output", output))
    made = Provenance(like, command, __version__, moment or _last(data), scores)
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
