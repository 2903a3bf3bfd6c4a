"""What people do to accounts over the network, theirs and as administrators others': each is noted in the audit."""

from __future__ import annotations

import secrets
from dataclasses import dataclass

from palpate.server.security.accounts import Account, Role, add_user, set_role
from palpate.server.security.identities import check_link
from palpate.server.security.logging_in import knows_password, set_password
from palpate.server.security.noting import note_account
from palpate.server.security.tokens import issue, revoke
from palpate.store.errors import StoreError
from palpate.store.store import Store

__all__ = ["Accounts"]

LETTERS = "abcdefghjkmnpqrstuvwxyz23456789"
"""Of passwords that are told: none that looks like another one."""


@dataclass(frozen=True)
class Accounts:
    """Accounts as somebody may change them; a StoreError where something cannot be so, and nothing is changed then."""

    store: Store
    who: Account

    @property
    def name(self) -> str:
        """One's own account; a StoreError where there is none, as with the key of the store."""
        if self.who.name is None or self.who.role is Role.NOBODY:
            raise StoreError("account: nobody is logged in")
        return self.who.name

    def change_password(self, old: str, new: str) -> None:
        """One's own, by the one that held; whoever was logged in under that name is no more."""
        if not knows_password(self.store, self.name, old):
            raise StoreError("old password: is not the one that holds")
        set_password(self.store, self.name, new)
        self._note(self.name, "changed the password")

    def make_token(self, role: Role | None, days: float, until_us: int | None, last: int | None = None) -> str:
        """One's own, which may do no more than who asks now, and ends at `until_us` at the latest.

        Refused where there is a later one than the `last` that they have seen.
        """
        if role is not None and role > self.who.role:
            raise StoreError(f"role: is {role.name.lower()}, expected {self.who.role.name.lower()} or less")
        secret = issue(self.store, self.name, role or self.who.role, days=days, until_us=until_us, last=last)
        self._note(self.name, f"made a token for {(role or self.who.role).with_article}")
        return secret

    def end_token(self, number: int) -> None:
        """One's own that may do no more than who asks now, or as an administrator any."""
        is_admin = self.who.role is Role.ADMIN
        revoke(self.store, number, user=None if is_admin else self.name, most=self.who.role)
        self._note(None if is_admin else self.name, f"ended token {number}")

    def add(self, name: str, role: Role, email: str | None) -> str:
        """An account, and the password that it begins with."""
        check_link(self.store, name, email=email, issuer=None, subject=None)
        add_user(self.store, name, role, email)
        self._note(name, f"made the account of {role.with_article}")
        return self.give_password(name)

    def set_role(self, name: str, role: Role) -> None:
        """What an account may do from now on; not one's own, as nobody could take that back."""
        if name == self.who.name:
            raise StoreError("name: is your own account, expected another one: ask another administrator")
        set_role(self.store, name, role)
        self._note(name, f"made it {role.with_article}")

    def give_password(self, name: str) -> str:
        """A new password for an account, which nobody can tell again; whoever was logged in is no more."""
        told = "-".join("".join(secrets.choice(LETTERS) for _ in range(5)) for _ in range(3))
        set_password(self.store, name, told)
        self._note(name, "gave a new password")
        return told

    def _note(self, account: str | None, did: str) -> None:
        note_account(self.store, self.who.name, account, did)
