import shutil
from pathlib import Path
from uuid import UUID

import pytest
from hypothesis import given, settings

from palpate.recording.errors import RecordingError
from palpate.recording.spool import KILLED, Spool, default_folder
from palpate.store.entries import FailedEntry
from palpate.store.errors import StoreError
from palpate.store.records import Recording
from tests.store.importing.invented import recordings, squeeze


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    return Spool(tmp_path / "spool", sync=False)


def leave_remainder(spool: Spool) -> str:
    """What a killed program leaves: an open recording that nobody holds."""
    unfinished = spool.begin(squeeze(series=(), files=(), log=""))
    unfinished.writer.add_series(squeeze().series[0])
    unfinished.writer.write_log("closing\n")
    spool.abandon(unfinished)
    return unfinished.name


@pytest.fixture(scope="module")
def one_spool(tmp_path_factory: pytest.TempPathFactory) -> Spool:
    return Spool(tmp_path_factory.mktemp("spool"), sync=False)


@given(recording=recordings())
@settings(max_examples=30)
def test_any_recording_comes_back(one_spool: Spool, recording: Recording) -> None:
    """The spool gives back what was put in, until it is removed."""
    name = one_spool.add(recording)
    assert one_spool.waiting() == [name]
    assert one_spool.read(name).digest == recording.digest
    one_spool.remove(name)
    assert one_spool.waiting() == []


def test_on_the_disk_too(tmp_path: Path) -> None:
    """With waiting for the disk it is the same."""
    spool = Spool(tmp_path / "new" / "spool")
    name = spool.add(squeeze())
    assert spool.read(name).digest == squeeze().digest


def test_the_oldest_is_first(spool: Spool) -> None:
    """Recordings wait in the order in which they were recorded."""
    first = squeeze().recorded_at
    moments = [first.replace(second=second) for second in (30, 10, 20)]
    for moment in moments:
        spool.add(squeeze(recorded_at=moment))
    assert [spool.read(name).recorded_at for name in spool.waiting()] == sorted(moments)


def test_a_remainder_is_recovered_as_failed(spool: Spool) -> None:
    """What a killed program left has its signals and its log, has failed, and waits."""
    name = leave_remainder(spool)
    assert spool.unfinished() == {name: False}
    ((found_name, found),) = spool.recover()
    assert isinstance(found, Recording)
    assert (found_name, spool.waiting(), spool.unfinished()) == (name, [name], {})
    assert found.entries[-1] == FailedEntry(KILLED)
    assert found.series == squeeze().series[:1]
    assert found.log == "closing\n"
    assert list(spool.recover()) == []


def test_what_is_being_recorded_is_left_alone(spool: Spool) -> None:
    """A recording in progress is no remainder, for this process and for others."""
    unfinished = spool.begin(squeeze(series=(), files=(), log=""))
    assert Spool(spool.folder).unfinished() == {unfinished.name: True}
    assert list(Spool(spool.folder).recover()) == []
    spool.finish(unfinished)
    assert spool.unfinished() == {}


def test_only_the_last_move_was_missing(spool: Spool) -> None:
    """A recording that was whole when the program was killed is recovered as it is, and not as failed."""
    unfinished = spool.begin(squeeze(series=(), files=(), log=""))
    digest = unfinished.writer.end(sync=False).digest
    spool.abandon(unfinished)
    ((_, found),) = spool.recover()
    assert isinstance(found, Recording)
    assert found.digest == digest
    assert found.entries == squeeze().entries


@pytest.mark.parametrize("cut", ["0001.npy", "log.txt"])
def test_a_whole_journal_with_a_cut_array_is_a_remainder(spool: Spool, cut: str) -> None:
    """After a power cut the journal may be whole and an array not: what is left waits, as failed; nothing raises."""
    unfinished = spool.begin(squeeze(series=(), files=(), log="", entries=()))
    for series in squeeze().series:
        unfinished.writer.add_series(series)
    unfinished.writer.write_log("closing\n")
    unfinished.writer.end(sync=False, entries=squeeze().entries)
    spool.abandon(unfinished)
    path = spool.folder / "open" / unfinished.name / cut
    path.write_bytes(path.read_bytes()[:-2])
    ((_, found),) = spool.recover()
    assert isinstance(found, Recording)
    assert found.entries == (*squeeze().entries, FailedEntry(KILLED))
    assert len(found.series) == (1 if cut == "0001.npy" else 2)
    assert (cut in " ".join(found.notices)) == (cut == "0001.npy")
    assert spool.read(unfinished.name).digest == found.digest
    assert (spool.waiting(), spool.unfinished()) == ([unfinished.name], {})


def test_a_whole_remainder_is_on_the_disk_before_it_waits(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was killed before it was synced is synced before it is acknowledged."""
    spool, done = Spool(tmp_path / "spool"), list[str]()
    unfinished = spool.begin(squeeze(series=(), files=(), log=""))
    unfinished.writer.end(sync=False)
    spool.abandon(unfinished)
    monkeypatch.setattr("palpate.recording.spool.sync_tree", lambda folder: done.append(folder.parent.name))
    list(spool.recover())
    assert done == ["open"]


def test_the_same_recording_again_is_the_same(spool: Spool) -> None:
    """What is added twice waits once, also where it was refused before; another one under its id is an error."""
    name = spool.add(squeeze(id=UUID(int=1)))
    assert spool.add(squeeze(id=UUID(int=1))) == name
    with spool.claimed(name):
        spool.refuse(name, "no such owner")
    assert spool.add(squeeze(id=UUID(int=1))) == name
    assert (spool.waiting(), spool.refused()) == ([name], {})
    with pytest.raises(RecordingError, match=f"{name} is another recording"):
        spool.add(squeeze(id=UUID(int=1), action="weighing"))
    assert spool.read(name).action == "squeezing"
    assert list((spool.folder / "drafts").iterdir()) == []


def test_a_recovery_that_was_killed_is_done_again(spool: Spool, tmp_path: Path) -> None:
    """Whatever of a recovery was done, doing it again gives the same, and one recording."""
    name = leave_remainder(spool)
    shutil.copytree(spool.folder / "open" / name, tmp_path / "copy")
    ((_, first),) = spool.recover()
    shutil.copytree(tmp_path / "copy", spool.folder / "open" / name)
    (spool.folder / "drafts" / name).mkdir()
    (spool.folder / "done" / name).mkdir()
    ((_, again),) = spool.recover()
    assert isinstance(first, Recording)
    assert isinstance(again, Recording)
    assert first.digest == again.digest
    assert spool.waiting() == [name]


def test_what_cannot_be_read_stays(spool: Spool) -> None:
    """A remainder without a beginning stays where it is, with the reason; an empty one goes."""
    name = leave_remainder(spool)
    (spool.folder / "open" / name / "journal.jsonl").write_text("rubbish\n")
    (spool.folder / "open" / "empty").mkdir()
    ((_, found),) = spool.recover()
    assert isinstance(found, StoreError)
    assert spool.unfinished() == {name: False}


def test_a_copied_spool_is_a_spool(spool: Spool, tmp_path: Path) -> None:
    """The folder can be copied to another computer, with what waits and what is left."""
    name = spool.add(squeeze())
    leave_remainder(spool)
    shutil.copytree(spool.folder, tmp_path / "copy", ignore=shutil.ignore_patterns("locks", "drafts", "done"))
    copy = Spool(tmp_path / "copy")
    assert copy.read(name).digest == squeeze().digest
    assert len(list(copy.recover())) == 1


def test_one_id_is_recorded_once_at_a_time(spool: Spool) -> None:
    """Two that would record under one id are told so."""
    begun = squeeze(series=(), files=(), log="")
    unfinished = spool.begin(begun)
    with pytest.raises(RecordingError, match="being written already"):
        spool.begin(begun)
    spool.abandon(unfinished)


def test_nothing_is_made_by_looking(tmp_path: Path) -> None:
    """Listing a spool that is not there makes none."""
    spool = Spool(tmp_path / "none")
    assert (spool.waiting(), spool.refused(), spool.unfinished(), list(spool.recover())) == ([], {}, {}, [])
    assert not (tmp_path / "none").exists()


def test_where_the_spool_is(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """PALPATE_SPOOL says where it is; otherwise it is among the user's data."""
    monkeypatch.setenv("PALPATE_SPOOL", str(tmp_path))
    assert default_folder() == tmp_path
    monkeypatch.delenv("PALPATE_SPOOL")
    assert default_folder().parts[-2:] == ("palpate", "spool")
