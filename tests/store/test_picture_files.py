import io
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from palpate.store import picture_files
from palpate.store.errors import StoreError
from palpate.store.picture_files import picture_type

FORMATS = {"PNG": "image/png", "JPEG": "image/jpeg", "GIF": "image/gif", "TIFF": "image/tiff", "WEBP": "image/webp"}


def made(form: str) -> bytes:
    file = io.BytesIO()
    Image.effect_noise((20, 10), 50).convert("RGB").save(file, form)
    return file.getvalue()


@pytest.mark.parametrize("pillow", [True, False])
@pytest.mark.parametrize("form", FORMATS)
def test_a_picture_is_told_by_what_is_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str, pillow: bool
) -> None:
    """Each format has its media type, whatever the name of the file, with Pillow and without."""
    if not pillow:
        monkeypatch.setattr(picture_files, "find_spec", lambda name: None)
    path = tmp_path / "picture.txt"
    path.write_bytes(made(form))
    assert picture_type(path, "--image") == FORMATS[form]


@pytest.mark.parametrize("content", [b"", b"root:x:0:0", b"RIFF\0\0\0\0WAVEfmt ", b"%PDF-1.7"])
def test_what_is_no_picture_is_refused(tmp_path: Path, content: bytes) -> None:
    """Text, sound and nothing at all are no pictures, whatever the name of the file."""
    path = tmp_path / "picture.png"
    path.write_bytes(content)
    with pytest.raises(StoreError, match=r"^--image: '.*picture.png' is no picture, expected PNG, JPEG"):
        picture_type(path, "--image")


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(form=st.sampled_from(sorted(FORMATS)), kept=st.floats(0, 0.9))
def test_a_cut_picture_is_refused(tmp_path: Path, form: str, kept: float) -> None:
    """Where Pillow can look, a picture of which the end is missing is no picture."""
    whole = made(form)
    path = tmp_path / "picture"
    path.write_bytes(whole[: int(kept * len(whole))])
    with pytest.raises(StoreError, match=r"is no picture|is a damaged picture"):
        picture_type(path, "--image")
