"""Letters that nobody sees, and that make a name look like another one: found in what is new, else shown."""

from __future__ import annotations

from unicodedata import category, name

__all__ = ["hidden_letter", "shown"]

HIDDEN = ("Cc", "Cf", "Zl", "Zp")
"""Categories of Unicode: controls, what turns or joins the text around it, and ends of lines and paragraphs."""
JOINERS = "\N{ZERO WIDTH NON-JOINER}\N{ZERO WIDTH JOINER}"
"""After letters of scripts that need them, and within emoji, they change what is seen."""
TAGS, FLAG = {chr(number) for number in range(0xE0020, 0xE0080)}, "\N{WAVING BLACK FLAG}"
"""After it they tell of which country it is."""
LONGEST_FLAG = 8
SIGNS = {*map(chr, range(0x600, 0x606)), "\u06dd", "\u070f", "\u08e2"}
"""Those that stand below numbers, and are seen."""
LINES = "\n\r\t"


def hidden_letter(text: str) -> str | None:
    r"""What is hidden in a text: the place, number and name of the first such letter; None where there is none.

    Examples
    --------
    >>> hidden_letter("cup\u202e"), hidden_letter("caf\u00e9 \U0001f469\u200d\U0001f52c")
    ('letter 4 is U+202E RIGHT-TO-LEFT OVERRIDE', None)
    """
    # the quick look is for nearly all texts
    if text.isprintable():
        return None
    place = next((place for place in range(len(text)) if _is_hidden(text, place)), None)
    if place is None:
        return None
    return f"letter {place + 1} is U+{ord(text[place]):04X} {name(text[place], 'a control')}"


def shown(text: str) -> str:
    r"""A text with what is hidden in it as escapes; its lines stay.

    Examples
    --------
    >>> print(shown("cup\u202e\u2069 \x1b[2J"))
    cup\u202e\u2069 \x1b[2J
    """
    if text.isprintable():
        return text
    return "".join(
        letter if letter in LINES or not _is_hidden(text, place) else repr(letter)[1:-1]
        for place, letter in enumerate(text)
    )


def _is_hidden(text: str, place: int) -> bool:
    letter = text[place]
    if letter in JOINERS:
        before = text[place - 1 : place]
        # words of some languages end in one
        return before <= "\x7f" or before in JOINERS
    if letter in TAGS:
        return not _is_of_flag(text, place)
    return category(letter) in HIDDEN and letter not in SIGNS


def _is_of_flag(text: str, place: int) -> bool:
    start = place
    while start > max(0, place - LONGEST_FLAG) and text[start - 1] in TAGS:
        start -= 1
    return text[start - 1 : start] == FLAG
