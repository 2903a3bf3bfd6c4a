"""Folders packed as zip files: imported as if they were unpacked where they are, and nothing stays of them."""

import io
import json
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile

import pytest

from palpate.store.archive import export_archive
from palpate.store.importing.folder import write_folder
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Outcome
from palpate.store.importing.package import pack
from palpate.store.importing.zips import Zips
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from palpate.store.store import Store
from tests.store.importing.test_uploads import labels, upload
from tests.store.made_up import squeeze


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Where temporary files are made; none is left there."""
    found = tmp_path / "temporary"
    found.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(found))
    yield found
    assert list(found.iterdir()) == []


def zipped(file: Path, files: Mapping[str, bytes]) -> Path:
    file.parent.mkdir(exist_ok=True)
    with ZipFile(file, "w", ZIP_DEFLATED) as packed:
        for name, data in files.items():
            packed.writestr(name, data)
    return file


def packed_folder(file: Path, folder: Path) -> Path:
    files = (path for path in folder.rglob("*") if path.is_file())
    return zipped(file, {str(path.relative_to(folder)): path.read_bytes() for path in files})


def imported(store: Store, *paths: Path) -> list[Outcome]:
    with Zips() as zips:
        return list(import_paths(store, paths, all_formats(), zips=zips))


def told(outcomes: list[Outcome]) -> dict[str, tuple[Fate, str | None]]:
    return {one.source: (one.fate, one.reason) for one in outcomes}


def test_a_package_is_imported(store: Store, tmp_path: Path) -> None:
    """The same recording as its folder, in whatever folder the file is; what is large in it too."""
    sent = squeeze(1, files=(FileItem("scan.bin", "application/octet-stream", bytes(3 << 20)),))
    given = tmp_path / "given"
    given.mkdir()
    with (given / "session.zip").open("xb") as opened:
        pack(sent, opened)
    (tmp_path / "folder").mkdir()
    write_folder(sent, tmp_path / "folder")
    assert told(imported(store, given)) == {str(given / "session.zip"): (Fate.NEW, None)}
    again = imported(store, tmp_path / "folder", given / "session.zip")
    assert [one.fate for one in again] == [Fate.KNOWN, Fate.KNOWN]
    assert store.get(sent.digest) == sent


def test_other_folders_are_imported(store: Store, tmp_path: Path) -> None:
    """An archive and upload dictionaries; what is refused or skipped is told by its place in the zip file."""
    with open_store(tmp_path / "first.sqlite", durable=False) as first:
        first.put_many([squeeze(number) for number in range(3)])
        export_archive(first, tmp_path / "archive")
    archive = packed_folder(tmp_path / "an archive.ZIP", tmp_path / "archive")
    loose = tmp_path / "loose"
    loose.mkdir()
    upload(loose, "mat-vision_0", labels("mat-vision", plastic=1.0), {})
    upload(loose, "mat-vision_1", labels("mat-vision", plastic=0.6), {})
    (loose / "notes.txt").write_text("hello")
    zipped(loose / "inner.zip", {"notes.txt": b"hello"})
    found = told(imported(store, archive, packed_folder(tmp_path / "loose.zip", loose)))
    fates = [fate for fate, _ in found.values()]
    assert (fates.count(Fate.NEW), fates.count(Fate.REFUSED), fates.count(Fate.SKIPPED)) == (4, 1, 2)
    assert sum(source.startswith(f"{archive}: recording ") for source in found) == 3
    unknown = (Fate.SKIPPED, "of no format that palpate knows")
    assert found[f"{tmp_path}/loose.zip/notes.txt"] == found[f"{tmp_path}/loose.zip/inner.zip"] == unknown
    assert all(str(tmp_path / "temporary") not in f"{source} {reason}" for source, (_, reason) in found.items())


def test_what_cannot_be_unpacked_is_refused(
    store: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, scratch: Path
) -> None:
    """With the file and the reason; the others are imported."""
    whole = io.BytesIO()
    pack(squeeze(1), whole)
    paths = {
        "cut": tmp_path / "cut.zip",
        "text": tmp_path / "text.zip",
        "up": zipped(tmp_path / "up.zip", {"../../up.txt": b"x"}),
        "large": zipped(tmp_path / "large.zip", {"zeros": bytes(9 << 20)}),
        "good": tmp_path / "good.zip",
    }
    paths["cut"].write_bytes(whole.getvalue()[:-40])
    paths["text"].write_text("hello")
    paths["good"].write_bytes(whole.getvalue())
    usage = shutil.disk_usage(scratch)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage._replace(free=8 << 20))
    found = told(imported(store, *paths.values(), paths["cut"]))
    reasons = {name: found[str(path)][1] for name, path in paths.items()}
    assert {name for name, path in paths.items() if found[str(path)][0] is Fate.REFUSED} == paths.keys() - {"good"}
    assert found[str(paths["good"])] == (Fate.NEW, None)
    assert "cannot be unpacked" in (reasons["cut"] or "")
    assert "cannot be unpacked" in (reasons["text"] or "")
    assert "leads out of its folder" in (reasons["up"] or "")
    assert reasons["large"] == f"all is more than {8 << 20} bytes when unpacked"
    assert not (tmp_path / "up.txt").exists()


def test_without_it_zip_files_are_skipped(store: Store, tmp_path: Path) -> None:
    """As any file of no format."""
    file = zipped(tmp_path / "a.zip", {"b.json": json.dumps({}).encode()})
    (outcome,) = import_paths(store, [file], all_formats())
    assert outcome.fate is Fate.SKIPPED
