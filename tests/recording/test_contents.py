from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.recording.contents import content_of, json_of
from palpate.recording.errors import RecordingError


@pytest.mark.parametrize(
    "picture", [np.zeros(3), np.zeros((2, 2)), np.zeros((2, 2, 5), np.uint8), np.zeros((0, 2), np.uint8)]
)
def test_what_is_no_picture_is_refused(picture: np.ndarray) -> None:
    """Another shape or type than a picture's is refused."""
    with pytest.raises(RecordingError, match="expected"):
        content_of("a.png", picture)


def test_text_bytes_paths_and_figures_are_taken(tmp_path: Path) -> None:
    """Each kind of content becomes bytes, or stays a path to copy."""
    from matplotlib.figure import Figure

    (tmp_path / "x").write_bytes(b"x")
    assert content_of("a.txt", "é") == "é".encode()
    assert content_of("a.bin", b"b") == b"b"
    assert content_of("a", tmp_path / "x") == tmp_path / "x"
    drawn = content_of("figs/a.svg", Figure())
    assert isinstance(drawn, bytes)
    assert b"<svg" in drawn


def test_other_contents_are_refused(tmp_path: Path) -> None:
    """A file that is not there, an array that is no picture by its name, and anything else, are refused."""
    contents: list[Any] = [tmp_path / "nowhere", np.zeros((2, 2), np.uint8), 3]
    for content in contents:
        with pytest.raises(RecordingError, match=r"file 'a\.txt'"):
            content_of("a.txt", content)
    with pytest.raises(RecordingError, match="JSON"):
        json_of("variable 'x'", float("nan"))
    assert json_of("variable 'x'", np.arange(2)) == b"[0, 1]"
