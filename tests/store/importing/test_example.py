from pathlib import Path

import numpy as np

from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.own_formats import EXAMPLE
from palpate.store.reading_archive import read_archive
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.importing.make_example import made_recordings


def test_the_example_is_imported(local: Store) -> None:
    """The shipped archive has five recordings of one object with one setup, is imported whole, and verifies."""
    told = list(import_paths(local, [EXAMPLE], all_formats()))
    assert [one.fate for one in told] == [Fate.NEW] * 5
    assert list(verify(local)) == []
    recordings = [one.recording for one in told if one.recording]
    assert {one.action for one in recordings} == {"cat-vision", "mat-vision", "mat-sound", "squeezing", "weighing"}
    assert {(one.thing.dataset, one.thing.id) for one in recordings} == {("ycb", "011_banana")}
    assert len({one.setup.digest for one in recordings}) == 1
    assert all(len(one.notices) >= 4 for one in recordings)


def test_the_example_holds_the_figures(local: Store) -> None:
    """Fifty weighings of 68.3 g with an SD of 5.3 g, a failed squeeze, and labels that no network knows."""
    by_action = {one.action: one for one in read_archive(EXAMPLE)}
    (channel,) = by_action["weighing"].series[0].channels
    assert (channel.unit, channel.values.size) == ("g", 50)
    np.testing.assert_allclose([channel.values.mean(), channel.values.std(ddof=1)], [68.3, 5.3], atol=0.05)
    assert by_action["weighing"].entries == (Value("mass", float(channel.values.mean()), None, "g"),)
    assert by_action["squeezing"].entries == (FailedEntry("the mean is nan", "elasticity"),)
    (labels,) = by_action["cat-vision"].entries
    assert isinstance(labels, Distribution)
    assert round(labels.probabilities["kettle"], 3) == 0.576


def test_the_example_is_what_its_maker_makes() -> None:
    """The archive is the one that is made of the session that ships, and holds no file of others."""
    shipped = {one.digest: one for one in read_archive(EXAMPLE)}
    assert list(shipped) == [one.digest for one in made_recordings()]
    assert not any(one.files for one in shipped.values())
    size = sum(path.stat().st_size for path in Path(EXAMPLE).rglob("*") if path.is_file())
    assert size < 200_000
