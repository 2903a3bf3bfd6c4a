from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings

from palpate.store.checks import check
from palpate.store.entries import FailedEntry
from palpate.store.errors import DamagedError, StoreError
from palpate.store.importing.folder import JOURNAL, write_folder
from palpate.store.importing.reading_folder import read_folder, read_remainder
from palpate.store.records import Recording
from tests.store.importing.invented import recordings, squeeze


@given(recordings())
@settings(max_examples=60)
def test_any_recording_comes_back(recording: Recording) -> None:
    """A folder gives back the recording that was written, under the same id and digest."""
    check(recording)
    with TemporaryDirectory() as folder:
        write_folder(recording, Path(folder), sync=False)
        found = read_folder(Path(folder))
        assert [(item.name, item.data.read_bytes()) for item in found.files if isinstance(item.data, Path)] == [
            (item.name, item.data) for item in recording.files
        ]
    assert (found.id, found.digest, found.visibility) == (recording.id, recording.digest, recording.visibility)
    assert (found.thing, found.setup, found.entries) == (recording.thing, recording.setup, recording.entries)
    assert found.log == recording.log


def test_a_flipped_bit_is_found(tmp_path: Path) -> None:
    """A bit that changed in any file is an error that names a file, and never data."""
    write_folder(squeeze(), tmp_path)
    for path in sorted(tmp_path.iterdir()):
        content = path.read_bytes()
        if not content:
            continue
        middle = len(content) // 2
        path.write_bytes(content[:middle] + bytes([content[middle] ^ 4]) + content[middle + 1 :])
        with pytest.raises(StoreError, match=str(tmp_path)):
            read_folder(tmp_path)
        path.write_bytes(content)
    assert read_folder(tmp_path).digest == squeeze().digest


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    """An array that is gone is an error that names it."""
    write_folder(squeeze(), tmp_path)
    (tmp_path / "0001.npy").unlink()
    with pytest.raises(DamagedError, match=r"0001\.npy: is missing"):
        read_folder(tmp_path)


def test_whatever_is_left_of_the_journal_is_read(tmp_path: Path) -> None:
    """However much of the journal is left, it is a failed recording with what was written, or no recording at all."""
    whole = squeeze()
    write_folder(whole, tmp_path)
    journal = (tmp_path / JOURNAL).read_bytes()
    counts = []
    for length in range(len(journal)):
        (tmp_path / JOURNAL).write_bytes(journal[:length])
        with pytest.raises(StoreError, match="not whole"):
            read_folder(tmp_path)
        if b"\n" not in journal[:length]:
            with pytest.raises(StoreError, match="no recording was found"):
                read_remainder(tmp_path, "killed")
            continue
        found = read_remainder(tmp_path, "killed")
        counts.append(len(found.series) + len(found.files))
        assert found.series == whole.series[: len(found.series)]
        assert found.entries == (*whole.entries, FailedEntry("killed"))
        assert found.log == whole.log
    assert counts == sorted(counts)
    assert counts[-1] == len(whole.series) + len(whole.files)


def test_a_damaged_array_is_left_out_of_a_remainder(tmp_path: Path) -> None:
    """What is damaged in a remainder is left out and noticed; the rest is kept."""
    write_folder(squeeze(), tmp_path)
    (tmp_path / "0001.npy").write_bytes(b"zeros")
    (tmp_path / JOURNAL).write_bytes((tmp_path / JOURNAL).read_bytes().rpartition(b'{"end"')[0])
    found = read_remainder(tmp_path, "killed")
    assert [series.name for series in found.series] == ["camera"]
    assert any("0001.npy" in notice for notice in found.notices)


def test_arrays_are_copied(tmp_path: Path) -> None:
    """A buffer that is used again after it was recorded changes nothing."""
    from palpate.store.importing.folder import FolderWriter

    buffer = np.zeros(3)
    recording = squeeze()
    channel = recording.series[0].channels[0]
    writer = FolderWriter(tmp_path, squeeze(series=(), files=(), log=""))
    writer.add_series(type(recording.series[0])("gripper", (type(channel)("x", "x", None, buffer),)))
    buffer += 1
    writer.end()
    assert read_folder(tmp_path).series[0].channels[0].values.tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("no json", "no readable JSON"),
        ("[1]", "list was found"),
        ('{"format": "other"}', "the format is 'other'"),
        ('{"format": "palpate-recording/1", "id": 7}', "'id' cannot be read"),
        ('{"format": "palpate-recording/1", "colour": "red"}', "'colour' is no field"),
        ('{"format": "palpate-recording/1"}', "missing"),
        ('{"format": "palpate-recording/1", "series": 3}', "'series' is no field"),
    ],
)
def test_a_foreign_journal_is_refused(tmp_path: Path, line: str, told: str) -> None:
    """What is no journal of this format is refused in one sentence."""
    (tmp_path / JOURNAL).write_text(line + '\n{"end": "0"}\n')
    with pytest.raises(StoreError, match=told):
        read_folder(tmp_path)
