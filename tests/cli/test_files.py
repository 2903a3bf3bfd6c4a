from pathlib import Path

import pytest

from palpate.cli.files import check_writable, replacing
from palpate.errors import PalpateError


def test_a_file_is_replaced_as_a_whole(tmp_path: Path) -> None:
    """The new content takes the place of the old one once all was written, and no draft is left."""
    path = tmp_path / "a.txt"
    path.write_text("old")
    with replacing(path) as draft:
        draft.write_text("new")
        assert path.read_text() == "old"
        assert draft.suffix == ".txt"
    assert path.read_text() == "new"
    assert list(tmp_path.iterdir()) == [path]


def test_a_failure_leaves_the_old_file(tmp_path: Path) -> None:
    """When writing fails the old file stays, and no draft is left."""
    path = tmp_path / "a.txt"
    path.write_text("old")

    def fail(draft: Path) -> None:
        draft.write_text("half")
        raise RuntimeError("stop")

    with pytest.raises(RuntimeError, match="stop"), replacing(path) as draft:
        fail(draft)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_new_file_has_the_usual_permissions(tmp_path: Path) -> None:
    """A file written by way of a draft may be read by whoever may read one written directly."""
    direct, drafted = tmp_path / "direct.txt", tmp_path / "drafted.txt"
    direct.write_text("")
    with replacing(drafted) as draft:
        draft.write_text("")
    assert drafted.stat().st_mode == direct.stat().st_mode


@pytest.mark.parametrize(("path", "said"), [("none/a.txt", "does not exist"), (".", "is a folder")])
def test_places_where_no_file_can_be(tmp_path: Path, path: str, said: str) -> None:
    """A path in a folder that is not there, or that is a folder, is refused with the option."""
    with pytest.raises(PalpateError, match=f"--log: .*{said}"):
        check_writable("--log", tmp_path / path)


def test_a_path_that_can_be_written(tmp_path: Path) -> None:
    """Checking makes no file."""
    check_writable("--log", tmp_path / "a.txt")
    assert list(tmp_path.iterdir()) == []
