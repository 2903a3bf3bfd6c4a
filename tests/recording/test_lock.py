import threading
from pathlib import Path

from palpate.recording.lock import Lock, locked


def test_one_of_many_holds_it(tmp_path: Path) -> None:
    """However many threads try, only one holds the lock at any time."""
    path, holders, most = tmp_path / "lock", list[int](), list[int]()

    def work() -> None:
        for _ in range(300):
            with locked(path) as taken:
                if taken:
                    holders.append(1)
                    most.append(len(holders))
                    holders.pop()

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(most) == {1}
    assert not path.exists()


def test_leaving_what_was_not_taken_is_nothing(tmp_path: Path) -> None:
    """A lock that was never taken can be left."""
    Lock(tmp_path / "lock").leave()
    assert not (tmp_path / "lock").exists()
