"""Letters that nobody sees."""

from unicodedata import category

from hypothesis import given
from hypothesis import strategies as st

from palpate.invisible import hidden_letter, shown

TURNS = [chr(place) for place in (*range(0x202A, 0x202F), *range(0x2066, 0x206A), 0x200E, 0x200F)]
texts = st.text(
    st.characters(exclude_categories=["Cs"])
    | st.sampled_from([*TURNS, "\u200c", "\u200d", "\U0001f3f4", "\U000e0067", "\u06dd"])
)


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


def test_words_and_flags_of_people_are_seen() -> None:
    """Words that end in a joiner, the flag of England, and signs below numbers; not tags that stand alone."""
    flag = "\U0001f3f4\U000e0067\U000e0062\U000e0065\U000e006e\U000e0067\U000e007f"
    for name in ("\u0645\u06cc\u200c", "\u0d35\u0d3e\u0d15\u0d4d\u200d", flag, "\u06dd\u0661", "caf\u00e9", "\u7bb1"):
        assert hidden_letter(name) is None, name
    for name in ("cup\u200d", "\u200d", "cup\U000e0067", flag + "x\U000e0067", "\U0001f3f4" + "\U000e0067" * 20):
        assert hidden_letter(name) is not None, name
