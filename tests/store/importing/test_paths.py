from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.importing.paths import check_name, inside

OUTSIDE = [
    "../../etc/passwd",
    "a/../../b",
    "/etc/passwd",
    "\\\\server\\share\\x",
    "C:\\Users\\x.png",
    "C:x.png",
    "\\x.png",
    "..\\x",
    "..",
    "",
    ".",
    "a\0b",
    "con?.png",
]


@pytest.mark.parametrize("name", OUTSIDE)
def test_names_that_lead_out_are_refused(name: str) -> None:
    """Parents, absolute paths, drives, shares, and names that are none, are refused."""
    with pytest.raises(StoreError):
        check_name(name, "file")


@given(st.text(st.sampled_from("./\\:aC~ "), max_size=8))
def test_what_is_accepted_is_inside(name: str) -> None:
    """Whatever name is accepted stands for a path inside the folder."""
    folder = Path("/somewhere/deep")
    try:
        checked = check_name(name, "file")
    except StoreError:
        return
    assert (folder / checked).resolve().is_relative_to(folder)
    assert ".." not in checked.split("/")


def test_links_that_lead_out_are_refused(tmp_path: Path) -> None:
    """A symbolic link to a file or a folder outside is refused, one inside is not."""
    folder = tmp_path / "folder"
    (folder / "inner").mkdir(parents=True)
    (tmp_path / "secret").write_text("secret")
    (folder / "link").symlink_to(tmp_path / "secret")
    (folder / "up").symlink_to(tmp_path)
    (folder / "same").symlink_to(folder / "inner")
    for name in ("link", "up/secret"):
        with pytest.raises(StoreError, match="link"):
            inside(folder, name, "file")
    assert inside(folder, "same/x", "file") == folder / "same" / "x"
