"""Having an upload read: in a process of its own, a few at once."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
import threading

from palpate.server.problems import problem
from palpate.server.security.accounts import Account
from palpate.server.uploading.limits import LONGEST_S
from palpate.server.uploading.preview import OF_OTHERS, TASK, Preview
from palpate.store.importing.items import Fate
from palpate.store.store import Store
from palpate.store.units import units_of
from palpate.store.visible_episodes import recordings_of_digests

__all__ = ["read"]

_log = logging.getLogger("palpate.server")
AT_ONCE = threading.BoundedSemaphore(2)
PATIENCE_S = 60
# what a program needs to start, and nothing that is the server's: neither the address of the store nor its key
PASSED_ON = ("PATH", "PYTHONPATH", "LANG", "LC_ALL", "TZ", "HOME", "VIRTUAL_ENV", "LD_LIBRARY_PATH", "SYSTEMROOT")


def read(store: Store, who: Account, preview: Preview, refused: list[tuple[str, str]]) -> None:
    """Read what lies in a preview into a store of its own; `refused`: name and reason of what was not even saved."""
    scratch = preview.folder / "tmp"
    scratch.mkdir()
    before = [
        {"source": name, "fate": Fate.REFUSED.value, "reason": why, "digest": None, "episode": None}
        for name, why in refused
    ]
    task = {"account": who.name, "role": who.role.name, "units": dict(units_of(store)), "refused": before}
    (preview.folder / TASK).write_text(json.dumps(task), encoding="utf-8")
    environment = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    environment |= {"TMPDIR": str(scratch), "TEMP": str(scratch), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    if not AT_ONCE.acquire(timeout=PATIENCE_S):
        raise problem(503, "too many uploads are being read; try again in a minute", headers={"Retry-After": "60"})
    try:
        command = [sys.executable, "-m", "palpate.server.uploading.reader", str(preview.folder)]
        done = subprocess.run(command, env=environment, capture_output=True, timeout=2 * LONGEST_S, check=False)
        problems = "" if done.returncode == 0 else done.stderr.decode(errors="replace")[-2000:]
        code = done.returncode
    except subprocess.TimeoutExpired:
        code, problems = -1, "it took too long"
    finally:
        AT_ONCE.release()
    if code:
        _log.error("an upload could not be read, the process ended with %s: %s", code, problems)
        raise problem(
            422,
            f"what was sent takes more than {LONGEST_S} seconds or more memory than there is for it: send less at once",
        )
    of_others = [one["digest"] for one in preview.found() if OF_OTHERS in one]
    if of_others:
        preview.refuse_of_others(recordings_of_digests(store, who.viewer, of_others))
