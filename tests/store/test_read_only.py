"""Stores where nothing can be written, as a back-up on a read-only disk or the files of another user."""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from palpate.cli import main
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from palpate.store.verifying import verify
from tests.store.made_up import squeeze

Closing = Callable[[Path], None]
MADE = squeeze(1, files=(FileItem("cam0.png", "image/png", b"a picture"),))


@pytest.fixture
def close() -> Iterator[Closing]:
    """What makes a file, or a folder and all in it, read-only: root, whom no rights bind, mounts it so."""
    mounted, changed = list[Path](), dict[Path, int]()

    def closed(folder: Path) -> None:
        if os.geteuid() != 0:
            for path in (folder, *folder.rglob("*")):
                changed[path] = path.stat().st_mode
                path.chmod(0o555 if path.is_dir() else 0o444)
            return
        if sys.platform != "linux" or shutil.which("mount") is None:
            pytest.skip("root may write everywhere but on a disk that is mounted read-only")
        if subprocess.run(["mount", "--bind", folder, folder], check=False, capture_output=True).returncode:
            pytest.skip("mounting is not allowed here")
        mounted.append(folder)
        subprocess.run(["mount", "-o", "remount,ro,bind", folder], check=True)

    yield closed
    for folder in mounted:
        subprocess.run(["umount", "--lazy", folder], check=True)
    for path, mode in changed.items():
        path.chmod(mode)


@pytest.mark.parametrize("closed", ["backup", "backup/store.sqlite"])
def test_a_store_that_cannot_be_written_is_read(
    tmp_path: Path, close: Closing, capsys: pytest.CaptureFixture[str], closed: str
) -> None:
    """It is listed, read and verified, and nothing is left beside it; what would change it is refused in a sentence."""
    place = tmp_path / "backup" / "store.sqlite"
    with open_store(place) as store:
        store.put(MADE)
    close(tmp_path / closed)
    before = sorted(place.parent.rglob("*"))
    with open_store(place, make=False) as store:
        assert [row.id for row in list_recordings(store).rows] == [MADE.id]
        assert store.get(MADE.id) == MADE
        assert list(verify(store)) == []
        with pytest.raises(UnavailableError, match=r"store .*: attempt to write a readonly database") as refused:
            store.put(squeeze(2))
        assert "\n" not in str(refused.value)
    for command, code in ((("verify",), 0), (("list", "--json"), 0), (("object", "add", "a/b"), 2)):
        with pytest.raises(SystemExit) as ended:
            main(["store", *command, "--store", str(place)])
        printed = capsys.readouterr()
        assert (ended.value.code or 0, printed.err.count("\n")) == (code, int(code == 2)), printed
    assert sorted(place.parent.rglob("*")) == before


def test_a_log_that_cannot_be_worked_in_is_told(tmp_path: Path, close: Closing) -> None:
    """A copy that was made while the store was written to is not read without what stands in the log only."""
    place, copy = tmp_path / "store.sqlite", tmp_path / "backup" / "store.sqlite"
    copy.parent.mkdir()
    with open_store(place) as store:
        store.put(squeeze(1))
        for ending in ("", "-wal"):
            shutil.copy(f"{place}{ending}", f"{copy}{ending}")
    close(copy.parent)
    with pytest.raises(StoreError, match=r"store\.sqlite-wal has to be worked into it, .* expected a copy"):
        open_store(copy, make=False)
