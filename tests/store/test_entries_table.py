import polars
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.store.archive_rows import entry_row
from palpate.store.entries import Distribution, Value
from palpate.store.entries_table import entries_table
from palpate.store.filters import Filter, Sort
from palpate.store.records import Recording
from palpate.store.store import Store
from tests.store.made_up import recordings, squeeze


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(st.lists(recordings(), max_size=3))
def test_rows_are_those_of_an_archive(local: Store, made: list[Recording]) -> None:
    """Each result has the row that it would have in an archive, under the id that the store gave the recording."""
    ids = {receipt.digest: str(receipt.id) for receipt in local.put_many(made)}
    expected = [
        {**entry_row(one, entry), "recording": ids[one.digest]}
        for one in {one.digest: one for one in made}.values()
        for entry in one.entries
    ]
    rows = [row for row in entries_table(local).to_pylist() if row["recording"] in ids.values()]
    key = lambda row: (row["recording"], row["document"])  # noqa: E731
    assert sorted(rows, key=key) == sorted(expected, key=key)


def test_filters_order_and_limit_apply(store: Store) -> None:
    """Which recordings, in which order and how many, is as in a list; data frames are one call away."""
    store.put_many(squeeze(number) for number in range(5))
    store.put(squeeze(9, entries=(Distribution("kind", {"mug": 1.0}), Value("mass", 1.0, None, "g"))))
    table = entries_table(store, Filter(property="elasticity"), Sort(descending=False), limit=3)
    assert table["value"].to_pylist() == [40.0, 41.0, 42.0]
    assert table.to_pandas()["value_si"].tolist() == pytest.approx([40e3, 41e3, 42e3])
    frame = polars.from_arrow(entries_table(store, limit=1))
    assert isinstance(frame, polars.DataFrame)
    assert frame["property"].to_list() == ["kind", "mass"]
    assert entries_table(store, Filter(action="nothing")).num_rows == 0
