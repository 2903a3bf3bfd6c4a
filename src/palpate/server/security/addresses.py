"""Where a request comes from."""

from __future__ import annotations

from ipaddress import IPv6Address, IPv6Network, ip_address

from starlette.requests import HTTPConnection

__all__ = ["address_of", "is_here", "network_of"]


def network_of(connection: HTTPConnection) -> str:
    """Where a request comes from, of IPv6 the network: who has one address of it has all."""
    address = address_of(connection)
    try:
        found = ip_address(address)
    except ValueError:
        return address
    return str(IPv6Network((found, 64), strict=False)) if isinstance(found, IPv6Address) else address


def address_of(connection: HTTPConnection) -> str:
    """Where a request comes from."""
    return connection.client.host if connection.client is not None else ""


def is_here(connection: HTTPConnection, *, proxied: bool) -> bool:
    """Whether a request comes from this computer, so that nobody has read it on its way.

    None is known to where a proxy passes requests on: without the header that names the client each comes from here.
    """
    try:
        return not proxied and ip_address(address_of(connection)).is_loopback
    except ValueError:
        return False
