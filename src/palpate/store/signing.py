"""Addresses at which an object in S3 can be had for a while by who has no keys (AWS Signature, version 4).

obstore signs an address, but leaves no say in the headers of the answer, which have to be signed with it: that what
somebody has uploaded is a download of no type, and not a page of whoever runs the bucket.
"""

from __future__ import annotations

import hmac
from collections.abc import Mapping
from hashlib import sha256
from urllib.parse import parse_qsl, quote, urlsplit

__all__ = ["SIGNATURE", "signed_again"]

SIGNATURE = "X-Amz-Signature"
ALGORITHM = "AWS4-HMAC-SHA256"


def signed_again(url: str, more: Mapping[str, str], secret: str) -> str:
    """An address that was signed for GET, with more parameters, and signed anew for all of them.

    Parameters
    ----------
    url
        An address with the parameters of a signature, of which only the host is signed as a header.
    more
        Parameters such as ``response-content-type``.
    secret
        The secret key that belongs to the key in the address.
    """
    parts = urlsplit(url)
    asked = {name: value for name, value in parse_qsl(parts.query, keep_blank_values=True) if name != SIGNATURE}
    query = "&".join(f"{_escaped(name)}={_escaped(value)}" for name, value in sorted({**asked, **more}.items()))
    request = "\n".join(("GET", parts.path, query, f"host:{parts.netloc}\n", "host", "UNSIGNED-PAYLOAD"))
    _, scope = asked["X-Amz-Credential"].split("/", 1)
    text = "\n".join((ALGORITHM, asked["X-Amz-Date"], scope, sha256(request.encode()).hexdigest()))
    key = f"AWS4{secret}".encode()
    # by day, region, service, and what the key is for
    for part in scope.split("/"):
        key = _keyed(key, part)
    return f"{parts.scheme}://{parts.netloc}{parts.path}?{query}&{SIGNATURE}={_keyed(key, text).hex()}"


def _keyed(key: bytes, text: str) -> bytes:
    return hmac.digest(key, text.encode(), sha256)


def _escaped(text: str) -> str:
    return quote(text, safe="-_.~")
