"""Where a server listens, and where people reach it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from palpate.server.running import Address, PublicAddress

__all__ = ["AddressOptions"]


@dataclass(frozen=True)
class AddressOptions:
    """The options of the command that say where."""

    host: Annotated[str, typer.Option(help="Address to listen at; others reach it only where this is not local.")] = (
        "127.0.0.1"
    )
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen at.")] = 8000
    public: Annotated[
        str | None, typer.Option(metavar="URL", help="Address by which people reach it, where a proxy passes them on.")
    ] = None

    def address(self) -> Address:
        """Where it listens."""
        from palpate.server.running import Address

        return Address(self.host, self.port)

    def reached(self) -> Address | PublicAddress:
        """Where people reach it."""
        from palpate.server.running import PublicAddress

        return self.address() if self.public is None else PublicAddress.of(self.public)
