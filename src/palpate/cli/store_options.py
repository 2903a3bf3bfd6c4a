"""Options that say which store a command is about."""

from __future__ import annotations

from typing import Annotated

import typer

__all__ = ["BlobsOption", "StoreOption"]

StoreOption = Annotated[
    str | None,
    typer.Option("--store", help="SQLite file or postgresql+psycopg://... (default: PALPATE_STORE, or your own)."),
]
BlobsOption = Annotated[
    str | None,
    typer.Option("--blobs", help="Folder or s3://... for large bytes (default: PALPATE_BLOBS, or beside the file)."),
]
