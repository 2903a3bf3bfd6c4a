"""Files of JSON lines: a header that names the format, then a record on each line."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

from palpate.errors import LogError

__all__ = ["EPISODE_FORMAT", "SESSION_FORMAT", "Line", "finite", "read_lines", "write_line"]

EPISODE_FORMAT = "palpate-episode/1"
SESSION_FORMAT = "palpate-session/1"


@dataclass(frozen=True, eq=False)
class Line:
    """A record and where it stands, for messages."""

    where: str
    record: Mapping[str, Any]

    def get(self, key: str, kind: type | tuple[type, ...]) -> Any:
        """Look up a value that must be there; LogError names the line, the key and what was found."""
        if key not in self.record:
            raise LogError(f"{self.where}: {key!r} is missing")
        value = self.record[key]
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            expected = " or ".join(k.__name__ for k in (kind if isinstance(kind, tuple) else (kind,)))
            raise LogError(f"{self.where}: {key!r} is {type(value).__name__}, expected {expected}")
        return value


def read_lines(path: str | Path, *formats: str) -> tuple[Line, ...]:
    """Read all lines, the header first.

    Raises
    ------
    LogError
        The file cannot be read, is empty, is of none of the formats, or a line is cut off or is
        no JSON object.
    """
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise LogError(f"{path} cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise LogError(f"{path} is not a text file in UTF-8: byte {error.start} cannot be decoded") from error
    if not text.strip():
        raise LogError(f"{path} is empty, expected a header line with the format {formats[0]!r}")
    rows = text.splitlines()
    lines = tuple(
        Line(f"{path} line {number}", _record(path, number, row, number == len(rows) and not text.endswith("\n")))
        for number, row in enumerate(rows, 1)
    )
    found = lines[0].record.get("format")
    if found not in formats:
        raise LogError(f"{lines[0].where}: the format is {found!r}, expected {' or '.join(map(repr, formats))}")
    return lines


def write_line(file: IO[str], record: Mapping[str, Any]) -> None:
    """Write a record as a line, with null in place of NaN and infinity."""
    file.write(json.dumps(finite(record), ensure_ascii=False, allow_nan=False) + "\n")


def _record(path: str | Path, number: int, row: str, unfinished: bool) -> Mapping[str, Any]:
    try:
        record = json.loads(row)
    except json.JSONDecodeError as error:
        if unfinished:
            raise LogError(f"{path} line {number}: the line is cut off; remove it to use the rest") from error
        raise LogError(f"{path} line {number}: column {error.colno} is no JSON: {error.msg}") from error
    if not isinstance(record, Mapping):
        raise LogError(f"{path} line {number}: {type(record).__name__} was found, expected a JSON object")
    return record


def finite(value: Any) -> Any:
    """Return the value with null in place of NaN and infinity, which JSON does not have."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: finite(item) for key, item in value.items()}
    return [finite(item) for item in value] if isinstance(value, list | tuple) else value
