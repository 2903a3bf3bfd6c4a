"""Threads that commit at once share a transaction: one commits what all have brought, and the disk is waited for once.

It also keeps the threads of a process from waiting for each other in SQLite, which looks at ever longer intervals
whether the file is free, gives it to anyone, and gives up in the end.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from threading import Lock
from typing import Generic, TypeVar

from palpate.store.errors import StoreError, UnavailableError

__all__ = ["Together"]

MOST = 1000
"""Items of one transaction, unless one thread brings more."""
Item = TypeVar("Item")
Done = TypeVar("Done")


@dataclass(eq=False)
class Brought(Generic[Item, Done]):
    """What a thread has brought, and what became of it."""

    items: Sequence[Item]
    done: list[Done] | None = None
    error: StoreError | None = None


class Together(Generic[Item, Done]):
    """Commits what several threads bring in one transaction.

    Parameters
    ----------
    commit
        Commits items, all or none, and tells of each what became of it, in their order.

    Examples
    --------
    >>> together = Together(lambda items: [item + 1 for item in items])
    >>> together.commit([1, 2])
    [2, 3]
    """

    def __init__(self, commit: Callable[[Sequence[Item]], list[Done]]) -> None:
        self._commit = commit
        self._turn = Lock()
        self._guard = Lock()
        self._waiting: list[Brought[Item, Done]] = []

    def commit(self, items: Sequence[Item]) -> list[Done]:
        """Commit items, alone or with those of others; what is wrong with the others does not concern these."""
        mine: Brought[Item, Done] = Brought(items)
        with self._guard:
            self._waiting.append(mine)
        with self._turn:
            # unless the one before has done it already
            if mine.done is None and mine.error is None:
                self._commit_group(self._group(mine))
        if mine.error is not None:
            raise mine.error
        assert mine.done is not None
        return mine.done

    def _group(self, mine: Brought[Item, Done]) -> list[Brought[Item, Done]]:
        """Mine, and of those who wait as many as fit."""
        with self._guard:
            group, count = [mine], len(mine.items)
            for one in self._waiting:
                if one is not mine and count + len(one.items) <= MOST:
                    group.append(one)
                    count += len(one.items)
            self._waiting = [one for one in self._waiting if one not in group]
        return group

    def _commit_group(self, group: Sequence[Brought[Item, Done]]) -> None:
        try:
            done = iter(self._commit([item for one in group for item in one.items]))
        except StoreError as error:
            if len(group) == 1 or isinstance(error, UnavailableError):
                self._tell(group, error)
            else:
                # each of the others finds nothing done, and commits its own when its turn comes
                self._commit_group(group[:1])
            return
        for one in group:
            one.done = [next(done) for _ in one.items]

    def _tell(self, group: Sequence[Brought[Item, Done]], error: StoreError) -> None:
        for one in group:
            one.error = type(error)(str(error))
