from urllib.parse import unquote, urlsplit

from hypothesis import given
from hypothesis import strategies as st

from palpate.server.names import escape, thing_address, unescape
from palpate.store.records import ThingRef

names = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1)


@given(names)
def test_any_name_comes_back(name: str) -> None:
    """Escaping loses nothing."""
    assert unescape(escape(name)) == name


@given(names, names)
def test_an_address_has_two_parts_and_stays_where_it_is(dataset: str, name: str) -> None:
    """Whatever is in the names, an address has one slash, and no part that would lead elsewhere."""
    address = thing_address(ThingRef(dataset, name))
    parts = urlsplit(f"http://here/objects/{address}").path.removeprefix("/objects/").split("/")
    assert [unescape(unquote(part)) for part in parts] == [dataset, name]
    assert not {".", "..", ""} & {unquote(part) for part in parts}
