from pathlib import Path

import pytest

from palpate.store.archive import export_archive
from palpate.store.importing.finding import Found, count_items, find
from palpate.store.importing.folder import write_folder
from palpate.store.importing.formats import all_formats
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.importing.own_formats import Archives
from palpate.store.store import Store
from tests.store.importing.test_uploads import labels, upload
from tests.store.made_up import squeeze


@pytest.fixture
def mixed(local: Store, tmp_path: Path) -> Path:
    """A folder with an archive of two, a recording of a spool, an upload dictionary, a note and a link."""
    folder = tmp_path / "mixed"
    (folder / "deep" / "deeper").mkdir(parents=True)
    local.put_many([squeeze(1), squeeze(2)])
    export_archive(local, folder / "deep" / "archive")
    (folder / "spool" / "waiting" / "one").mkdir(parents=True)
    write_folder(squeeze(3), folder / "spool" / "waiting" / "one", sync=False)
    upload(folder / "deep" / "deeper", "mat-vision_0", labels("mat-vision", plastic=1.0), {})
    (folder / "notes.txt").write_text("hello")
    (folder / "up").symlink_to(folder)
    return folder


def test_all_formats_in_one_folder_are_found(mixed: Path) -> None:
    """Each recording is found once, in the folder of its own format; the rest is skipped by name."""
    found = list(find([mixed], all_formats()))
    names = [str((one.path if isinstance(one, Found) else Path(one.source)).relative_to(mixed)) for one in found]
    uploaded = "deep/deeper/upload_dict_2001_02_03_04_05_06_mat-vision_0.json"
    assert sorted(names) == ["deep/archive", uploaded, "notes.txt", "spool/waiting/one", "up"]
    skipped = {Path(one.source).name: one.reason for one in found if isinstance(one, Outcome)}
    assert skipped.keys() == {"notes.txt", "up"}
    assert "a link" in str(skipped["up"])
    items = [item for one in found if isinstance(one, Found) for item in one.items()]
    assert len([item for item in items if isinstance(item, Item)]) == 4


def test_what_is_counted_is_what_comes(mixed: Path) -> None:
    """The count for the bar is that of the items and of what is skipped."""
    found = list(find([mixed], all_formats()))
    items = [item for one in found for item in (one.items() if isinstance(one, Found) else [one])]
    assert count_items([mixed], all_formats()) == len(items) == 6


def test_a_link_that_is_named_is_followed(mixed: Path, tmp_path: Path) -> None:
    """A link is taken where it was given itself."""
    (tmp_path / "short").symlink_to(mixed / "spool")
    (found,) = find([tmp_path / "short"], all_formats())
    assert isinstance(found, Found)


def test_an_archive_that_cannot_be_read_is_refused(mixed: Path) -> None:
    """Its name and what is wrong are told, and it counts as one."""
    archive = mixed / "deep" / "archive"
    (archive / "entries.parquet").unlink()
    (found,) = find([archive], all_formats())
    assert isinstance(found, Found)
    (outcome,) = found.items()
    assert isinstance(outcome, Outcome)
    assert (outcome.fate, outcome.source) == (Fate.REFUSED, str(archive))
    assert "entries.parquet: is missing" in str(outcome.reason)
    (archive / "manifest.json").write_text("palpate archive, or not")
    assert count_items([archive], all_formats()) == 1


class Closed(Archives):
    """A format that may not look at one of the paths."""

    def owns(self, path: Path) -> bool:
        if path.name == "closed":
            raise PermissionError(13, "Permission denied", str(path / "manifest.json"))
        return super().owns(path)


def test_what_may_not_be_looked_at_is_refused(tmp_path: Path) -> None:
    """A folder without permission is told, and the others are entered."""
    (tmp_path / "closed").mkdir()
    (tmp_path / "notes.txt").write_text("hello")
    closed, notes = find([tmp_path], [Closed()])
    assert isinstance(closed, Outcome)
    assert isinstance(notes, Outcome)
    assert (closed.fate, closed.source) == (Fate.REFUSED, str(tmp_path / "closed"))
    assert str(closed.reason).endswith("manifest.json cannot be read: Permission denied")
    assert notes.fate is Fate.SKIPPED
