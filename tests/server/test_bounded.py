"""What a server remembers of what others send has an end."""

import functools
import gc
import importlib
import pkgutil
from pathlib import Path
from typing import Any

import pytest

import palpate.server
import palpate.store
from palpate.network import units
from palpate.server.security.rates import Rate
from palpate.server.security.tries import LONGEST_NAME, Tries
from palpate.store import registry
from palpate.store.fetching import setup_of
from palpate.store.opening import open_store
from palpate.store.quantities import quantity_fault
from palpate.store.remembering import LARGEST, remembered
from tests.store.made_up import squeeze


def test_no_cache_grows_with_what_is_asked() -> None:
    """A cache without an end is of a function that is asked for one thing only."""
    for package in (palpate.server, palpate.store):
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if "migrations" not in found.name:
                importlib.import_module(found.name)
    caches = [one for one in gc.get_objects() if isinstance(one, functools._lru_cache_wrapper)]
    parts = ("palpate.server.", "palpate.store.", "palpate.network.")
    endless = [
        f"{one.__module__}.{one.__name__}"
        for one in caches
        if (one.__module__ or "").startswith(parts)
        and one.cache_info().maxsize is None
        and one.__wrapped__.__code__.co_argcount
    ]
    assert endless == []


def test_pint_forgets_units(monkeypatch: pytest.MonkeyPatch) -> None:
    """It remembers each that it was ever asked for, known or not, and so is made anew now and then."""
    monkeypatch.setattr(units, "MOST_ASKED", 50)
    before = units._registry.cache_info().misses
    for number in range(200):
        assert units.ask_pint(f"m^1.{number:04}5").factor == 1.0
        with pytest.raises(units.UnitError):
            units.ask_pint(f"blorp{number}")
    assert 7 <= units._registry.cache_info().misses - before <= 9
    assert units._registry.cache_info().currsize == 1


def test_a_store_forgets_what_recordings_share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is forgotten is found again: each object is there once."""
    monkeypatch.setattr(registry, "MOST_REMEMBERED", 10)
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        for turn in range(2):
            for number in range(12):
                thing = {"attributes": {"note": f"{number} {'x' * 10_000}"}}
                assert store.put(squeeze(100 * turn + number, **_described(number, thing))).new
            assert len(store._registry.remembered) <= 10
        assert all(len(str(key)) < 200 for key in store._registry.remembered)
        with store.engine.connect() as connection:
            assert connection.exec_driver_sql("SELECT count(*) FROM things").scalar() == 12


def _described(number: int, thing: dict[str, Any]) -> dict[str, Any]:
    from palpate.store.records import ThingRef

    return {"thing": ThingRef("lab", f"thing {number}", **thing)}


def test_what_is_large_is_not_remembered() -> None:
    """So many are few bytes; whatever is remembered is what would be worked out again."""
    asked = list[int]()

    @remembered(4)
    def length(text: str, parts: tuple[str, ...] = ()) -> int:
        asked.append(len(text))
        return len(text)

    for size in (3, 3, LARGEST + 1, LARGEST + 1):
        assert length("x" * size) == size
    assert length("abc", ("y" * LARGEST,)) == length("abc", ("y" * LARGEST,)) == 3
    assert asked == [3, LARGEST + 1, LARGEST + 1, 3, 3]
    assert quantity_fault("g" * 10_000, "mass") == quantity_fault("g" * 10_000, "mass") is not None
    assert setup_of.__name__ == "setup_of"


def test_names_of_those_who_try_to_log_in_are_cut() -> None:
    """A name may be as long as a form; nobody's memory is full of such."""
    from starlette.requests import HTTPConnection

    tries = Tries(of_name_here=Rate(1.0, 2), of_address=Rate(1.0, 100))
    here = HTTPConnection({"type": "http", "client": ("127.0.0.1", 1), "headers": []})
    tries.count(here, "x" * 1_000_000)
    (key,) = tries.of_name_here._left
    assert len(key) < LONGEST_NAME + 50
