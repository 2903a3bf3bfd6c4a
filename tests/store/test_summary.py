import numpy as np
import pytest

from palpate.store.curves import curves_of_gripper
from palpate.store.entries import Value
from palpate.store.overview import contents
from palpate.store.records import Device, Setup
from palpate.store.store import Store
from palpate.store.summary import cells_to_arrow, objects_by_properties
from palpate.store.verifying import verify
from tests.store.made_up import squeeze

OTHER = Setup(gripper=Device("gripper", "soft_hand"))


def test_the_table_summarises_values(store: Store) -> None:
    """Mean, SD, count and spread between setups are those of the values, in the unit of the first."""
    rng = np.random.default_rng(0)
    values = rng.normal(100.0, 5.0, (2, 9))
    for setup, row in zip((squeeze().setup, OTHER), values, strict=True):
        units = ["g", *["kg"] * 8] if setup != OTHER else ["g"] * 9
        scaled = [value / 1000 if unit == "kg" else value for value, unit in zip(row, units, strict=True)]
        for number, (value, unit) in enumerate(zip(scaled, units, strict=True)):
            entries = (Value("mass", float(value), unit=unit), Value("unstated", 1.0))
            store.put(squeeze(3 * number, setup=setup, entries=entries))
    (cell,) = objects_by_properties(store)
    assert (cell.thing, cell.property, cell.unit, cell.count, cell.devices) == ("object0", "mass", "g", 18, 2)
    assert cell.mean == pytest.approx(values.mean())
    assert cell.sd == pytest.approx(values.std(ddof=1))
    assert cell.between_devices_sd == pytest.approx(values.mean(axis=1).std(ddof=1))


@pytest.mark.parametrize("kind", [np.float16, np.float32, np.float64, np.int64, np.uint8])
def test_numbers_of_numpy_count_as_any(store: Store, kind: type) -> None:
    """They are kept as plain numbers, also where they are scaled to SI units."""
    store.put(squeeze(entries=(Value("mass", kind(118), kind(2), unit="g"),)))
    (cell,) = objects_by_properties(store)
    assert cell.mean == pytest.approx(118.0)
    assert cell.unit == "g"
    assert list(verify(store)) == []


def test_a_single_value_has_no_spread(local: Store) -> None:
    """One value has a mean and no SDs; an empty store has an empty table."""
    assert objects_by_properties(local) == []
    local.put(squeeze())
    (cell,) = objects_by_properties(local)
    assert cell.mean == pytest.approx(40.0)
    assert (cell.sd, cell.between_devices_sd) == (None, None)


def test_curves_of_one_gripper(store: Store) -> None:
    """All series of one gripper come back in the order of recording, and no others."""
    made = [squeeze(number, setup=OTHER if number % 2 else squeeze().setup) for number in range(6)]
    store.put_many(reversed(made))
    found = list(curves_of_gripper(store, "soft_hand"))
    assert found == [(recording.id, recording.series[0]) for recording in made if recording.setup == OTHER]
    assert list(curves_of_gripper(store, "soft_hand", action="weighing")) == []


def test_contents_count(store: Store) -> None:
    """The overview counts recordings by object and by setup."""
    store.put_many([squeeze(number, setup=OTHER if number == 0 else squeeze().setup) for number in range(5)])
    found = contents(store)
    assert found.recordings == 5
    assert {thing.id: count for thing, count in found.things} == {"object0": 2, "object1": 2, "object2": 1}
    assert [(setup, count) for setup, count in found.setups] == [(squeeze().setup, 4), (OTHER, 1)]


def test_the_table_as_arrow(store: Store) -> None:
    """Each cell is a row; a store without measurements gives the columns all the same."""
    empty = cells_to_arrow(objects_by_properties(store))
    store.put(squeeze())
    cells = objects_by_properties(store)
    table = cells_to_arrow(cells)
    assert table.to_pylist() == [vars(cell) for cell in cells]
    assert (empty.num_rows, empty.schema) == (0, table.schema)
