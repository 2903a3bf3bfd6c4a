"""The command line: one thin command per verb; strings become objects here and nowhere else."""

from __future__ import annotations

import sys

__all__ = ["main"]

INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and exit: 0 when done, 2 on bad input, 130 when interrupted.

    Parameters
    ----------
    arguments
        What follows the program's name; the process's own where it is None.
    """
    try:
        code = _run(arguments)
    except KeyboardInterrupt:
        code = INTERRUPTED
    if code == INTERRUPTED:
        print("palpate: interrupted", file=sys.stderr)
    sys.exit(code)


def _run(arguments: list[str] | None) -> int:
    from typer import TyperException

    from palpate.cli.app import app
    from palpate.errors import PalpateError

    try:
        return app(arguments, prog_name="palpate", standalone_mode=False) or 0
    except TyperException as error:
        # an error of usage knows the command it is about
        context = getattr(error, "ctx", None)
        command = context.command_path if context else "palpate"
        return _refuse(f"{error.format_message().rstrip('.')} (see '{command} --help')")
    except PalpateError as error:
        return _refuse(str(error))
    except OSError as error:
        # only what is printed goes to a file without a name
        return _refuse(f"{error.filename or 'standard output'}: {error.strerror}")


def _refuse(reason: str) -> int:
    """Say in one line what is wrong with the input."""
    # a name that was typed or read may hold line breaks
    from palpate.invisible import shown

    print("palpate:", shown(" ".join(reason.split())), file=sys.stderr)
    return 2
