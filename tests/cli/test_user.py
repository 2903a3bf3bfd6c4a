import json
from io import StringIO
from pathlib import Path

import pytest

from palpate.cli import main
from palpate.server.security.accounts import Account, Role, users
from palpate.server.security.identities import account_name
from palpate.server.security.logging_in import log_in
from palpate.server.security.single_sign_on import Identity
from palpate.server.security.tokens import account_of
from palpate.store.opening import open_store


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    return int(stopped.value.code or 0)


def test_the_first_administrator(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An account is made on the command line, with the token that it prints; others follow, and end."""
    place = str(tmp_path / "store.sqlite")
    assert run("user", "add", "ann", "--role", "admin", "--email", "ann@example.org", "--store", place) == 0
    assert run("user", "token", "ann", "--role", "owner", "--days", "1", "--store", place) == 0
    first, second = capsys.readouterr().out.split()
    with open_store(place) as store:
        assert account_of(store, first) == Account("ann", Role.ADMIN)
        assert account_of(store, second) == Account("ann", Role.OWNER)
    assert run("user", "revoke", "1", "--store", place) == 0
    assert run("user", "role", "ann", "curator", "--store", place) == 0
    capsys.readouterr()
    assert run("user", "list", "--store", place) == 0
    told = capsys.readouterr().out
    assert "ann: curator" in told
    assert "token 1: admin, revoked" in told
    assert first not in told
    assert run("user", "list", "--json", "--store", place) == 0
    plain = json.loads(capsys.readouterr().out)
    assert [one["role"] for one in plain["tokens"]] == ["admin", "owner"]
    with open_store(place) as store:
        assert account_of(store, first) is None


def test_a_password_is_read_and_not_shown(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """It comes from standard input, and lets somebody log in; one that is too short is refused."""
    place = str(tmp_path / "store.sqlite")
    run("user", "add", "ann", "--store", place)
    for password, code in (("short", 2), ("correct horse battery", 0)):
        monkeypatch.setattr("sys.stdin", StringIO(f"{password}\n"))
        assert run("user", "password", "ann", "--store", place) == code
        told = capsys.readouterr()
        assert password not in told.out + told.err
        assert told.out.startswith("ann has a new password") == (code == 0)
    with open_store(place) as store:
        assert log_in(store, "ann", "correct horse battery") is not None
        assert log_in(store, "ann", "correct horse") is None


def test_mistakes_exit_with_two(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One sentence on standard error."""
    place = str(tmp_path / "store.sqlite")
    assert run("user", "token", "bob", "--store", place) == 2
    assert "there is no store" in capsys.readouterr().err
    assert run("user", "add", "ann", "--store", place) == 0
    assert run("user", "token", "bob", "--store", place) == 2
    assert "'bob' has no account" in capsys.readouterr().err


def test_an_account_is_linked_to_a_provider(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """When it is made or later; by an address or a subject that no other account has; half a subject is refused."""
    place = str(tmp_path / "store.sqlite")
    issuer = "https://login.example"
    assert run("user", "add", "ann", "--email", "ann@example.org", "--store", place) == 0
    assert run("user", "add", "bob", "--email", "ANN@example.org", "--store", place) == 2
    assert "'ann' is known by that already" in capsys.readouterr().err
    assert run("user", "link", "ann", "--oidc-subject", "s-1", "--store", place) == 2
    assert "together with the address of the provider" in capsys.readouterr().err
    monkeypatch.setenv("PALPATE_OIDC_ISSUER", issuer)
    assert run("user", "link", "ann", "--oidc-subject", "s-1", "--store", place) == 0
    # the variable alone says nothing of an account
    assert run("user", "add", "carla", "--store", place) == 0
    with open_store(place) as store:
        assert [one.name for one in users(store)] == ["ann", "carla"]
        assert account_name(store, Identity(issuer, "s-1", None), new_readers=False) == "ann"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--oidc-issuer", "https://login.example"], "expected --oidc-client-id too"),
        (["--oidc-client-id", "palpate"], "expected --oidc-issuer too"),
        (["--oidc-new", "reader"], "expected --oidc-issuer and --oidc-client-id too"),
        (["--oidc-issuer", "http://login.example", "--oidc-client-id", "a"], "expected an address that begins with"),
    ],
)
def test_half_a_provider_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], told: str
) -> None:
    """Before anything is served or made."""
    place = tmp_path / "store.sqlite"
    assert run("serve", *arguments, "--store", str(place)) == 2
    assert told in capsys.readouterr().err
    assert not place.exists()
