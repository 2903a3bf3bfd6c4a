"""What of some bytes a request wants: all, a part by the header ``Range``, or nothing where it has them already."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.server.problems import problem

__all__ = ["is_known", "wanted_range"]

LONGEST_NUMBER = 18


def is_known(headers: Mapping[str, str], etag: str) -> bool:
    """Whether who asks has these bytes: ``If-None-Match`` names them.

    Examples
    --------
    >>> is_known({"if-none-match": 'W/"a", "b"'}, '"a"'), is_known({"if-none-match": '"b"'}, '"a"'), is_known({}, '"a"')
    (True, False, False)
    """
    named = headers.get("if-none-match", "")
    return named.strip() == "*" or etag in (one.strip().removeprefix("W/") for one in named.split(","))


def wanted_range(headers: Mapping[str, str], etag: str, size: int) -> tuple[int, int] | None:
    """Where the range begins and ends; None where all is wanted.

    All is the answer to several ranges at once, to what is no range, and to one that is wanted only of other bytes
    (``If-Range``, where a date never fits: bytes under a digest have none).

    Raises
    ------
    ProblemError
        If the range is outside.

    Examples
    --------
    >>> wanted_range({"range": "bytes=2-4"}, '"a"', 10), wanted_range({"range": "bytes=-3"}, '"a"', 10)
    ((2, 5), (7, 10))
    >>> wanted_range({"range": "bytes=2-4", "if-range": '"b"'}, '"a"', 10)
    """
    if headers.get("if-range", etag).strip() != etag:
        return None
    return _range(headers.get("range"), size)


def _range(header: str | None, size: int) -> tuple[int, int] | None:
    if header is None or not header.startswith("bytes=") or "," in header:
        return None
    first, dash, last = header.removeprefix("bytes=").strip().partition("-")
    if not dash or not all(part.isascii() and (part.isdigit() or not part) for part in (first, last)):
        return None
    if len(first) > LONGEST_NUMBER or len(last) > LONGEST_NUMBER or not first + last:
        return None
    start = int(first) if first else max(0, size - int(last))
    end = min(size, int(last) + 1) if first and last else size
    if start >= end:
        raise problem(
            416, f"range: {header!r} is outside of {size} bytes", headers={"Content-Range": f"bytes */{size}"}
        )
    return start, end
