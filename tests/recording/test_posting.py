"""Sending an exploration while it runs: in order, each line once, and never in the way of who explores."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from uuid import UUID

import pytest

from palpate.client import BackOff, NotAllowedError, RefusedError, UnreachableError
from palpate.recording.errors import RecordingError
from palpate.recording.outbox import Outbox
from palpate.recording.posting import Poster
from palpate.recording.spool import Spool
from palpate.store.episodes import StoredEpisode, StoredStep
from palpate.store.errors import DamagedError
from palpate.store.records import Receipt, Recording
from tests.store.made_up import made_episode, squeeze

QUICK = BackOff(first_s=0.01, longest_s=0.02)


@dataclass
class Server:
    """Takes what comes, in the order in which it comes; `before` may fail or hang."""

    before: Callable[[], None] = lambda: None
    came: list[object] = field(default_factory=list)

    def put(self, recording: Recording) -> Receipt:
        self.before()
        self.came.append(recording.digest)
        return Receipt(recording.id, recording.digest, new=True)

    def begin_episode(self, episode: StoredEpisode) -> int:
        self.before()
        self.came.append(episode.id)
        return 0

    def put_line(self, episode: UUID, position: int, step: StoredStep) -> int:
        self.before()
        self.came.append(position)
        return position


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    return Spool(tmp_path / "spool", sync=False)


def line(number: int, recording: str | None = None) -> StoredStep:
    return StoredStep({"step": number, "action": "weighing"}, recording)


END = StoredStep({"stop": "enough"})


def test_recordings_come_before_their_line(spool: Spool) -> None:
    """All of it arrives, in order; then neither recordings nor lines are left here."""
    server, episode, recording = Server(), made_episode(), squeeze()
    poster = Poster(spool, server, episode)
    poster.add(line(1, recording.digest), [spool.add(recording)])
    poster.add(END)
    assert poster.close(20.0) is None
    assert server.came == [episode.id, recording.digest, 1, 2]
    assert (spool.waiting(), Outbox(spool).waiting()) == ([], [])


def test_a_server_that_is_away_for_a_while_gets_all(spool: Spool) -> None:
    """It is asked again, and nothing is sent twice that was answered."""
    failures = iter([True, False, True, True, False] + [False] * 9)

    def away() -> None:
        if next(failures):
            raise UnreachableError("nobody there")

    server, episode = Server(away), made_episode()
    poster = Poster(spool, server, episode, back_off=QUICK)
    for number in (1, 2):
        poster.add(line(number))
    assert poster.close(20.0) is None
    assert server.came == [episode.id, 1, 2]


def test_who_explores_waits_for_no_server(spool: Spool) -> None:
    """With a server that never answers, a hundred steps take about as long as with one that answers at once."""
    hung = threading.Event()

    def seconds(server: Server) -> float:
        poster = Poster(spool, server, made_episode(number=len(server.came)), back_off=QUICK)
        began = time.perf_counter()
        for number in range(1, 101):
            poster.add(line(number))
        took = time.perf_counter() - began
        closing = time.perf_counter()
        left = poster.close(0.2)
        assert time.perf_counter() - closing < 2.0
        assert (left is None) == (server.before is not hung_wait)
        return took

    def hung_wait() -> None:
        hung.wait(20.0)

    quick, hanging = seconds(Server()), seconds(Server(hung_wait))
    hung.set()
    # whoever waited even once would take 20 s
    assert hanging < 10 * quick + 1.0


@pytest.mark.parametrize("error", [NotAllowedError("no token"), RefusedError("no such line")])
def test_a_server_that_refuses_is_not_asked_again(spool: Spool, error: Exception) -> None:
    """What is left is told with the reason, and is here as it was, to be sent later."""
    asked = []

    def refuse() -> None:
        asked.append(1)
        raise error

    episode = made_episode()
    poster = Poster(spool, Server(refuse), episode, back_off=QUICK)
    poster.add(line(1))
    poster.add(END)
    left = poster.close(20.0)
    assert left is not None
    assert (left.lines, left.reason, len(asked)) == (2, str(error), 1)
    outbox = Outbox(spool)
    assert outbox.waiting() == [str(episode.id)]
    with outbox.claimed(str(episode.id)) as is_mine:
        assert is_mine
    expected = episode.continued(line(1).record).continued(END.record)
    assert outbox.read(str(episode.id)).digest == expected.digest


def test_nobody_else_sends_what_is_being_written(spool: Spool) -> None:
    """While it runs it is claimed; a second one under its id is refused."""
    episode, outbox = made_episode(), Outbox(spool)
    outgoing = outbox.begin(episode)
    with outbox.claimed(str(episode.id)) as is_mine:
        assert not is_mine
    with pytest.raises(RecordingError, match="is being sent already"):
        outbox.begin(episode)
    outgoing.leave(is_sent=True)
    assert outbox.waiting() == []


def test_a_line_that_a_kill_has_cut_off_is_left_out(spool: Spool) -> None:
    """All in front of it is there; a file that tells nothing is an error that names it."""
    episode, outbox = made_episode(), Outbox(spool)
    outgoing = outbox.begin(episode)
    outgoing.add(line(1))
    whole = outgoing.path.read_bytes()
    for cut in range(1, 30):
        outgoing.path.write_bytes(whole[:-cut])
        assert outbox.read(str(episode.id)).steps == ()
    outgoing.path.write_bytes(whole)
    assert outbox.read(str(episode.id)).digest == episode.continued(line(1).record).digest
    for odd in (b"", b"{}\n", b"[1]\n", b"\xff\n"):
        outgoing.path.write_bytes(odd)
        with pytest.raises(DamagedError, match=str(episode.id)):
            outbox.read(str(episode.id))
