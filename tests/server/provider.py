"""A small OpenID provider on this computer: it logs in whoever it is told to, with tokens that are really signed."""

import base64
import hashlib
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, parse_qsl, urlsplit

from joserfc import jwt
from joserfc.jwk import ECKey, KeySet, OctKey, RSAKey

FIRST = RSAKey.generate_key(2048, {"kid": "first"})
CLIENT, SECRET = "palpate-here", "a secret of two"


@dataclass
class FakeProvider:
    """What it says and signs; each part can be made wrong."""

    issuer: str = ""
    key: Any = field(default_factory=lambda: FIRST)
    signed_by: Any = None
    algorithm: str = "RS256"
    claims: dict[str, Any] = field(
        default_factory=lambda: {"sub": "s-1", "email": "Ann@lab.example", "email_verified": True}
    )
    changes: dict[str, Any] = field(default_factory=dict)
    about: dict[str, Any] = field(default_factory=dict)
    codes: dict[str, dict[str, str]] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)
    slow: threading.Event = field(default_factory=threading.Event)

    def __post_init__(self) -> None:
        self.slow.set()

    def metadata(self) -> dict[str, Any]:
        addresses = {name: f"{self.issuer}/{name}" for name in ("authorization_endpoint", "token_endpoint", "jwks_uri")}
        return {
            "issuer": self.issuer,
            **addresses,
            "id_token_signing_alg_values_supported": ["RS256", "ES256"],
            **self.about,
        }

    def log_in(self, address: str) -> str:
        """What somebody does whom a browser has brought there: the address that they are sent back to."""
        asked = dict(parse_qsl(urlsplit(address).query))
        assert (asked["client_id"], asked["response_type"], asked["code_challenge_method"]) == (CLIENT, "code", "S256")
        assert "openid" in asked["scope"].split()
        code = f"code {len(self.codes)}"
        self.codes[code] = asked
        return f"{asked['redirect_uri']}?code={code.replace(' ', '+')}&state={asked['state']}"

    def token(self, form: dict[str, str], authorization: str) -> dict[str, Any] | None:
        """The answer to a code, once."""
        asked = self.codes.pop(form["code"], None)
        if asked is None or form["redirect_uri"] != asked["redirect_uri"]:
            return None
        digest = hashlib.sha256(form["code_verifier"].encode()).digest()
        assert base64.urlsafe_b64encode(digest).decode().rstrip("=") == asked["code_challenge"]
        sent = base64.b64decode(authorization.removeprefix("Basic ")).decode() if authorization else ""
        assert sent in (f"{CLIENT}:{SECRET}", "palpate-here:a%20secret%20of%20two")
        now = int(time.time())
        times = {"iat": now, "exp": now + 300}
        claims = {"iss": self.issuer, "aud": CLIENT, "nonce": asked["nonce"], **times, **self.claims, **self.changes}
        claims = {name: value for name, value in claims.items() if value is not None}
        key = self.signed_by or self.key
        header = {"alg": self.algorithm, "kid": key.kid or "first"}
        return {
            "access_token": "of no use",
            "token_type": "Bearer",
            "id_token": jwt.encode(header, claims, key, algorithms=[self.algorithm]),
        }

    def answer(self, path: str) -> Any:
        """What is read without a log-in."""
        self.asked.append(path)
        # cleared, it answers once it is set again
        self.slow.wait()
        if path == "/.well-known/openid-configuration":
            return self.metadata()
        return KeySet([self.key]).as_dict(private=False) if path == "/jwks_uri" else None


@contextmanager
def provided() -> Iterator[FakeProvider]:
    """A provider that answers until the end of the block."""
    provider = FakeProvider()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self._send(provider.answer(self.path))

        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"])).decode()
            form = {name: values[0] for name, values in parse_qs(body).items()}
            found = provider.token(form, self.headers.get("Authorization", ""))
            self._send(found or {"error": "invalid_grant"}, 200 if found else 400)

        def _send(self, plain: Any, status: int = 200) -> None:
            data = json.dumps(plain).encode()
            self.send_response(404 if plain is None else status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, format: str, *args: Any) -> None:
            """Nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    provider.issuer = f"http://127.0.0.1:{server.server_port}"
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield provider
    finally:
        server.shutdown()
        server.server_close()


__all__ = ["CLIENT", "SECRET", "ECKey", "FakeProvider", "OctKey", "RSAKey", "provided"]
