from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy.exc import OperationalError

from palpate.store.entries import Value
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Item, Outcome, identified
from palpate.store.records import FileItem, Recording
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.importing.test_uploads import labels, upload
from tests.store.made_up import squeeze


class Invented:
    """A format whose items are invented, whatever the path."""

    def __init__(self, *recordings: Recording | StoreError, stated: bool = False) -> None:
        self.recordings = recordings
        self.stated = stated
        self.reads = 0

    def owns(self, path: Path) -> bool:
        return True

    def count(self, path: Path) -> int:
        return len(self.recordings)

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        for number, recording in enumerate(self.recordings):
            digest = recording.digest if self.stated and isinstance(recording, Recording) else None
            yield Item(str(number), partial(self.read, recording), digest)

    def read(self, recording: Recording | StoreError) -> Recording:
        self.reads += 1
        if isinstance(recording, StoreError):
            raise recording
        return recording


def fates(store: Store, invented: Invented) -> list[str]:
    return [outcome.fate.value for outcome in import_paths(store, [Path()], [invented])]


def test_recordings_go_in_together(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many recordings are one transaction each two hundred, and all are there."""
    puts: list[int] = []
    put_checked = local.put_checked

    def counted(recordings: Any, **options: Any) -> Any:
        batch = list(recordings)
        puts.append(len(batch))
        return put_checked(batch, **options)

    monkeypatch.setattr(local, "put_checked", counted)
    assert fates(local, Invented(*(squeeze(number) for number in range(450)))) == ["new"] * 450
    assert puts == [200, 200, 50]
    assert list(verify(local)) == []


def test_one_that_is_refused_holds_up_no_other(local: Store) -> None:
    """Recordings that only the store can refuse are found among the others, which are taken."""
    given = [squeeze(number, entries=(Value("fluff", number, None, "kPa"),)) for number in range(20)]
    other_unit = squeeze(7, entries=(Value("fluff", 1, None, "g"),))
    id_of_another = replace(squeeze(100), id=given[3].id)
    told = list(import_paths(local, [Path()], [Invented(*given, other_unit, id_of_another)]))
    assert [outcome.fate for outcome in told].count(Fate.NEW) == 20
    assert [outcome.source for outcome in told if outcome.fate is Fate.REFUSED] == ["20", "21"]
    assert "unit 'g' is mass" in str(told[20].reason)


def test_what_is_wrong_by_itself_is_never_put(local: Store) -> None:
    """An item that cannot be read, and a recording that no store would keep, are refused with their reasons."""
    wrong = squeeze(1, action="")
    told = list(import_paths(local, [Path()], [Invented(StoreError("it is torn"), wrong, squeeze(2))]))
    assert [(one.fate, one.reason) for one in told] == [
        (Fate.REFUSED, "it is torn"),
        (Fate.REFUSED, "action: is empty, expected a name"),
        (Fate.NEW, None),
    ]


def test_a_file_that_is_gone_is_told(local: Store, tmp_path: Path) -> None:
    """A recording whose file was removed after it was found is refused by name."""
    gone = squeeze(1, files=(FileItem("a.png", "image/png", tmp_path / "a.png"),))
    (outcome,) = import_paths(local, [Path()], [Invented(gone)])
    assert outcome.fate is Fate.REFUSED
    assert "a.png" in str(outcome.reason)


def test_the_same_twice_is_one(local: Store) -> None:
    """The same recording in two files of one import is new once."""
    assert fates(local, Invented(squeeze(1), squeeze(1), squeeze(2))) == ["new", "known", "new"]


def test_what_is_there_is_not_put_again(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """A second import puts nothing; where the digest is stated it does not even read."""
    given = [squeeze(number) for number in range(5)]
    local.put_many(given)
    monkeypatch.setattr("palpate.store.store.prepare", None)
    read, stated = Invented(*given), Invented(*given, stated=True)
    assert fates(local, read) == fates(local, stated) == ["known"] * 5
    assert (read.reads, stated.reads) == (5, 0)


def test_large_recordings_are_not_gathered(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Signals of more than a batch's bytes are kept before more is read."""
    monkeypatch.setattr("palpate.store.importing.intake.LARGEST_BATCH_BYTES", 2500)
    kept_after = []
    put_checked = local.put_checked

    def watched(recordings: Any, **options: Any) -> Any:
        batch = list(recordings)
        kept_after.append(len(batch))
        return put_checked(batch, **options)

    monkeypatch.setattr(local, "put_checked", watched)
    assert fates(local, Invented(*(squeeze(number) for number in range(7)))) == ["new"] * 7
    # a squeeze is 1240 bytes
    assert kept_after == [3, 3, 1]


def test_an_import_goes_on_where_it_was_broken_off(local: Store) -> None:
    """What was told as new before a break is there, and the next run finds it."""
    given = [squeeze(number) for number in range(500)]
    running = import_paths(local, [Path()], [Invented(*given)])
    first = list(islice(running, 201))
    del running
    assert {outcome.recording.digest for outcome in first if outcome.recording} <= local.known(
        recording.digest for recording in given
    )
    assert sorted(fates(local, Invented(*given))) == ["known"] * 400 + ["new"] * 100
    assert list(verify(local)) == []


def test_a_store_that_is_away_ends_the_import(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """A database that fails is no fault of the recordings: they are not refused, and the import says why it ends."""

    def away(batch: Any) -> Any:
        raise OperationalError("INSERT", {}, Exception("the server closed the connection"))

    monkeypatch.setattr(local, "_commit", away)
    with pytest.raises(UnavailableError, match="closed the connection; nothing was kept"):
        fates(local, Invented(squeeze(1), squeeze(2)))


def test_a_picture_beside_its_file_is_no_stranger(local: Store, tmp_path: Path) -> None:
    """A file that a recording took is not told as skipped; another one is."""
    folder = tmp_path / "given"
    (folder / "imgs").mkdir(parents=True)
    for name in ("a.png", "b.png"):
        (folder / "imgs" / name).write_bytes(b"picture")
    upload(folder, "cat-vision_0", labels("cat-vision", mug=1.0), {"eye": {"image": "imgs/a.png"}})
    told = list(import_paths(local, [folder], all_formats()))
    assert [(one.fate, Path(one.source).name) for one in told[1:]] == [(Fate.SKIPPED, "b.png")]


def test_an_id_follows_from_the_digest() -> None:
    """The same content has the same id, whatever it was called before, and its digest stays."""
    one, other = identified(squeeze(1)), identified(squeeze(1))
    assert (one.id, one.digest) == (other.id, squeeze(1).digest)
    assert identified(squeeze(2)).id != one.id
    assert replace(one).digest == one.digest


@pytest.mark.parametrize("stated", [True, False])
def test_a_recording_without_its_blobs_is_mended(store: Store, stated: bool) -> None:
    """What the store has without its files is read and put again, which gives them back; what is whole is not."""
    lost, whole = (squeeze(number, files=(FileItem("a", "x/y", b"%d" % number),)) for number in (1, 2))
    store.put_many([lost, whole, squeeze(3)])
    store.blobs.remove(lost.files[0].sha256)
    new = squeeze(4, files=(FileItem("a", "x/y", b"4"),))
    invented = Invented(whole, lost, squeeze(3), new, stated=stated)
    assert sorted(fates(store, invented)) == ["known", "known", "mended", "new"]
    assert list(verify(store)) == []
    assert set(fates(store, invented)) == {"known"}


def test_what_came_in_this_import_is_not_mended(local: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """A recording with files that stands twice in what is imported is new once, and known the second time."""
    monkeypatch.setattr("palpate.store.importing.intake.AT_ONCE", 1)
    first, new = (squeeze(number, files=(FileItem("a", "x/y", b"%d" % number),)) for number in (1, 2))
    local.put(first)
    assert fates(local, Invented(first, new, new, stated=True)) == ["known", "new", "known"]
