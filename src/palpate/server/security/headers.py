"""Headers that keep a browser from doing more than a page needs."""

from __future__ import annotations

from starlette.datastructures import MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

__all__ = ["SecurityHeaders", "policy"]


def policy(style_nonce: str | None = None) -> str:
    """What a page may load and run.

    A page that names a nonce lets its own script make style elements with it, as BokehJS does, and icons that stand in
    those as data; nobody else's.
    """
    styles, images = ("'self'", "'self'") if style_nonce is None else (f"'self' 'nonce-{style_nonce}'", "'self' data:")
    return "; ".join(
        (
            "default-src 'none'",
            "script-src 'self'",
            f"style-src {styles}",
            f"img-src {images}",
            "media-src 'self'",
            "connect-src 'self'",
            "form-action 'self'",
            "base-uri 'none'",
            "frame-ancestors 'none'",
        )
    )


HEADERS = {
    "Content-Security-Policy": policy(),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "camera=(), geolocation=(), microphone=()",
    # what one person may see must not be shown to another one
    "Cache-Control": "private, no-cache",
    "Vary": "Authorization, Cookie",
}
INSIST_ON_TLS = "max-age=31536000"


class SecurityHeaders:
    """Sets the headers that an answer has not set itself; `secure`: insist on TLS from now on."""

    def __init__(self, app: ASGIApp, *, secure: bool = False) -> None:
        self.app = app
        self.headers = {**HEADERS, **({"Strict-Transport-Security": INSIST_ON_TLS} if secure else {})}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                found = MutableHeaders(scope=message)
                for name, value in self.headers.items():
                    found.setdefault(name, value)
            await send(message)

        await self.app(scope, receive, send_with_headers)
