"""Opening a store: where it is unless told otherwise, and made on first use."""

from __future__ import annotations

import os
from pathlib import Path

from sqlalchemy import URL

from palpate.store.blobs import Blobs, FolderBlobs
from palpate.store.database import connect, is_store, up_to_date
from palpate.store.errors import StoreError
from palpate.store.store import Store

__all__ = ["open_store"]


def open_store(
    place: str | Path | None = None, blobs: str | Path | None = None, *, durable: bool = True, make: bool = True
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
    durable
        See `palpate.store.database.connect`.
    make
        Whether one is made where there is none; who only reads does not want a new one for a name mistyped.

    Raises
    ------
    StoreError
        If it cannot be opened, or is not there and is not to be made.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder, open_store(f"{folder}/measurements.sqlite") as store:
    ...     type(store.blobs).__name__
    'FolderBlobs'
    """
    place = place or os.environ.get("PALPATE_STORE") or default_path()
    url = str(place)
    path = None if "://" in url else Path(url).absolute()
    if path is None and url.startswith("sqlite:///"):
        path = Path(url.removeprefix("sqlite:///")).absolute()
    if path is not None:
        if make:
            _make_folder(path.parent)
        elif not path.exists():
            raise _not_there(path)
        url = f"sqlite:///{path}"
    engine = connect(url, durable=durable)
    try:
        kept = _blobs(blobs or os.environ.get("PALPATE_BLOBS"), path)
        if not make and not is_store(engine):
            raise _not_there(path or engine.url)
        up_to_date(engine)
    except BaseException:
        engine.dispose()
        raise
    return Store(engine, kept)


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


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(
            f"store: the folder {folder} cannot be made ({error.strerror}), expected one that can"
        ) from None
