"""Numbers in forms are what people write: nothing else that a computer takes for one, and no label by mistake."""

from datetime import UTC, datetime
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.server.typed_entries import typed_entry, typed_number
from palpate.store.entries import Distribution, Value
from palpate.store.errors import StoreError
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.viewing import Viewer
from palpate.store.visible_things import visible_thing
from tests.server.conftest import SMALL
from tests.store.made_up import squeeze

WRITTEN = {
    "1": 1.0,
    "-0.5": -0.5,
    "+3.": 3.0,
    ".25": 0.25,
    "1e5": 1e5,
    "1.2E-3": 0.0012,
    "0010": 10.0,
    "0.0e9": 0.0,
    "5e-324": 5e-324,
}
OTHERWISE = (
    "1_000",
    "١٢",
    "1,5",
    "1 000",
    "0x10",
    "1e",
    "e5",
    ".",
    "--1",
    "½",
    "1e5_0",
    "\uff11",
    "\u22125",
    "nan",
    "inf",
    "1e400",
    "1e-400",
    "-0.01e-400",
)
NO_LABELS = tuple(set(OTHERWISE) - {"0x10", "1e", "e5", ".", "½"})


@pytest.mark.parametrize(("text", "number"), WRITTEN.items())
def test_what_people_write_is_a_number(text: str, number: float) -> None:
    """Decimals, and exponents."""
    assert typed_number("value", text) == number
    assert typed_entry({"property": "mass", "value": text, "sd": text}) == Value("mass", number, number, None)


@pytest.mark.parametrize("text", OTHERWISE)
def test_what_only_a_computer_takes_is_refused(text: str) -> None:
    """With the field, what was found, and what would be right; also where it would pass for a label."""
    for field in ("value", "sd"):
        given = {"property": "mass", "value": "1", "unit": "g", field: text}
        with pytest.raises(StoreError, match=f"^{field}: found .*expected a (finite )?number"):
            typed_entry(given)
    if text in NO_LABELS:
        with pytest.raises(StoreError, match=r"^value: found .*expected a (finite )?number"):
            typed_entry({"property": "material", "value": text})


def test_a_label_is_a_word() -> None:
    """It may have digits in it; beside a unit it is told that it has none."""
    assert typed_entry({"property": "material", "value": "steel 304"}) == Distribution("material", {"steel 304": 1.0})
    with pytest.raises(StoreError, match=r"found 'heavy' beside a unit, .* a label has no unit"):
        typed_entry({"property": "mass", "value": "heavy", "unit": "g"})
    with pytest.raises(StoreError, match=r"^sd: found '0.1' beside the label 'wood', .* a label has no SD"):
        typed_entry({"property": "material", "value": "wood", "sd": "0.1"})


def test_forms_refuse_it(tmp_path: Path) -> None:
    """That of a typed measurement, that of what is known of an object, and that of a token."""
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        add_user(store, "ann", Role.OWNER)
        store.put(squeeze(thing=ThingRef("lab", "mug"), owner="ann"))
        client = TestClient(application(store, SMALL), cookies={"palpate-session": issue(store, "ann")})
        client.headers["Origin"] = "http://testserver"
        known = {"property": "mass", "value": "1_000", "unit": "g"}
        when = f"{datetime.now(UTC):%Y-%m-%dT%H:%M}"
        typed = {"dataset": "lab", "object": "mug", "action": "weighing", "recorded_at": when, **known}
        told = "found &#39;1_000&#39;, expected a number in digits and a decimal point"
        for address, data in (
            ("/upload/one", typed),
            ("/objects/lab/mug/edit", {"do": "know", "source": "a scale", **known}),
            ("/account", {"do": "token", "role": "reader", "days": "1_000"}),
        ):
            found = client.post(address, data=data)
            assert (found.status_code, told in found.text) == (422, True), address
        assert len(list_recordings(store).rows) == 1
        thing = visible_thing(store, Viewer("ann"), "lab", "mug")
        assert thing is not None
        assert thing.known == ()
