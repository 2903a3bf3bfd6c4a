"""Programs that are killed again and again, at instants that are as random as they repeat."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

KILLS = int(os.environ.get("PALPATE_TEST_KILLS", "10"))
"""How often each program is killed."""

PROGRAM = """
import os, random, signal, sys, time
{imports}

def work(attempt, {names}):
{work}

def size(path):
    return os.path.getsize(path) if path and os.path.exists(path) else 0

chance = random.Random({seed})
for attempt in range({kills}):
    child = os.fork()
    if not child:
        work(attempt, *sys.argv[1:])
        os._exit(0)
    # half of them while the program begins, half of them later
    end, before = time.monotonic() + 30.0 * bool({progress!r} and attempt % 2), size({progress!r})
    while size({progress!r}) == before and time.monotonic() < end:
        time.sleep(0.001)
    time.sleep(chance.uniform(0.0, {longest_s}))
    os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if os.WIFEXITED(status) and os.WEXITSTATUS(status):
        sys.exit("the program failed before it was killed")
"""

needs_sigkill = pytest.mark.skipif(sys.platform == "win32", reason="Windows has neither fork nor SIGKILL")


def kill_again_and_again(
    imports: str,
    work: str,
    arguments: dict[str, str | Path],
    *,
    longest_s: float,
    progress: Path | None = None,
) -> None:
    """Run lines of Python in a process of their own, kill it, and begin again.

    Parameters
    ----------
    imports
        Run once, before all attempts, as they take longer than what is to be killed.
    work
        Lines that know the number of the attempt, and the arguments by name as texts.
    longest_s
        Each attempt is killed within this time.
    progress
        A file that grows once the program is at its work: every other time is counted from then.
    """
    lines = "\n".join("    " + line for line in work.strip().splitlines())
    names = ", ".join(arguments)
    told = None if progress is None else str(progress)
    program = PROGRAM.format(
        imports=imports, names=names, work=lines, seed=11, kills=KILLS, longest_s=longest_s, progress=told
    )
    command = [sys.executable, "-c", program, *map(str, arguments.values())]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=Path(__file__).parents[1])
