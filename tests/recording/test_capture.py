import asyncio
import contextvars
import io
import logging
import sys
import threading
from contextlib import redirect_stdout, suppress

import pytest

from palpate.recording.capture import hearing

log = logging.getLogger("tests.capture")


class Unprintable:
    def __str__(self) -> str:
        raise RuntimeError("no words")


def test_output_is_heard_and_still_printed(capsys: pytest.CaptureFixture[str]) -> None:
    """What is printed and logged is heard in its order, and is printed as without a listener."""
    heard: list[str] = []
    with hearing(heard.append):
        sys.stdout.write("one\n")
        log.warning("two %d", 2)
        sys.stdout.writelines(["three\n"])
    assert capsys.readouterr().out == "one\nthree\n"
    lines = "".join(heard).splitlines()
    assert [line.rpartition(": ")[2] for line in lines] == ["one", "two 2", "three"]
    assert "WARNING tests.capture" in lines[1]


def test_everything_is_put_back(capsys: pytest.CaptureFixture[str]) -> None:
    """Standard output and the factory of log records are what they were, also after an exception."""
    before = sys.stdout, logging.getLogRecordFactory(), list(logging.getLogger().handlers)
    with suppress(KeyError), hearing(lambda _: None):
        assert sys.stdout is not before[0]
        raise KeyError("x")
    assert (sys.stdout, logging.getLogRecordFactory(), list(logging.getLogger().handlers)) == before


def test_a_redirection_inside_is_kept() -> None:
    """Output that was redirected inside goes where it was sent, and standard output is put back all the same."""
    before, target, heard = sys.stdout, io.StringIO(), list[str]()
    with hearing(heard.append):
        with redirect_stdout(target), hearing(heard.append):
            sys.stdout.write("inside\n")
        sys.stdout.write("after\n")
    assert sys.stdout is before
    assert target.getvalue() == "inside\n"
    assert "".join(heard).count("after") == 1


def test_an_outer_listener_hears_the_inner_one() -> None:
    """Nested: the inner hears its own part, the outer one all."""
    outer, inner = list[str](), list[str]()
    with hearing(outer.append):
        sys.stdout.write("a\n")
        with hearing(inner.append):
            sys.stdout.write("b\n")
        sys.stdout.write("c\n")
    assert "".join(inner) == "b\n"
    assert "".join(outer) == "a\nb\nc\n"


def test_threads_hear_only_themselves() -> None:
    """Eight threads that print at the same time hear their own lines and no others."""
    heard: dict[int, list[str]] = {number: [] for number in range(8)}
    start = threading.Barrier(8)

    def work(number: int) -> None:
        start.wait()
        with hearing(heard[number].append):
            for _ in range(200):
                sys.stdout.write(f"from {number}\n")

    threads = [threading.Thread(target=work, args=(number,)) for number in heard]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all("".join(lines) == f"from {number}\n" * 200 for number, lines in heard.items())


def test_a_thread_in_a_copied_context_is_heard() -> None:
    """A thread that runs in a copy of the context belongs to the listener."""
    heard: list[str] = []
    with hearing(heard.append):
        thread = threading.Thread(target=contextvars.copy_context().run, args=(print, "helper"))
        thread.start()
        thread.join()
    assert "".join(heard) == "helper\n"


def test_tasks_hear_only_themselves() -> None:
    """Tasks that take turns hear their own lines and no others."""

    async def work(name: str) -> str:
        heard: list[str] = []
        with hearing(heard.append):
            for _ in range(5):
                sys.stdout.write(name + "\n")
                await asyncio.sleep(0)
        return "".join(heard)

    async def both() -> list[str]:
        return list(await asyncio.gather(work("a"), work("b")))

    assert asyncio.run(both()) == ["a\n" * 5, "b\n" * 5]


def test_logging_behaves_as_without_a_listener(capsys: pytest.CaptureFixture[str]) -> None:
    """A call with wrong arguments does not raise, and no handler was added that would change `basicConfig`."""
    heard: list[str] = []
    quiet = logging.getLogger("tests.capture.quiet")
    quiet.propagate = False
    quiet.addHandler(logging.NullHandler())
    with hearing(heard.append):
        quiet.warning("%d apples", "no")
        quiet.warning("%s", Unprintable())
        quiet.debug("not enabled")
    assert len(heard) == 2
    assert "%d apples" in heard[0]
