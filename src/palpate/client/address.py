"""The address of a service: where that of a server leads to, and what is none."""

from __future__ import annotations

from urllib.parse import SplitResult, urlsplit

from palpate.client.errors import ReceiverError

__all__ = ["SERVICE", "service_at"]

SERVICE = "/api/v1"


def service_at(url: str) -> str:
    """The address of the service of a server, which people know by its first page.

    Raises
    ------
    ReceiverError
        If it is none, with the one that is probably meant.

    Examples
    --------
    >>> service_at("https://touch.example.org/"), service_at("https://touch.example.org/api/v1/")
    ('https://touch.example.org/api/v1', 'https://touch.example.org/api/v1')
    """
    parts, port = _parts(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        known = "" if "://" in url else url.strip("/").partition("/")[0]
        meant = f"https://{known} or http://{known}" if known else "https://... or http://..."
        raise ReceiverError(f"{url!r} is no address of a server, expected {meant}")
    host = f"[{parts.hostname}]" if ":" in parts.hostname else parts.hostname
    root = f"{parts.scheme}://{host}{port}"
    if parts.username is not None:
        raise ReceiverError(
            f"the address of {root} holds a name or a password, expected {root}{SERVICE}, and a token in PALPATE_TOKEN"
        )
    path = parts.path.strip("/")
    if (path and not f"/{path}".endswith(SERVICE)) or parts.query or parts.fragment:
        before, inside, _ = f"/{path}/".partition(f"{SERVICE}/")
        meant = f"{root}{before if inside else ''}{SERVICE}"
        raise ReceiverError(f"{url!r} is no address of a service, which ends in {SERVICE}: expected {meant}")
    return f"{root}/{path}" if path else f"{root}{SERVICE}"


def _parts(url: str) -> tuple[SplitResult, str]:
    """The parts of an address, and its port as it is written; those of none where it cannot be read."""
    try:
        parts = urlsplit(url)
        return parts, "" if parts.port is None else f":{parts.port}"
    except ValueError:
        return urlsplit(""), ""
