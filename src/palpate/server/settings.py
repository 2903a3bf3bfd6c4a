"""How a server runs; each worker reads it from the environment, where the command line has put it."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass

from palpate.server.security.single_sign_on import Provider

__all__ = ["OIDC_SECRET", "Settings"]

VARIABLE = "PALPATE_SERVER"
OIDC_SECRET = "PALPATE_OIDC_SECRET"
"""The variable that holds the secret by which a provider knows this server; unset where it needs none."""


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
        From one address in the long run, and ten times as many from an account by its tokens; without a limit where it
        is None.
    secure
        Whether people reach it over TLS, so that their browsers are told to insist on it.
    proxied
        Whether a proxy passes requests on, so that none counts as one from this computer.
    signed_urls
        Whether who may see a file is sent to the bucket that has it, where the blobs are in one.
    log_requests
        Whether each request is a line of JSON on standard error.
    oidc_issuer, oidc_client_id
        The provider that logs people in beside passwords, and by which name it knows this server; its secret is in the
        environment, as `OIDC_SECRET` names it.
    oidc_new_readers
        Whether who the provider knows and has no account gets one, as a reader.
    contact
        Whom people ask who have no account or have forgotten their password, in words.
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
    proxied: bool = False
    signed_urls: bool = False
    log_requests: bool = False
    oidc_issuer: str | None = None
    oidc_client_id: str | None = None
    oidc_new_readers: bool = False
    contact: str | None = None

    def to_environment(self) -> None:
        """Leave them for the workers."""
        os.environ[VARIABLE] = json.dumps(asdict(self))

    def provider(self) -> Provider | None:
        """Who else logs people in; nobody unless told."""
        if self.oidc_issuer is None or self.oidc_client_id is None:
            return None
        return Provider(self.oidc_issuer, self.oidc_client_id, os.environ.get(OIDC_SECRET) or None)

    @classmethod
    def from_environment(cls) -> Settings:
        """Those that `to_environment` left."""
        plain = json.loads(os.environ[VARIABLE])
        return cls(**{**plain, "hosts": tuple(plain["hosts"])})
