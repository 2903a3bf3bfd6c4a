"""The options of a provider that logs people in, and what has to be there for it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from importlib.util import find_spec
from typing import Annotated, Any

import typer

from palpate.errors import PalpateError, extra

__all__ = ["ProviderOptions"]

NEEDED = ("authlib", "httpx2")
PROVIDER = "Logging in elsewhere"


class NewPeople(StrEnum):
    """What somebody may do whom the provider knows and nobody here."""

    READER = "reader"


@dataclass(frozen=True)
class ProviderOptions:
    """An OpenID provider."""

    oidc_issuer: Annotated[
        str | None,
        typer.Option(
            metavar="URL",
            envvar="PALPATE_OIDC_ISSUER",
            help="OpenID provider that logs people in too.",
            rich_help_panel=PROVIDER,
        ),
    ] = None
    oidc_client_id: Annotated[
        str | None,
        typer.Option(
            metavar="ID",
            envvar="PALPATE_OIDC_CLIENT_ID",
            help="By it the provider knows this server; its secret is PALPATE_OIDC_SECRET.",
            rich_help_panel=PROVIDER,
        ),
    ] = None
    oidc_new: Annotated[
        NewPeople | None,
        typer.Option(help="What who has no account may do; unless given they get none.", rich_help_panel=PROVIDER),
    ] = None

    def settings(self) -> dict[str, Any]:
        """The same for a server.

        Raises
        ------
        PalpateError
            If it is half a provider, one that anybody could stand in for, or the package cannot speak to one yet.
        """
        if self.oidc_issuer is None and self.oidc_client_id is None:
            if self.oidc_new is not None:
                raise PalpateError("--oidc-new: expected --oidc-issuer and --oidc-client-id too")
            return {}
        from palpate.server.security.single_sign_on import check_issuer

        if self.oidc_issuer is None:
            raise PalpateError("--oidc-client-id: expected --oidc-issuer too, the address of the provider")
        if self.oidc_client_id is None:
            raise PalpateError("--oidc-issuer: expected --oidc-client-id too, by which the provider knows this server")
        check_issuer(self.oidc_issuer)
        missing = [name for name in NEEDED if find_spec(name) is None]
        if missing:
            raise PalpateError(f"--oidc-issuer needs {missing[0]}, which is not installed: {extra('oidc')}")
        return {
            "oidc_issuer": self.oidc_issuer,
            "oidc_client_id": self.oidc_client_id,
            "oidc_new_readers": self.oidc_new is NewPeople.READER,
        }
