from palpate.store.calibrations import devices_of
from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.measured import measured_of
from palpate.store.merging import merge_things
from palpate.store.records import Device, Setup, ThingRef
from palpate.store.store import Store
from tests.store.made_up import squeeze

A, B = ThingRef("made_up", "a"), ThingRef("made_up", "b")


def test_results_are_told_by_property_and_setup(store: Store) -> None:
    """Values are averaged in the unit first given, labels and failures counted, and merged objects count."""
    other = Setup(gripper=Device("gripper", "another"))
    results = [
        (A, Value("mass", 100.0, unit="g"), Setup()),
        (B, Value("mass", 0.102, unit="kg"), Setup()),
        (A, Value("mass", 7.0), Setup()),
        (A, Value("mass", 90.0, unit="g"), other),
        (A, Distribution("kind", {"mug": 0.9, "box": 0.1}), Setup()),
        (A, FailedEntry("slipped", "kind"), Setup()),
        (A, FailedEntry("broke"), Setup()),
    ]
    store.put_many(squeeze(n, thing=thing, entries=(e,), setup=setup) for n, (thing, e, setup) in enumerate(results))
    merge_things(store, B, A)
    kind, own, others, whole = measured_of(store, A)
    assert (kind.results, kind.failed, kind.labels, kind.mean) == (2, 1, {"mug": 1}, None)
    assert (own.property, own.results, own.unit, round(own.mean or 0, 9)) == ("mass", 3, "g", 101.0)
    assert (others.setup, others.mean, others.sd) == (other, 90.0, None)
    assert (whole.property, whole.failed) == (None, 1)


def test_devices_keep_each_calibration(store: Store) -> None:
    """A device that was calibrated again is there with both dates, in order, and with what each measured."""
    dates = ("2024-05-01", None, "2024-01-01", "2024-01-01")
    setups = [Setup(gripper=Device("gripper", "g", calibration={"k": date}, calibrated_on=date)) for date in dates]
    store.put_many(squeeze(number, setup=setup) for number, setup in enumerate(setups))
    store.put(squeeze(9))
    found = devices_of(store, "g")
    assert [(one.device.calibrated_on, one.recordings) for one in found] == [
        (None, 1),
        ("2024-01-01", 2),
        ("2024-05-01", 1),
    ]
    assert {one.device.name for one in devices_of(store)} == {"g", "two_finger"}
