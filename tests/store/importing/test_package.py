import io
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZipFile

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.importing.package import pack, unpack
from palpate.store.records import FileItem, Recording
from tests.store.importing.invented import recordings, squeeze


@given(recordings())
@settings(max_examples=25)
def test_any_recording_comes_back(recording: Recording) -> None:
    """A package gives back the recording that was packed."""
    file = io.BytesIO()
    pack(recording, file)
    with TemporaryDirectory() as folder:
        found = unpack(file, lambda: Path(folder))
        assert (found.id, found.digest) == (recording.id, recording.digest)


def test_large_ones_are_unpacked_on_the_disk(tmp_path: Path) -> None:
    """Whether the files are in a folder or in memory, the recording is the same."""
    for number, size in enumerate((100, 3 << 20)):
        folder = tmp_path / str(number)
        folder.mkdir()
        recording = squeeze(files=(FileItem("scan.bin", "application/pdf", bytes(size)),))
        file = io.BytesIO()
        pack(recording, file)
        found = unpack(file, lambda: folder)  # noqa: B023 - it is called at once
        assert (found.digest, bool(list(folder.iterdir()))) == (recording.digest, size > 1 << 20)


@given(st.binary(max_size=40), st.integers(0, 10_000))
@settings(max_examples=60)
def test_a_changed_package_is_refused_or_the_same(junk: bytes, place: int) -> None:
    """Bytes written over a package give a StoreError, or the same recording."""
    file = io.BytesIO()
    pack(squeeze(), file)
    file.seek(place % len(file.getvalue()))
    file.write(junk)
    with TemporaryDirectory() as folder:
        try:
            found = unpack(file, lambda: Path(folder)).digest
        except StoreError:
            found = "refused"
    assert found in ("refused", squeeze().digest)


@pytest.mark.parametrize("name", ["../x", "a/b", "/etc/x", "C:x", "..\\x", ".."])
def test_names_with_folders_are_refused(tmp_path: Path, name: str) -> None:
    """A package cannot write outside its folder."""
    file = io.BytesIO()
    with ZipFile(file, "w") as package:
        package.writestr(name, b"x")
    (tmp_path / "in").mkdir()
    with pytest.raises(StoreError):
        unpack(file, lambda: tmp_path / "in")
    assert [path.name for path in tmp_path.rglob("*")] == ["in"]


def test_a_package_that_unpacks_to_too_much_is_refused(tmp_path: Path) -> None:
    """The size when unpacked has a limit."""
    file = io.BytesIO()
    pack(squeeze(log="x" * 100_000), file)
    with pytest.raises(StoreError, match="expected 50000 at most"):
        unpack(file, lambda: tmp_path, largest_bytes=50_000)
