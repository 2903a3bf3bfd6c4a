"""A disk that is full for real: a small file system in memory, where one may be mounted."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from palpate.cli import main
from palpate.store.archive import export_archive
from palpate.store.errors import UnavailableError
from palpate.store.opening import open_store
from palpate.store.records import FileItem, Recording
from palpate.store.verifying import verify
from tests.store.made_up import squeeze

SIZE_KIB = 4096


@pytest.fixture
def disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 4 MiB."""
    if sys.platform != "linux" or os.geteuid() != 0 or shutil.which("mount") is None:
        pytest.skip("only root may mount a small disk on Linux")
    folder = tmp_path / "disk"
    folder.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={SIZE_KIB}k", "tmpfs", folder], check=False, capture_output=True
    )
    if mounted.returncode:
        pytest.skip("mounting is not allowed here")
    yield folder
    subprocess.run(["umount", "--lazy", folder], check=True)


def enlarge(disk: Path) -> None:
    subprocess.run(["mount", "-o", f"remount,size={8 * SIZE_KIB}k", disk], check=True)


def with_picture(number: int, size: int) -> Recording:
    return squeeze(number, files=(FileItem("cam0", "image/png", number.to_bytes(4, "big") + os.urandom(size)),))


@pytest.mark.parametrize("picture_bytes", [0, 100_000], ids=["database", "blobs"])
def test_a_full_disk_loses_nothing(disk: Path, picture_bytes: int) -> None:
    """Where rows or blobs do not fit, putting is refused in one sentence; with space again, the same recording fits."""
    kept: list[str] = []
    with open_store(disk / "store.sqlite") as store:
        coming = [with_picture(number, picture_bytes) if picture_bytes else squeeze(number) for number in range(2000)]
        with pytest.raises(UnavailableError, match=r"full|No space left") as told:
            kept.extend(store.put(recording).digest for recording in coming)
        refused = coming[len(kept)]
        assert kept
        assert "\n" not in str(told.value)
        assert [store.get(digest).digest for digest in kept] == kept
        assert list(verify(store)) == []
        enlarge(disk)
        assert store.put(refused).new
        assert list(verify(store)) == []
    assert list(disk.rglob(".draft-*")) == [], "what did not fit was removed"


def test_an_export_that_does_not_fit_leaves_nothing(disk: Path, tmp_path: Path) -> None:
    """An archive appears whole or not at all; the command line says in one sentence that the disk is full."""
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        store.put_many([with_picture(number, 100_000) for number in range(60)])
        with pytest.raises((UnavailableError, OSError), match="No space left on device"):
            export_archive(store, disk / "archive")
    assert list(disk.iterdir()) == []
    with pytest.raises(SystemExit) as ended:
        main(["store", "export", str(disk / "archive"), "--store", str(tmp_path / "store.sqlite")])
    assert ended.value.code == 2
    assert list(disk.iterdir()) == []
