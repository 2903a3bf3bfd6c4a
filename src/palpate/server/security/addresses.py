"""Where a request comes from."""

from __future__ import annotations

from ipaddress import IPv6Address, IPv6Network, ip_address

from starlette.requests import HTTPConnection

__all__ = ["address_of", "is_here", "network_at", "network_of"]

IPV6_BITS = 64
"""Of an address that are those of its network."""


def network_of(connection: HTTPConnection) -> str:
    """Where a request comes from, of IPv6 the network: who has one address of it has all."""
    return network_at(address_of(connection))


def network_at(address: str) -> str:
    """The network of an address, which of IPv4 is the address itself.

    Examples
    --------
    >>> network_at("2001:db8::1:2"), network_at("192.0.2.1"), network_at("::ffff:192.0.2.1")
    ('2001:db8::/64', '192.0.2.1', '192.0.2.1')
    """
    try:
        found = ip_address(address)
    except ValueError:
        return address
    if not isinstance(found, IPv6Address):
        return address
    if found.ipv4_mapped is not None:
        # as a socket for both says it; all of IPv4 is one network there
        return str(found.ipv4_mapped)
    return str(IPv6Network((found.packed, IPV6_BITS), strict=False))


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
