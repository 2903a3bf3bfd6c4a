"""Letters that nobody sees."""

from unicodedata import category

from hypothesis import given
from hypothesis import strategies as st

from palpate.invisible import hidden_letter, shown

TURNS = [chr(place) for place in (*range(0x202A, 0x202F), *range(0x2066, 0x206A), 0x200E, 0x200F)]
texts = st.text(st.characters(exclude_categories=["Cs"]) | st.sampled_from([*TURNS, "\u200c", "\u200d"]))


@given(texts)
def test_what_is_shown_is_all_seen(text: str) -> None:
    """Nothing is hidden in it but ends of lines and tabs, and what was seen stands as it was."""
    told = shown(text)
    assert hidden_letter(told.translate(dict.fromkeys(map(ord, "\n\r\t"), " "))) is None
    if hidden_letter(text) is None:
        assert told == text
    assert told.encode().decode("unicode_escape" if told.isascii() and "\\" not in text else "utf-8") in (text, told)


def test_all_that_turns_text_is_hidden() -> None:
    """Embeddings, overrides, isolates and marks, wherever they stand."""
    for letter in TURNS:
        told = hidden_letter(f"ab{letter}c")
        assert told is not None
        assert told.startswith(f"letter 3 is U+{ord(letter):04X} ")
        assert shown(f"{letter}é") == f"\\u{ord(letter):04x}é"
        assert category(letter) == "Cf"
