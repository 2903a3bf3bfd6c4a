"""How a server runs; each worker reads it from the environment, where the command line has put it."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass

__all__ = ["Settings"]

VARIABLE = "PALPATE_SERVER"


@dataclass(frozen=True)
class Settings:
    """How a server runs.

    Attributes
    ----------
    place, blobs
        The store, as for `palpate.store.opening.open_store`.
    hosts
        Names under which it may be asked; any where it is empty. On a computer of one's own it is that computer's:
        a page elsewhere cannot ask by a name that it points here.
    key
        Whoever has it sees all, as the person who started the server; nobody where it is None.
    previews
        The folder in which uploads wait until they are kept, for all workers; each application has one of its own where
        it is None.
    largest_upload_bytes, largest_unpacked_bytes
        Of a recording, as sent and unpacked.
    largest_body_bytes
        Of any other request.
    requests_per_s
        From one address in the long run; without a limit where it is None.
    secure
        Whether people reach it over TLS, so that their browsers are told to insist on it.
    signed_urls
        Whether who may see a file is sent to the bucket that has it, where the blobs are in one.
    log_requests
        Whether each request is a line of JSON on standard error.
    """

    place: str | None = None
    blobs: str | None = None
    hosts: tuple[str, ...] = ()
    key: str | None = None
    previews: str | None = None
    largest_upload_bytes: int = 256 << 20
    largest_unpacked_bytes: int = 1 << 30
    largest_body_bytes: int = 1 << 20
    requests_per_s: float | None = 50.0
    secure: bool = False
    signed_urls: bool = False
    log_requests: bool = False

    def to_environment(self) -> None:
        """Leave them for the workers."""
        os.environ[VARIABLE] = json.dumps(asdict(self))

    @classmethod
    def from_environment(cls) -> Settings:
        """Those that `to_environment` left."""
        plain = json.loads(os.environ[VARIABLE])
        return cls(**{**plain, "hosts": tuple(plain["hosts"])})
