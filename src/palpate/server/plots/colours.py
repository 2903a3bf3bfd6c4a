"""The colours of the page by their names, light and dark, as they stand in its style sheet."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

__all__ = ["page_colours"]

SHEET = Path(__file__).parents[1] / "static" / "style.css"
COLOUR = re.compile(r"--([\w-]+):\s*(#[0-9a-f]{3,6})\b")
DARK = "@media screen and (prefers-color-scheme: dark)"


@lru_cache(maxsize=2)
def page_colours(*, dark: bool) -> Mapping[str, str]:
    """The colours of the page: a canvas cannot ask a style sheet for them.

    Examples
    --------
    >>> page_colours(dark=False)["ground"], page_colours(dark=True)["ground"]
    ('#fbfaf7', '#14181a')
    """
    light, _, rest = SHEET.read_text(encoding="utf-8").partition(DARK)
    found = dict(COLOUR.findall(light.partition("}")[0]))
    return {**found, **dict(COLOUR.findall(rest.partition("}")[0]))} if dark else found
