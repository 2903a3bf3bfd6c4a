"""Run migrations on the connection that `palpate.store.database` hands over."""

from __future__ import annotations

from alembic import context

__all__ = ["run"]


def run() -> None:
    """Run the steps that were asked for, all in the transaction of the connection."""
    context.configure(connection=context.config.attributes["connection"])
    context.run_migrations()


# alembic gives this name to what it runs; the module may also be imported to be looked at
if __name__ == "env_py":
    run()
