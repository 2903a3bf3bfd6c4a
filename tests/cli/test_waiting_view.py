import io
from typing import Any

import pytest
from rich.console import Console

from palpate.cli import waiting_view
from palpate.cli.waiting_view import Waiting


def shown(waiting: Waiting) -> str:
    screen = Console(file=io.StringIO(), width=80, force_terminal=True)
    with screen.capture() as captured:
        screen.print(waiting)
    return captured.get()


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Any:
    now = [100.0]
    monkeypatch.setattr(waiting_view, "monotonic", lambda: now[0])
    return now


def test_a_quick_choice_shows_nothing(clock: Any) -> None:
    """Within two seconds nothing is shown, and again after each choice."""
    waiting = Waiting()
    clock[0] += 1.9
    assert shown(waiting).strip() == ""
    clock[0] += 5
    assert "Choosing the next action ..." in shown(waiting)
    waiting.restart()
    assert shown(waiting).strip() == ""


def test_a_long_choice_shows_how_far_it_is(clock: Any) -> None:
    """After two seconds it says how many actions have been looked at."""
    waiting = Waiting()
    waiting.told(2, 5)
    clock[0] += 2.1
    assert "2 of 5 looked at" in shown(waiting)
