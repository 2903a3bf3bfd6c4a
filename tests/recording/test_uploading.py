import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from uuid import uuid4

import pytest
from hypothesis import given, settings

from palpate.client import BackOff, NotAllowedError, RefusedError, UnreachableError
from palpate.recording.background import uploading
from palpate.recording.spool import Spool
from palpate.recording.uploading import Sent, upload
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.opening import open_store
from palpate.store.records import Receipt, Recording
from palpate.store.store import Store
from tests.store.importing.invented import recordings, squeeze

QUICK = BackOff(attempts=3, first_s=0.0)


class Stub:
    """A receiver that does what it is told, one thing for each call, and then keeps everything."""

    def __init__(self, *acts: Exception | Callable[[Recording], Receipt]) -> None:
        self.acts = list(acts)
        self.kept: dict[str, Recording] = {}
        self.calls = 0

    def put(self, recording: Recording) -> Receipt:
        self.calls += 1
        act = self.acts.pop(0) if self.acts else None
        if isinstance(act, Exception):
            raise act
        if act is not None:
            return act(recording)
        new = recording.digest not in self.kept
        self.kept[recording.digest] = recording
        return Receipt(recording.id, recording.digest, new)


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    spool = Spool(tmp_path / "spool", sync=False)
    for second in (1, 2):
        spool.add(squeeze(recorded_at=squeeze().recorded_at.replace(second=second)))
    return spool


@pytest.fixture(scope="module")
def places(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Spool, Store]]:
    folder = tmp_path_factory.mktemp("places")
    with open_store(folder / "store.sqlite", durable=False) as store:
        yield Spool(folder / "spool", sync=False), store


def states(sent: Sequence[Sent]) -> list[str]:
    return [one.state for one in sent]


def test_acknowledged_recordings_leave_the_spool(spool: Spool, tmp_path: Path) -> None:
    """A store gets everything, and what it has had before is no second recording."""
    kept = [spool.read(name) for name in spool.waiting()]
    digests = [recording.digest for recording in kept]
    with open_store(tmp_path / "store.sqlite") as store:
        store.put(kept[0])
        assert states(list(upload(spool, store))) == ["known", "sent"]
        assert [store.get(digest).digest for digest in digests] == digests
    assert spool.waiting() == []


@given(recording=recordings())
@settings(max_examples=25)
def test_any_recording_gets_from_the_spool_to_the_store(places: tuple[Spool, Store], recording: Recording) -> None:
    """Whatever a store keeps arrives there with the digest it was recorded with."""
    spool, store = places
    spool.add(recording)
    assert states(list(upload(spool, store))) in (["sent"], ["known"])
    assert store.get(recording.digest).digest == recording.digest


def test_an_unreachable_receiver_is_asked_again(spool: Spool) -> None:
    """After an outage everything arrives; the waits grow and are never longer than the longest."""
    waits: list[float] = []
    stub = Stub(UnreachableError("away"), UnreachableError("away"))
    back_off = BackOff(attempts=4, first_s=1.0, factor=3.0)
    assert states(list(upload(spool, stub, back_off=back_off, sleep=waits.append))) == ["sent", "sent"]
    assert len(waits) == 2
    assert 0.5 <= waits[0] <= 1.0
    assert 1.5 <= waits[1] <= 3.0


@pytest.mark.parametrize("error", [NotAllowedError("wrong token"), UnreachableError("away")])
def test_what_is_not_acknowledged_stays_queued(spool: Spool, error: Exception) -> None:
    """A wrong token and a receiver that stays away are errors, and everything waits on."""
    with pytest.raises(type(error)):
        list(upload(spool, Stub(error, error, error), back_off=QUICK))
    assert len(spool.waiting()) == 2


def test_a_wrong_token_is_not_tried_again(spool: Spool) -> None:
    """A wrong token is asked about once."""
    stub = Stub(NotAllowedError("wrong token"))
    with pytest.raises(NotAllowedError):
        list(upload(spool, stub, back_off=QUICK))
    assert stub.calls == 1


def test_what_is_refused_is_set_aside(spool: Spool) -> None:
    """A refused recording does not stop the others, keeps its reason, and can be queued again."""
    name = spool.waiting()[0]
    assert states(list(upload(spool, Stub(RefusedError("no such owner"))))) == ["refused", "sent"]
    assert spool.refused() == {name: "no such owner"}
    spool.requeue(name)
    assert states(list(upload(spool, Stub()))) == ["sent"]


def test_a_busy_store_is_asked_again_and_then_left(spool: Spool) -> None:
    """A store that could not keep a recording now does not make it refused."""
    busy = [UnavailableError("database is locked")] * 3
    assert states(list(upload(spool, Stub(*busy), back_off=QUICK))) == ["waiting", "sent"]
    assert len(spool.waiting()) == 1


def test_what_a_store_refuses_for_good_is_set_aside(spool: Spool) -> None:
    """A store says no once and for all as a server does: it is not asked again, and the reason is kept."""
    name = spool.waiting()[0]
    stub = Stub(StoreError("entries[0].unit: unit 'g' is mass; expected length"))
    assert states(list(upload(spool, stub, back_off=QUICK))) == ["refused", "sent"]
    assert spool.refused() == {name: "entries[0].unit: unit 'g' is mass; expected length"}
    assert stub.calls == 2


def test_a_damaged_store_refuses_nothing(spool: Spool) -> None:
    """What is wrong with the store's own file is not the recording's fault: it waits on."""
    assert states(list(upload(spool, Stub(DamagedError("malformed")), back_off=QUICK))) == ["waiting", "sent"]
    assert spool.refused() == {}


def test_a_receipt_for_another_recording_is_none(spool: Spool) -> None:
    """Status comes from the receiver's answer: one about another recording acknowledges nothing."""
    assert states(list(upload(spool, Stub(lambda _: Receipt(uuid4(), "f" * 64, new=True))))) == ["waiting", "sent"]
    assert len(spool.waiting()) == 1


def test_a_damaged_recording_is_set_aside(spool: Spool) -> None:
    """What the disk has damaged is never sent."""
    name = spool.waiting()[0]
    (spool.folder / "waiting" / name / "0001.npy").write_bytes(b"")
    stub = Stub()
    assert states(list(upload(spool, stub))) == ["refused", "sent"]
    assert "0001.npy" in spool.refused()[name]


def test_two_senders_send_each_once(spool: Spool) -> None:
    """While one sends a recording, another leaves it alone."""
    inside, go_on = threading.Event(), threading.Event()

    def slow(recording: Recording) -> Receipt:
        inside.set()
        go_on.wait(10)
        return Receipt(recording.id, recording.digest, new=True)

    first, second = Stub(slow), Stub()
    thread = threading.Thread(target=lambda: list(upload(spool, first)))
    thread.start()
    inside.wait(10)
    assert states(list(upload(spool, second))) == ["sent"]
    go_on.set()
    thread.join()
    assert (first.calls, second.calls) == (1, 1)
    assert spool.waiting() == []


def wait_for(holds: Callable[[], bool]) -> None:
    end = time.monotonic() + 10
    while not holds():
        assert time.monotonic() < end, "it never came"
        time.sleep(0.005)


def test_the_background_sends_what_comes(spool: Spool) -> None:
    """Recordings are sent while the program goes on, after an outage too."""
    stub = Stub(UnreachableError("away"))
    with uploading(spool, stub, every_s=0.01, back_off=QUICK) as uploader:
        wait_for(lambda: not spool.waiting())
        spool.add(squeeze(action="weighing"))
        wait_for(lambda: not spool.waiting())
        wait_for(lambda: uploader.error is None)
    assert len(stub.kept) == 3


def test_the_background_tells_of_a_wrong_token(spool: Spool) -> None:
    """A wrong token is an error when the block ends, and everything waits on."""
    stub = Stub(*[NotAllowedError("wrong token")] * 9)
    with pytest.raises(NotAllowedError), uploading(spool, stub, every_s=0.01) as uploader:
        wait_for(lambda: uploader.error is not None)
    assert stub.calls == 1
    assert len(spool.waiting()) == 2


@pytest.mark.parametrize("error", [RuntimeError("a bug"), PermissionError("not yours"), UnavailableError("locked")])
def test_one_recording_that_fails_keeps_no_other_from_going(spool: Spool, error: Exception) -> None:
    """Whatever one recording raises, the others are sent, what is wrong is told, and it is tried again later."""
    first = spool.waiting()[0]
    failing = True

    class Picky(Stub):
        def put(self, recording: Recording) -> Receipt:
            if failing and recording.recorded_at == oldest.recorded_at:
                raise error
            return super().put(recording)

    oldest, stub = spool.read(first), Picky()
    with uploading(spool, stub, every_s=0.01, back_off=QUICK) as uploader:
        wait_for(lambda: spool.waiting() == [first] and uploader.error is not None)
        assert str(error) in str(uploader.error)
        spool.add(squeeze(action="weighing"))
        wait_for(lambda: spool.waiting() == [first])
        failing = False
        wait_for(lambda: not spool.waiting() and uploader.error is None)
    assert len(stub.kept) == 3


def test_one_recording_that_fails_is_tried_less_and_less_often(spool: Spool) -> None:
    """What fails again and again has longer and longer waits of its own; what is new does not wait with it."""
    stub = Stub(RuntimeError("a bug"))
    with uploading(spool, stub, every_s=0.01, back_off=BackOff(first_s=60.0)) as uploader:
        wait_for(lambda: len(spool.waiting()) == 1)
        spool.add(squeeze(action="weighing"))
        wait_for(lambda: len(stub.kept) == 2)
        assert str(uploader.error) == "a bug"
    assert stub.calls == 3


def test_a_server_may_be_away_for_days(spool: Spool) -> None:
    """However often it did not answer, the wait is the longest one, and what waits is sent once it does."""
    patient = BackOff()
    assert all(150.0 <= patient.wait_s(failures) <= 300.0 for failures in (12, 1025, 10**6))
    stub, steep = Stub(*[UnreachableError("away")] * 5), BackOff(factor=1e200, longest_s=0.01)
    with uploading(spool, stub, back_off=steep, every_s=0.01) as uploader:
        wait_for(lambda: not spool.waiting() and uploader.error is None)


def test_a_spool_that_cannot_be_listed_does_not_end_the_thread(spool: Spool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The thread goes on after any error of a whole pass."""
    listed, broken = spool.waiting, [ValueError("a bug"), OSError("unplugged")]

    def waiting() -> list[str]:
        if broken:
            raise broken.pop(0)
        return listed()

    monkeypatch.setattr(spool, "waiting", waiting)
    with uploading(spool, Stub(), every_s=0.01, back_off=QUICK):
        wait_for(lambda: not broken and not listed())
