"""The old program's forms: a field that holds JSON, and files under names that say where they belong."""

from __future__ import annotations

import shutil
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fastapi import Request
from fastapi.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile
from starlette.formparsers import FormParser, MultiPartException, MultiPartParser

from palpate.server.problems import problem
from palpate.store.importing.json_text import parse_json
from palpate.store.importing.paths import portable_name

__all__ = ["Form", "Part", "form_in"]

MOST_FILES = 200
MOST_FIELDS = 20
LARGEST_FIELDS_BYTES = 8 << 20
"""Of all fields that are no files, as they are read whole into memory, and many times as large there."""
LONGEST_NAME = 100


@dataclass(frozen=True)
class Part:
    """A file of a form: the name that the sender's computer has for it, and where it is here."""

    name: str
    path: Path


@dataclass(frozen=True)
class Form:
    """What a form holds: JSON, files by the names of their fields, and the folder in which these are."""

    content: Any
    parts: Mapping[str, Part]
    folder: Path
    notices: list[str] = field(default_factory=list)


@asynccontextmanager
async def form_in(request: Request, name: str) -> AsyncIterator[Form]:
    """The form of a request, whose field `name` holds JSON; with files it is multipart, and without URL-encoded."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    limits = {"max_fields": MOST_FIELDS, "max_part_size": LARGEST_FIELDS_BYTES}
    try:
        if kind == "multipart/form-data":
            found = await _Multipart(request.headers, request.stream(), max_files=MOST_FILES, **limits).parse()
        elif kind == "application/x-www-form-urlencoded":
            found = await _UrlEncoded(request.headers, request.stream(), **limits).parse()
        else:
            raise problem(415, f"content-type: found {kind[:60]!r}, expected multipart/form-data")
    except MultiPartException as error:
        raise problem(400, f"the form cannot be read: {error.message}") from None
    except (KeyError, ValueError):
        raise problem(400, "the form cannot be read") from None
    try:
        with TemporaryDirectory(prefix="palpate-rest-") as folder:
            yield await run_in_threadpool(_form, name, found.multi_items(), Path(folder))
    finally:
        await found.close()


class _Multipart(MultiPartParser):
    """Refuses fields that are too large together; files are on the disk."""

    _texts_bytes = 0

    def on_part_data(self, data: bytes, start: int, end: int) -> None:
        if self._current_part.file is None:
            self._texts_bytes = _not_too_large(self._texts_bytes + end - start)
        super().on_part_data(data, start, end)


class _UrlEncoded(FormParser):
    """Likewise, of a form that has no files."""

    _texts_bytes = 0

    def on_field_data(self, data: bytes, start: int, end: int) -> None:
        self._texts_bytes = _not_too_large(self._texts_bytes + end - start)
        super().on_field_data(data, start, end)


def _not_too_large(size: int) -> int:
    if size > LARGEST_FIELDS_BYTES:
        told = f"the fields of the form are too large, expected {LARGEST_FIELDS_BYTES} bytes at most beside its files"
        raise problem(413, told, headers={"Connection": "close"})
    return size


def _form(name: str, items: list[tuple[str, UploadFile | str]], folder: Path) -> Form:
    texts = {key: value for key, value in items if isinstance(value, str)}
    if name not in texts:
        raise problem(400, f"{name}: is missing, expected a field of the form with JSON in it")
    try:
        content = parse_json(texts.pop(name))
    except (ValueError, RecursionError):
        raise problem(400, f"{name}: is no JSON that can be read") from None
    notices = [f"the field {key[:LONGEST_NAME]!r} of the form is not known: it is left out" for key in sorted(texts)]
    parts = dict[str, Part]()
    for place, (key, value) in enumerate(items):
        if isinstance(value, UploadFile):
            if key in parts:
                raise problem(400, f"{key[:LONGEST_NAME]}: is there twice, expected each file once")
            given = portable_name((value.filename or "").replace("\\", "/").rsplit("/", 1)[-1])[-LONGEST_NAME:]
            # a name that somebody sends is no name of ours
            path = folder / f"{place}{Path(given).suffix if given.isascii() else ''}"
            with path.open("xb") as opened:
                shutil.copyfileobj(value.file, opened)
            parts[key] = Part(given, path)
    return Form(content, parts, folder, notices)
