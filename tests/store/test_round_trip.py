"""Any recording through all places where it is kept on its way: spool, store, archive, and another store."""

import tempfile
from pathlib import Path

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.recording.spool import Spool
from palpate.recording.uploading import upload
from palpate.store.archive import export_archive
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.opening import open_store
from palpate.store.records import Recording
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.made_up import recordings


def content(recording: Recording) -> tuple[object, ...]:
    """What a recording says, without its object, which is described better when others say more of it."""
    files = [
        (item.name, item.media_type, item.data if isinstance(item.data, bytes) else item.data.read_bytes())
        for item in recording.files
    ]
    arrays = [
        (series.name, channel.name, channel.values.tobytes(), None if stamps is None else stamps.tobytes())
        for series in recording.series
        for channel in series.channels
        for stamps in [channel.time_s]
    ]
    said = (recording.document, recording.log, recording.entries, recording.notices, recording.visibility)
    return (recording.id, recording.recorded_at, recording.setup, files, arrays, *said)


@settings(
    max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], deadline=None
)
@given(st.lists(recordings(), min_size=1, max_size=3, unique_by=lambda recording: recording.digest))
def test_any_recording_comes_through_unchanged(store: Store, made: list[Recording]) -> None:
    """Recorded, sent, exported and imported elsewhere, a recording is the one it was; so is one sent twice."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        spool = Spool(folder / "spool", sync=False)
        for recording in made:
            spool.add(recording)
        assert {sent.state for sent in upload(spool, store)} <= {"sent", "known"}
        assert spool.waiting() == []
        in_store = {recording.digest: store.get(recording.digest) for recording in made}
        export_archive(store, folder / "archive")
        with open_store(folder / "other.sqlite", durable=False) as other:
            fates = [outcome.fate for outcome in import_paths(other, [folder / "archive"], all_formats())]
            assert set(fates) == {Fate.NEW}
            for recording in made:
                found = other.get(recording.digest)
                assert content(found) == content(in_store[recording.digest])
                assert found.digest == recording.digest
                assert found.entries == recording.entries
                assert found.log == recording.log
            assert list(verify(other)) == []
    assert list(verify(store)) == []
