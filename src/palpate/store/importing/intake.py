"""The one loop that puts items of any format into a store."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from palpate.errors import PalpateError
from palpate.store.checks import check
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.importing.finding import Found, find, told
from palpate.store.importing.items import Fate, Format, Item, Outcome
from palpate.store.importing.presence import Presence
from palpate.store.importing.zips import Zips
from palpate.store.records import FileItem, Recording
from palpate.store.store import Store

__all__ = ["import_items", "import_paths"]

AT_ONCE = 200
"""Items that are looked up together, and recordings of one transaction at most."""
LARGEST_BATCH_BYTES = 32 << 20
"""Signals and files of one transaction, after which no more is read before they are kept."""


@dataclass(frozen=True, eq=False)
class Read:
    """A recording that was read, and what it was read from."""

    source: str
    recording: Recording
    size_bytes: int
    is_known_wrong: bool


def import_paths(
    store: Store,
    paths: Iterable[Path],
    formats: Sequence[Format],
    *,
    uploader: str | None = None,
    zips: Zips | None = None,
) -> Iterator[Outcome]:
    """Put the recordings in files and folders into a store, and tell what became of each once it is committed.

    Whatever ends this in the middle, what was committed is whole and stays. Run again it goes on: a recording that
    the store has is known by its digest. One whose files or signals are missing in the blobs gets them back.

    Parameters
    ----------
    store
        Where they go.
    paths
        Files and folders; a folder may hold any of the formats.
    formats
        Which are looked for; the first that owns a path reads it.
    uploader
        The account that has sent them, where one did.
    zips
        Unpacks what is packed; without it zip files are skipped.

    Yields
    ------
    Outcome
        One for each item, and at the end those of files that nothing could be made of.

    Raises
    ------
    UnavailableError
        If the store cannot be used any more. What is wrong with a file or recording is told in its outcome.
    """
    outcomes = _import(store, find(paths, formats, zips), uploader)
    return outcomes if zips is None else map(zips.named, outcomes)


def _import(store: Store, found: Iterable[Found | Outcome], uploader: str | None) -> Iterator[Outcome]:
    unknown, whole = list[Outcome](), list[Found]()
    used: set[str] = set()
    for outcome in import_items(store, _items(store, found, unknown, whole), uploader):
        used.update(_files_beside(outcome))
        yield outcome
    for one in whole:
        yield from one.put_more(store)
    # a picture that lies beside the file that names it belongs to that one
    yield from (outcome for outcome in unknown if outcome.source not in used)


def _items(
    store: Store, found: Iterable[Found | Outcome], unknown: list[Outcome], whole: list[Found]
) -> Iterator[Item | Outcome]:
    """The items of all that was found; put aside what nothing can be made of, and what was read to its end."""
    for one in found:
        if not isinstance(one, Found):
            unknown.append(one)
            continue
        refused = one.admit_units(store)
        if refused is not None:
            yield refused
            continue
        broken = False
        for item in one.items():
            broken = isinstance(item, Outcome) and item.source == str(one.path)
            yield item
        if not broken:
            whole.append(one)


def _files_beside(outcome: Outcome) -> Iterator[str]:
    """The files that a recording in a single file took from elsewhere."""
    files = () if outcome.recording is None else outcome.recording.files
    if any(isinstance(item.data, Path) for item in files) and Path(outcome.source).is_file():
        yield from (str(item.data) for item in files if isinstance(item.data, Path))


def import_items(store: Store, items: Iterator[Item | Outcome], uploader: str | None) -> Iterator[Outcome]:
    """Read items and put them into a store, as many at once as is quick, as `import_paths` does."""
    presence = Presence(store)
    while chunk := list(islice(items, AT_ONCE)):
        known, _ = presence.known(item.digest for item in chunk if isinstance(item, Item) and item.digest)
        batch, size_bytes = list[Read](), 0
        for item in chunk:
            outcome = _read(item, known)
            if isinstance(outcome, Outcome):
                yield outcome
                continue
            batch.append(outcome)
            size_bytes += outcome.size_bytes
            if size_bytes > LARGEST_BATCH_BYTES:
                yield from _keep(presence, batch, uploader)
                batch, size_bytes = [], 0
        yield from _keep(presence, batch, uploader)


def _read(item: Item | Outcome, known: Collection[str]) -> Read | Outcome:
    """A recording that may be kept as far as it can tell itself, or what became of the item without one."""
    if isinstance(item, Outcome):
        return item
    if item.digest in known:
        return Outcome(item.source, Fate.KNOWN)
    try:
        recording = item.read()
        check(recording, is_new=not item.was_kept)
        # this reads its files, so that one that cannot be read is found before anything is put
        recording.digest  # noqa: B018
        return Read(item.source, recording, _size_bytes(recording), item.is_known_wrong)
    except (PalpateError, OSError, RecursionError) as error:
        return Outcome(item.source, Fate.REFUSED, told(error, item.source))


def _keep(presence: Presence, batch: Sequence[Read], uploader: str | None) -> Iterator[Outcome]:
    """Keep what the store does not have whole: looking up a digest is quicker than putting it again."""
    known, broken = presence.known(one.recording.digest for one in batch)
    there = [one for one in batch if one.recording.digest in known]
    hidden = (
        set() if uploader is None else presence.store.note_sender([one.recording.digest for one in there], uploader)
    )
    for one in there:
        fate = Fate.NEW if one.recording.digest in hidden else Fate.KNOWN
        yield Outcome(one.source, fate, None, one.recording)
    lacking = [one for one in batch if one.recording.digest not in known]
    yield from _put(presence.store, lacking, broken, uploader)


def _put(store: Store, batch: Sequence[Read], broken: Collection[str], uploader: str | None) -> Iterator[Outcome]:
    """Put recordings at once; where one is refused, each half by itself, so that it does not hold up the others.

    Parameters
    ----------
    broken
        Digests of recordings that were there and lacked something: putting them again brings it back.
    """
    try:
        wrong = {one.recording.digest for one in batch if one.is_known_wrong}
        recordings = [one.recording for one in batch]
        receipts = store.put_checked(recordings, known_wrong=wrong, uploader=uploader) if batch else []
    except UnavailableError:
        raise
    except StoreError as error:
        if len(batch) == 1:
            yield Outcome(batch[0].source, Fate.REFUSED, told(error, batch[0].source))
            return
        middle = len(batch) // 2
        yield from _put(store, batch[:middle], broken, uploader)
        yield from _put(store, batch[middle:], broken, uploader)
        return
    for one, receipt in zip(batch, receipts, strict=True):
        there = Fate.MENDED if receipt.digest in broken else Fate.KNOWN
        yield Outcome(one.source, Fate.NEW if receipt.new else there, None, one.recording)


def _size_bytes(recording: Recording) -> int:
    arrays = sum(channel.values.nbytes for series in recording.series for channel in series.channels)
    return arrays + len(recording.log) + sum(_file_bytes(item) for item in recording.files)


def _file_bytes(item: FileItem) -> int:
    return len(item.data) if isinstance(item.data, bytes) else item.data.stat().st_size
