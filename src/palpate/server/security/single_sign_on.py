"""Logging in by an OpenID provider: its address, what is asked of it, and who somebody is by its signed answer.

The authorisation code flow with PKCE; what it takes to recognise the answer stays in the browser that asked.
"""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any
from urllib.parse import urlsplit

from palpate.errors import PalpateError
from palpate.server.security.asking import Asking, AwayError, SignOnError

__all__ = ["Attempt", "Identity", "Provider", "check_issuer"]

# signed with a key that only the provider has; "none" and secrets that are shared are not
ALGORITHMS = ("RS256", "PS256", "ES256", "RS384", "RS512", "PS384", "PS512", "ES384", "ES512", "Ed25519", "EdDSA")
SCOPE = "openid email profile"
CLOCKS_DIFFER_S = 60
WAIT_S = 10.0
LOOPBACK = ("127.0.0.1", "::1", "localhost")


@dataclass(frozen=True)
class Identity:
    """Who somebody is to a provider; the address only where the provider has verified that it is theirs."""

    issuer: str
    subject: str
    verified_email: str | None


@dataclass(frozen=True)
class Attempt:
    """What a browser keeps while somebody logs in elsewhere: by it the answer is known to be to its own question."""

    state: str
    nonce: str
    verifier: str

    @classmethod
    def new(cls) -> Attempt:
        """Random ones that nobody can guess."""
        return cls(*(secrets.token_urlsafe(32) for _ in range(3)))


def check_issuer(address: str) -> None:
    """Refuse a provider that anybody on the way could stand in for.

    Raises
    ------
    PalpateError
        If the address is none, or has no TLS and is not on this computer.
    """
    try:
        parts = urlsplit(address)
        host = parts.hostname
    except ValueError:
        parts, host = urlsplit(""), None
    if (
        not host
        or parts.query
        or parts.fragment
        or not (parts.scheme == "https" or (parts.scheme == "http" and host in LOOPBACK))
    ):
        raise PalpateError(f"--oidc-issuer {address!r}: expected an address that begins with https://")


class Provider:
    """An OpenID provider; what it says of itself is asked once, and its keys again where one is not known.

    Threads that ask it wait for it and for nobody else, and they are few (see `palpate.server.security.asking`).

    Parameters
    ----------
    issuer
        Its address, as it stands in what it signs.
    client_id, client_secret
        By which it knows this server; None where it needs no secret, as PKCE is used in any case.
    """

    def __init__(self, issuer: str, client_id: str, client_secret: str | None) -> None:
        check_issuer(issuer)
        self.issuer = issuer
        self._client_id = client_id
        self._client_secret = client_secret
        self._asking = Asking()
        self._metadata: Mapping[str, Any] | None = None
        self._keys: Mapping[str, Any] | None = None

    def address(self, attempt: Attempt, back: str) -> str:
        """Where a browser is sent to log in, and from there back to an address of this server.

        Raises
        ------
        SignOnError
            If the provider does not answer as one; it is an `AwayError` where it does not answer.
        """
        with self._client(back) as client:
            endpoint = self._told("authorization_endpoint")
            url, _ = client.create_authorization_url(
                endpoint, state=attempt.state, code_verifier=attempt.verifier, nonce=attempt.nonce
            )
        return str(url)

    def identity(self, attempt: Attempt, back: str, code: str) -> Identity:
        """Who has logged in, by the code that the provider has sent them back with.

        Raises
        ------
        SignOnError
            If it is no answer to this attempt; it is an `AwayError` where the provider does not answer.
        """
        from authlib.integrations.base_client import OAuthError
        from httpx2 import HTTPError, TransportError

        endpoint = self._told("token_endpoint")

        def fetched() -> Any:
            try:
                with self._client(back) as client:
                    return client.fetch_token(endpoint, code=code, code_verifier=attempt.verifier)
            except TransportError as error:
                raise _silent(error) from None

        try:
            token = self._asking.ask(fetched)
        except OAuthError as error:
            raise SignOnError(f"the provider refuses the log-in ({_word(error.error)})") from None
        except (HTTPError, ValueError) as error:
            # it may be the code that it cannot answer, which anybody may make up: others go on
            raise SignOnError(f"the provider does not answer as one ({type(error).__name__})") from None
        signed = token.get("id_token")
        if not isinstance(signed, str):
            raise SignOnError("the provider has sent no signed answer")
        claims = self._claims(signed, attempt.nonce)
        email = claims.get("email")
        verified = isinstance(email, str) and bool(email) and claims.get("email_verified") is True
        return Identity(self.issuer, str(claims["sub"]), email if verified else None)

    def _claims(self, signed: str, nonce: str) -> Any:
        """What a provider has signed, once it is found to be its own, for this server, this attempt and now."""
        from authlib.oidc.core import IDToken
        from joserfc.errors import InvalidKeyIdError, JoseError

        try:
            try:
                token = self._decoded(signed, again=False)
            except InvalidKeyIdError:
                token = self._decoded(signed, again=True)
            expected = {
                "iss": {"essential": True, "value": self.issuer},
                "aud": {"essential": True, "value": self._client_id},
                "sub": {"essential": True},
                "nonce": {"essential": True, "value": nonce},
            }
            params = {"nonce": nonce, "client_id": self._client_id}
            claims = IDToken(token.claims, token.header, expected, params)
            claims.validate(leeway=CLOCKS_DIFFER_S)
        except (JoseError, ValueError, TypeError, KeyError) as error:
            raise SignOnError(f"the answer of the provider does not hold ({_word(str(error))})") from None
        return claims

    def _decoded(self, signed: str, *, again: bool) -> Any:
        from joserfc import jwt
        from joserfc.jwk import KeySet
        from joserfc.jws import JWSRegistry

        offered = self._about().get("id_token_signing_alg_values_supported") or ["RS256"]
        allowed = [name for name in ALGORITHMS if name in offered]
        if not allowed:
            # none named would mean those that the library allows, shared secrets among them
            raise SignOnError("the provider offers no signature with a key of its own alone")
        registry = JWSRegistry(algorithms=allowed, strict_check_header=False)
        return jwt.decode(signed, KeySet.import_key_set(self._key_set(again=again)), registry=registry)

    def _about(self) -> Mapping[str, Any]:
        if self._metadata is None:
            self._metadata = self._asking.ask(self._introduced)
        return self._metadata

    def _introduced(self) -> Mapping[str, Any]:
        found = self._fetched(f"{self.issuer.rstrip('/')}/.well-known/openid-configuration")
        if found.get("issuer") != self.issuer:
            raise AwayError(f"the provider says that it is another one than {self.issuer}")
        return found

    def _told(self, name: str) -> str:
        """An address that the provider tells."""
        found = self._about().get(name)
        if not isinstance(found, str):
            raise SignOnError(f"the provider does not tell its {name}")
        try:
            check_issuer(found.partition("?")[0])
        except PalpateError:
            raise SignOnError(f"the provider tells as its {name} an address without TLS") from None
        return found

    def _key_set(self, *, again: bool) -> Any:
        address = self._told("jwks_uri")
        if self._keys is None or again:
            self._keys = self._asking.ask(lambda: self._fetched(address))
        return self._keys

    def _fetched(self, address: str) -> Mapping[str, Any]:
        import httpx2

        try:
            found = httpx2.get(address, timeout=WAIT_S, follow_redirects=False)
            found.raise_for_status()
            plain = found.json()
        except (httpx2.HTTPError, ValueError) as error:
            raise _silent(error) from None
        if not isinstance(plain, dict):
            raise AwayError("the provider does not answer as one")
        return plain

    def _client(self, back: str) -> Any:
        from authlib.integrations.httpx_client import OAuth2Client

        made = partial(OAuth2Client, self._client_id, scope=SCOPE, redirect_uri=back, timeout=WAIT_S)
        if self._client_secret is None:
            return made(token_endpoint_auth_method="none", code_challenge_method="S256")
        return made(
            client_secret=self._client_secret, token_endpoint_auth_method=self._method(), code_challenge_method="S256"
        )

    def _method(self) -> str:
        """How the secret is sent; in the header unless the provider takes it in the body alone."""
        offered = self._about().get("token_endpoint_auth_methods_supported") or ["client_secret_basic"]
        return "client_secret_basic" if "client_secret_basic" in offered else "client_secret_post"


def _silent(error: Exception) -> AwayError:
    return AwayError(f"the provider does not answer ({type(error).__name__}); try again")


def _word(text: str | None) -> str:
    """A few characters that somebody else has chosen, as they can be shown."""
    return "".join(letter for letter in str(text) if letter.isalnum() or letter in " _-'\".:")[:80]
