"""Opening a store: where it is unless told otherwise, and made on first use."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from sqlalchemy import URL

from palpate.store.blobs import Blobs, FolderBlobs
from palpate.store.database import CACHE_BYTES, connect, is_store, up_to_date
from palpate.store.errors import StoreError
from palpate.store.foreign import is_foreign
from palpate.store.store import Store

__all__ = ["blobs_of", "open_store"]


def open_store(
    place: str | Path | None = None,
    blobs: str | Path | None = None,
    *,
    durable: bool = True,
    cache_bytes: int = CACHE_BYTES,
    make: bool = True,
    made: Callable[[str], object] = lambda _: None,
) -> Store:
    """Open a store, and make it where there is none.

    Parameters
    ----------
    place
        Path of an SQLite file, or ``postgresql+psycopg://...``; from the environment variable ``PALPATE_STORE``
        unless given, else a file in the user's data folder.
    blobs
        Folder for large bytes, or ``s3://bucket/prefix``; from ``PALPATE_BLOBS`` unless given, else a folder beside
        the SQLite file.
    durable, cache_bytes
        See `palpate.store.database.connect`.
    make
        Whether one is made where there is none; who only reads does not want a new one for a name mistyped.
    made
        Called with the place of a store that has just been made, for people to read.

    Raises
    ------
    StoreError
        If it cannot be opened, or is not there and is not to be made, or a place is empty.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, open_store(f"{folder}/measurements.sqlite") as store:
    ...     type(store.blobs).__name__
    'FolderBlobs'
    """
    url, path = _place(place)
    _check_given("blobs", blobs)
    if path is not None:
        _check_file(path, make=make)
        url = f"sqlite:///{path}"
    engine = connect(url, durable=durable, cache_bytes=cache_bytes)
    try:
        kept = blobs_of(place, blobs)
        is_new = not is_store(engine)
        if is_new and not make:
            raise _not_there(path or engine.url)
        up_to_date(engine)
        if is_new:
            # the text of an address hides its password
            made(str(path or engine.url))
    except BaseException:
        engine.dispose()
        raise
    return Store(engine, kept)


def blobs_of(place: str | Path | None = None, blobs: str | Path | None = None) -> Blobs:
    """Where a store would have its large bytes, without opening or making it; places as of `open_store`.

    Raises
    ------
    StoreError
        If it is no such place.
    """
    _, path = _place(place)
    _check_given("blobs", blobs)
    return _blobs(blobs or os.environ.get("PALPATE_BLOBS"), path)


def _place(place: str | Path | None) -> tuple[str, Path | None]:
    """The address of a database, or the file that it is."""
    _check_given("store", place)
    url = str(place or os.environ.get("PALPATE_STORE") or default_path())
    path = None if "://" in url else Path(url).absolute()
    if path is None and url.startswith("sqlite:///"):
        path = Path(url.removeprefix("sqlite:///")).absolute()
    return url, path


def _check_given(name: str, given: str | Path | None) -> None:
    # of a variable of the shell that is not set; another store than the one that was meant would be written to
    if isinstance(given, str) and not given.strip():
        raise StoreError(f"{name}: found {given!r}, expected a place, or none at all for the usual one")


def default_path() -> Path:
    """The store in the user's data folder."""
    from platformdirs import user_data_path

    return user_data_path("palpate", appauthor=False) / "store.sqlite"


def _blobs(place: str | Path | None, database: Path | None) -> Blobs:
    if place is not None and "://" in str(place):
        from palpate.store.bucket import BucketBlobs

        return BucketBlobs(str(place))
    if place is not None:
        return FolderBlobs(Path(place).absolute())
    if database is None:
        raise StoreError(
            "blobs: none were given and PALPATE_BLOBS is not set, expected a folder or s3://... for the large bytes of "
            "a store that is no SQLite file"
        )
    return FolderBlobs(database.with_name(database.name + "-blobs"))


def _not_there(place: Path | URL) -> StoreError:
    # the text of an address hides its password
    return StoreError(f"there is no store at {place}, expected one that an import or a recording has made")


def _check_file(path: Path, *, make: bool) -> None:
    """Refuse a file that is no store, before anything in it or beside it is changed; make its folder."""
    foreign = is_foreign(path)
    if not make and (foreign or not path.exists()):
        raise _not_there(path)
    if foreign:
        raise StoreError(
            f"store {str(path)!r}: holds the tables of another program, expected a store or the name of a new file"
        )
    if make:
        _make_folder(path.parent)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"store: the folder {folder} cannot be made ({error.strerror}), expected one that can"
        ) from None
