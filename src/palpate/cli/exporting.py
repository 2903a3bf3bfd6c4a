"""What `palpate store export` does: options to formats, and telling what was written."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.cli.storing import check_name
from palpate.errors import PalpateError, plural
from palpate.invisible import shown

if TYPE_CHECKING:
    from palpate.store.exporting.publication import Terms
    from palpate.store.exporting.writing import Format, Written

__all__ = ["Wishes", "naming_options", "tell_written"]

DEFAULT_FPS = 30
SHOWN = 20
TERMS = ("--title", "--author", "--licence", "--include-private")
FRAMES = ("--fps", "--resample", "--assumed-rate")
STATED_BY = {
    "authors": "--author",
    "licence": "--licence",
    "include_private": "--include-private",
    "assumed_rate_hz": "--assumed-rate",
}
"""Parts of an export to the options that state them."""
ALLOWED: Mapping[str, tuple[str, ...]] = {
    "archive": (),
    "parquet": TERMS,
    "hugging-face": TERMS,
    "lerobot": (*TERMS, *FRAMES),
}


@dataclass(frozen=True)
class Wishes:
    """The options as they were typed; None, empty or false where they were not."""

    form: str
    title: str | None
    authors: tuple[str, ...]
    licence: str | None
    include_private: bool
    fps: int | None
    resample: str | None
    assumed_rate_hz: float | None

    def format(self) -> Format:
        """The format that they say.

        Raises
        ------
        PalpateError
            If there is none of that name, or an option is not for it.
        """
        check_name("--format", self.form, ALLOWED)
        for option in self._given():
            if option not in ALLOWED[self.form]:
                able = " or ".join(name for name, allowed in ALLOWED.items() if option in allowed)
                raise PalpateError(f"{option}: is nothing that --format {self.form} has, expected --format {able}")
        return self._format()

    def _given(self) -> Iterator[str]:
        values = (self.title, self.authors, self.licence, self.include_private)
        frames = (self.fps, self.resample, self.assumed_rate_hz)
        for option, value in zip((*TERMS, *FRAMES), (*values, *frames), strict=True):
            if value is not None and value != () and value is not False:
                yield option

    def _format(self) -> Format:
        from palpate.store.archive import Archive
        from palpate.store.exporting.hugging_face import HuggingFace
        from palpate.store.exporting.publication import Terms
        from palpate.store.exporting.tables import Tables

        if self.form == "archive":
            return Archive()
        terms = Terms(self.title, self.authors, self.licence, self.include_private)
        if self.form == "parquet":
            return Tables(terms)
        return HuggingFace(terms) if self.form == "hugging-face" else self._lerobot(terms)

    def _lerobot(self, terms: Terms) -> Format:
        from palpate.store.exporting.lerobot.dataset import LeRobot
        from palpate.store.exporting.lerobot.resampling import Linear, Nearest, Resampling

        rules: Mapping[str, Resampling] = {"nearest": Nearest(), "linear": Linear()}
        rule = self.resample or "nearest"
        check_name("--resample", rule, rules)
        rate_hz = self.assumed_rate_hz
        if rate_hz is not None and not (math.isfinite(rate_hz) and rate_hz > 0):
            raise PalpateError(f"--assumed-rate: {rate_hz:g} was found, expected samples per second, more than 0")
        return LeRobot(terms, self.fps or DEFAULT_FPS, rules[rule], rate_hz)


@contextmanager
def naming_options() -> Iterator[None]:
    """Let an error on what an export lacks name the options that state it."""
    from palpate.store.exporting.publication import LackingError

    try:
        yield
    except LackingError as error:
        raise PalpateError(error.told(STATED_BY)) from None


def tell_written(folder: Path, written: Written) -> None:
    """Print how many recordings were written, and what was not and why."""
    print(f"{folder}: {plural(written.recordings, 'recording')}")
    if written.withheld:
        print(f"- {plural(written.withheld, 'recording')} left out, not public (--include-private takes them too)")
    for notice in written.notices[:SHOWN]:
        print(shown(f"- {notice}"))
    if len(written.notices) > SHOWN:
        print(f"- and {len(written.notices) - SHOWN} more")
