"""What `docs/lab.md` tells to put on a server is read by the programs that it is for, where they are here."""

import re
import shlex
import shutil
import signal
import subprocess
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest
from typer.testing import CliRunner

from palpate.cli.app import app
from tests.server.serving import served

PAGE = Path("docs/lab.md").read_text(encoding="utf-8")


def block(kind: str, after: str) -> str:
    """The first block of a kind behind some words of the page."""
    found = re.search(rf"```{kind}\n(.*?)```", PAGE[PAGE.index(after) :], re.DOTALL)
    assert found is not None
    return found[1]


UNITS = {
    name: block("ini", f"/etc/systemd/system/{name}`")
    for name in ("palpate.service", "palpate-backup.service", "palpate-backup.timer")
}


def test_a_public_name_is_answered_and_others_are_not(tmp_path: Path) -> None:
    """Behind a proxy: by the name that it passes on, and by local ones; no key is printed; browsers insist on TLS."""
    with served(tmp_path / "store.sqlite", "--public", "https://touch.example.org:8443") as (address, process):
        for host in ("touch.example.org:8443", "127.0.0.1"):
            answered = urlopen(Request(address, headers={"Host": host}))
            assert answered.headers["Strict-Transport-Security"] is not None
        with pytest.raises(HTTPError, match="421"):
            urlopen(Request(address, headers={"Host": "elsewhere.example"}))
        with pytest.raises(HTTPError, match="401"):
            urlopen(f"{address}/metrics")
        process.send_signal(signal.SIGTERM)
        told, _ = process.communicate(timeout=30)
    assert "https://touch.example.org:8443/" in told
    assert "key" not in told


def test_the_service_starts_a_command_that_there_is() -> None:
    """Each option in the unit is one of the command's."""
    (line,) = re.findall(r"^ExecStart=/opt/palpate/bin/palpate (.*)$", UNITS["palpate.service"], re.MULTILINE)
    verb, *words = shlex.split(line)
    help_text = CliRunner().invoke(app, [verb, "--help"], env={"COLUMNS": "200"}).output
    options = [word for word in words if word.startswith("--")]
    assert len(options) == 4
    assert [option for option in options if option not in help_text] == []


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze, which is not installed")
def test_systemd_reads_the_units(tmp_path: Path) -> None:
    """No line of them is unknown to it; the programs need not be here."""
    for name, text in UNITS.items():
        (tmp_path / name).write_text(re.sub(r"^ExecStart=\S+", "ExecStart=/bin/true", text, flags=re.MULTILINE))
        command = ["systemd-analyze", "verify", "--man=no", "--recursive-errors=no", str(tmp_path / name)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        assert [line for line in done.stderr.splitlines() if name in line] == []
