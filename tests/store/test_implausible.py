"""What cannot be true is told, and refused where it is said to be known to be true."""

from dataclasses import replace

import pytest

from palpate.store.checks import check
from palpate.store.entries import Bound, Entry, Interval, Value
from palpate.store.errors import StoreError
from palpate.store.implausible import implausible
from palpate.store.importing.items import Fate, Outcome
from palpate.store.importing.report import Report
from palpate.store.store import Store
from tests.store.made_up import squeeze

TOLD = "entries[0].value: found -5, expected more than 0, as each mass is"
BELOW = Value("mass", -5.0, unit="g")


@pytest.mark.parametrize(
    "entry", [Value("mass", 5.0), Interval("mass", 0.0, 2.0), Bound("mass", above=0.0), Value("temperature", -5.0)]
)
def test_what_can_be_true_is_not_told(entry: Entry) -> None:
    """A positive number, what is open at nothing, and a property that may be negative."""
    assert implausible(squeeze(entries=(entry,))) == ()


def test_it_is_kept_and_told_each_time(store: Store) -> None:
    """The receipt tells it, whether the recording is new or known, and the recording stays as it was given."""
    recording = squeeze(entries=(BELOW,), ground_truth=False)
    assert [store.put(recording).notices for _ in range(2)] == [(TOLD,)] * 2
    assert store.get(recording.id) == recording


def test_what_is_said_to_be_true_is_refused() -> None:
    """Nothing that a store has had is held to it."""
    wrong = replace(squeeze(entries=(BELOW,)), ground_truth=True)
    with pytest.raises(StoreError, match="found -5, expected more than 0"):
        check(wrong)
    check(wrong, is_new=False)


def test_an_import_tells_it() -> None:
    """Of what was kept, and not of what was refused for another reason."""
    report, recording = Report(), squeeze(entries=(BELOW,))
    for fate in (Fate.NEW, Fate.REFUSED):
        report.add(Outcome("a.json", fate, None, recording))
    assert report.plain()["implausible"] == [{"source": "a.json", "notice": TOLD}]
