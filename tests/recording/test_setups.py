from pathlib import Path

import pytest

from palpate.recording.errors import RecordingError
from palpate.recording.setups import read_setup


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("arm", "no readable TOML"),
        ("[griper]\nname = 'x'", r"did you mean 'gripper'"),
        ("[arm]\nmaker = 'x'", "arm: has no name"),
        ("arm = 'x'", "arm: has no name"),
        ("[arm]\nname = 'x'\nmakre = 'y'", r"arm\.makre \(did you mean 'maker'\?\)"),
        ("[other]\nname = 'x'", r"expected \[\[other\]\]"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, told: str) -> None:
    """A mistake in a setup file is one sentence with the file and the key."""
    file = tmp_path / "setup.toml"
    file.write_text(text)
    with pytest.raises(RecordingError, match=told) as refused:
        read_setup(file)
    assert str(file) in str(refused.value)
