"""`palpate user`: accounts of a server, and their tokens."""

from __future__ import annotations

import json
import sys
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place

if TYPE_CHECKING:
    from palpate.store.store import Store

__all__ = ["app"]

app = typer.Typer(help="Accounts of a server, and their tokens.")
Name = Annotated[str, typer.Argument(metavar="NAME", help="The account; recordings of this owner are theirs.")]


class RoleName(StrEnum):
    """What an account may do; each may do what those before it may."""

    READER = "reader"
    OWNER = "owner"
    CURATOR = "curator"
    ADMIN = "admin"


RoleOption = Annotated[RoleName, typer.Option(help="What they may do; each may do what those before it may.")]


Email = Annotated[
    str | None, typer.Option(help="By it they are known to a provider of log-ins; for people who run the server too.")
]
Issuer = Annotated[
    str | None,
    typer.Option("--oidc-issuer", metavar="URL", envvar="PALPATE_OIDC_ISSUER", help="The provider of --oidc-subject."),
]
Subject = Annotated[
    str | None, typer.Option("--oidc-subject", metavar="TEXT", help="Who they are to the provider, in its own words.")
]


@app.callback()
def user() -> None:
    """Accounts of a server, and their tokens."""
    from palpate.cli.storing import check_installed

    check_installed()


@app.command("add")
@spread
def add(
    place: Place,
    name: Name,
    role: RoleOption = RoleName.OWNER,
    email: Email = None,
    issuer: Issuer = None,
    subject: Subject = None,
) -> None:
    """Make an account, and print a token for it, which nobody can tell again."""
    from palpate.server.security.accounts import Role, add_user
    from palpate.server.security.identities import check_link, link
    from palpate.server.security.tokens import issue

    with place.opened(make=True) as store:
        of = {"email": email, **_at_provider(issuer, subject)}
        check_link(store, name, **of)
        add_user(store, name, Role.parse(role.value))
        link(store, name, **of)
        _note(store, name, f"made the account of {Role.parse(role.value).with_article}")
        print(issue(store, name))


@app.command("link")
@spread
def link(place: Place, name: Name, email: Email = None, issuer: Issuer = None, subject: Subject = None) -> None:
    """Say by what a provider of log-ins knows an account."""
    from palpate.server.security.identities import link as set_link

    with place.opened() as store:
        set_link(store, name, email=email, **_at_provider(issuer, subject))
        _note(store, name, "said by what a provider knows it")


def _note(store: Store, account: str | None, did: str) -> None:
    """Say in the audit who did something to an account on this computer."""
    from palpate.cli.knowing import who_of
    from palpate.server.security.noting import note_account

    note_account(store, who_of(None), account, did)


def _at_provider(issuer: str | None, subject: str | None) -> dict[str, str | None]:
    """Both or none; the variable of the environment may be set for the server alone."""
    return {"issuer": None if subject is None else issuer, "subject": subject}


@app.command("role")
@spread
def role(place: Place, name: Name, role: Annotated[RoleName, typer.Argument(help="What they may do now.")]) -> None:
    """Let an account do more or less; its tokens with it."""
    from palpate.server.security.accounts import Role, set_role

    with place.opened() as store:
        set_role(store, name, Role.parse(role.value))
        _note(store, name, f"made it {Role.parse(role.value).with_article}")


@app.command("token")
@spread
def token(
    place: Place,
    name: Name,
    role: Annotated[
        RoleName | None, typer.Option(help="What it may do at most; all that they may unless given.")
    ] = None,
    days: Annotated[float, typer.Option(help="After how many days it expires.")] = 365.0,
) -> None:
    """Print a new token, which nobody can tell again."""
    from palpate.server.security.accounts import Role
    from palpate.server.security.tokens import issue

    with place.opened() as store:
        secret = issue(store, name, None if role is None else Role.parse(role.value), days=days)
        _note(store, name, "made a token")
        print(secret)


@app.command("password")
@spread
def password(place: Place, name: Name) -> None:
    """Give an account a password, to log in with a browser; it is asked for, or read from standard input."""
    from palpate.server.security.logging_in import set_password

    asked = typer.prompt("Password", hide_input=True, confirmation_prompt=True) if sys.stdin.isatty() else input()
    with place.opened() as store:
        set_password(store, name, asked)
        _note(store, name, "gave a new password")
    print(f"{name} has a new password; who was logged in under that name is no more, and other tokens hold")


@app.command("revoke")
@spread
def revoke(
    place: Place, token: Annotated[int, typer.Argument(metavar="NUMBER", help="Of the list of tokens.")]
) -> None:
    """End a token at once."""
    from palpate.server.security.tokens import revoke as end

    with place.opened() as store:
        end(store, token)
        _note(store, None, f"ended token {token}")


@app.command("list")
@spread
def list_(place: Place, as_json: Annotated[bool, typer.Option("--json", help="JSON, for programs.")] = False) -> None:
    """List accounts and their tokens."""
    from palpate.server.security.accounts import users
    from palpate.server.security.tokens import tokens

    with place.opened() as store:
        found, held = users(store), tokens(store)
    if as_json:
        plain = {"users": [vars(one) for one in found], "tokens": [vars(one) for one in held]}
        print(json.dumps(plain, default=str, indent=1))
        return
    for one in found:
        print(f"{one.name}: {one.role}, since {one.created_at:%Y-%m-%d}{f', {one.email}' if one.email else ''}")
        for token in held:
            if token.user == one.name:
                ends = f", expires {token.expires_at:%Y-%m-%d}" if token.expires_at else ""
                kind = "session" if token.is_session else "token"
                print(f"  {kind} {token.id}: {token.role}{', revoked' if token.revoked_at else ends}")
