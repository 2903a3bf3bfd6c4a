import shutil
from pathlib import Path

import pytest

from palpate.recording.spool import Spool
from palpate.store.entries import Value
from palpate.store.opening import open_store
from tests.cli.conftest import Run
from tests.store.importing.invented import squeeze


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    return Spool(tmp_path / "spool", sync=False)


def leave_remainder(spool: Spool) -> None:
    spool.abandon(spool.begin(squeeze(series=(), files=(), log="", entries=())))


def test_list_shows_each_recording(run: Run, spool: Spool) -> None:
    """What waits, what was refused and what was cut off is listed, with what is known of it."""
    spool.add(squeeze())
    refused = spool.add(squeeze())
    with spool.claimed(refused):
        spool.refuse(refused, "no such owner")
    leave_remainder(spool)
    ran = run("spool", "list", "--spool", spool.folder)
    assert ran.code == 0
    assert "1 waiting, 1 refused, 1 not whole" in ran.out
    assert "squeezing of mug: elasticity" in ran.out
    assert "no such owner" in ran.out
    assert "was cut off: palpate spool recover" in ran.out


def test_list_tells_signals_from_nothing(run: Run, spool: Spool) -> None:
    """A recording without results has signals, or not even these."""
    spool.add(squeeze(entries=()))
    spool.add(squeeze(entries=(), series=()))
    out = run("spool", "list", "--spool", spool.folder).out
    assert out.count("squeezing of mug: signals") == 1
    assert out.count("squeezing of mug: no result") == 1


def test_recover_then_upload(run: Run, spool: Spool, tmp_path: Path) -> None:
    """What was cut off is recovered, sent, and then in the store and no longer in the spool."""
    spool.add(squeeze())
    leave_remainder(spool)
    ran = run("spool", "recover", "--spool", spool.folder)
    assert "1 recovered" in ran.out
    assert "failed, the recording was cut off before its end" in ran.out
    digests = [spool.read(name).digest for name in spool.waiting()]
    assert run("spool", "upload", "--spool", spool.folder, "--to", tmp_path / "store.sqlite").code == 0
    assert spool.waiting() == []
    with open_store(tmp_path / "store.sqlite") as store:
        assert [store.get(digest).digest for digest in digests] == digests


def test_where_they_were_sent_is_told(run: Run, spool: Spool, tmp_path: Path) -> None:
    """A store that is made is told on standard error, and where the recordings are now; a name mistyped shows."""
    spool.add(squeeze())
    place = tmp_path / "mesurements" / "x.sqlite"
    ran = run("spool", "upload", "--spool", spool.folder, "--to", place)
    assert ran.err == f"palpate: new store made at {place}\n"
    assert f"1 recording in sqlite:///{place}\n" in ran.out
    spool.add(squeeze(log="another"))
    assert run("spool", "upload", "--spool", spool.folder, "--to", place).err == ""


@pytest.mark.parametrize(
    ("to", "said"),
    [
        ("localhost:8000", "for a server expected http://localhost:8000, or https://..."),
        ("touch.example.org/api/v1", "for a server expected http://touch.example.org/api/v1, or https://..."),
        ("HTTP://touch.example.org/objects", "which ends in /api/v1: expected http://touch.example.org/api/v1"),
        ("http://127.0.0.1:9/api/v1/recordings/", "which ends in /api/v1: expected http://127.0.0.1:9/api/v1"),
    ],
)
def test_the_address_of_a_server_that_is_none_makes_no_store(
    run: Run, spool: Spool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, to: str, said: str
) -> None:
    """A new file of that name would take the recordings where nobody looks for them; a store that is there may."""
    monkeypatch.chdir(tmp_path)
    spool.add(squeeze())
    assert said in run("spool", "upload", "--spool", spool.folder, "--to", to).refused
    assert [path.name for path in tmp_path.iterdir()] == ["spool"]
    assert len(spool.waiting()) == 1
    with open_store(tmp_path / "made:1"):
        assert run("spool", "upload", "--spool", spool.folder, "--to", "made:1").code == 0


def test_nothing_is_made_for_nothing(run: Run, spool: Spool, tmp_path: Path) -> None:
    """Where nothing waits there is neither a store nor a folder made."""
    with spool.claimed(name := spool.add(squeeze())):
        spool.refuse(name, "no such owner")
    ran = run("spool", "upload", "--spool", spool.folder, "--to", tmp_path / "mesurements" / "x.sqlite")
    assert (ran.code, ran.err) == (1, "")
    assert "0 waiting, 1 refused" in ran.out
    assert not (tmp_path / "mesurements").exists()


def test_refused_ones_are_sent_again_when_asked(run: Run, spool: Spool, tmp_path: Path) -> None:
    """--refused queues them again."""
    name = spool.add(squeeze())
    with spool.claimed(name):
        spool.refuse(name, "no such owner")
    ran = run("spool", "upload", "--refused", "--spool", spool.folder, "--to", tmp_path / "store.sqlite")
    assert "sent" in ran.out
    assert "0 waiting, 0 refused" in ran.out


def test_what_did_not_leave_the_spool_is_exit_code_1(run: Run, spool: Spool, tmp_path: Path) -> None:
    """While something waits or was refused the command has not done its work, and says what to do."""
    spool.add(squeeze())
    refused = spool.add(squeeze(entries=(Value("fluffiness", 1.0, unit="kPa"),)))
    with open_store(tmp_path / "store.sqlite") as store:
        store.put(squeeze(action="weighing", entries=(Value("fluffiness", 1.0, unit="mm"),)))
    arguments = ("spool", "upload", "--spool", spool.folder, "--to", tmp_path / "store.sqlite")
    ran = run(*arguments)
    assert ran.code == 1
    assert "0 waiting, 1 refused" in ran.out
    assert "palpate spool upload --refused" in ran.out
    assert list(spool.refused()) == [refused]
    with spool.claimed(spool.add(squeeze())) as is_mine:
        assert is_mine
        ran = run(*arguments)
    assert ran.code == 1
    assert "1 waiting, 1 refused" in ran.out
    assert "palpate spool upload again" in ran.out
    shutil.rmtree(spool.folder / "refused" / refused)
    ran = run(*arguments)
    assert (ran.code, "again" in ran.out) == (0, False)


def test_a_server_that_is_away_is_one_sentence(run: Run, spool: Spool) -> None:
    """Nobody at the address is an error, exit code 2, and everything waits on."""
    spool.add(squeeze())
    ran = run("spool", "upload", "--spool", spool.folder, "--to", "http://127.0.0.1:9", "--attempts", 1)
    assert "no answer" in ran.refused
    assert len(spool.waiting()) == 1


@pytest.mark.parametrize("command", ["list", "recover", "upload"])
def test_a_wrong_path_is_no_empty_spool(run: Run, tmp_path: Path, command: str) -> None:
    """A folder that was typed wrong is an error, whether there is something else or nothing; nothing is made."""
    for wrong in (tmp_path, tmp_path / "none"):
        assert f"there is no spool at {wrong}" in run("spool", command, "--spool", wrong).refused
    assert list(tmp_path.iterdir()) == []


def test_nothing_recorded_yet_is_no_error(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The spool of one's own is made by the first recording, and is empty before; so is one that was emptied."""
    monkeypatch.setenv("PALPATE_SPOOL", str(tmp_path / "none"))
    assert "0 waiting" in run("spool", "list").out
    assert "0 recovered" in run("spool", "recover").out
    (tmp_path / "none" / "waiting").mkdir(parents=True)
    assert "0 waiting" in run("spool", "list", "--spool", tmp_path / "none").out
