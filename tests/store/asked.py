"""Which questions a store asks its database."""

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Engine, event

OF_TRANSACTIONS = ("BEGIN", "COMMIT", "ROLLBACK")


@contextmanager
def questions(engine: Engine) -> Iterator[list[str]]:
    """Those that are asked in the block; of what begins and ends transactions none."""
    asked = list[str]()

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        if not statement.startswith(OF_TRANSACTIONS):
            asked.append(statement)

    event.listen(engine, "before_cursor_execute", note)
    try:
        yield asked
    finally:
        event.remove(engine, "before_cursor_execute", note)
