"""A browser for tests: where it is, its sizes, and how somebody logs in with it."""

import os
import shutil
from typing import Any

import pytest

CHROMIUM = os.environ.get("PALPATE_TEST_CHROMIUM") or shutil.which("chromium")
DESKTOP, PHONE = {"width": 1280, "height": 900}, {"width": 390, "height": 844}
PASSWORD = "correct horse battery"
IN_A_BROWSER = [
    pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed, and PALPATE_TEST_CHROMIUM not set"),
    # the event loop of playwright is closed by the process that it talks to
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]


def log_in(page: Any, name: str) -> None:
    """Enter the name and the password of an account, whatever page is there."""
    page.goto("/login")
    page.get_by_label("Name").fill(name)
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Log in").click()
    page.get_by_role("button", name="Log out").wait_for()


def minding(context: Any, site: str) -> tuple[Any, list[str]]:
    """A page, and the errors and the requests to other hosts that it has had."""
    found, faults = context.new_page(), list[str]()
    found.on("console", lambda message: faults.append(message.text) if message.type in ("error", "warning") else None)
    found.on("pageerror", lambda error: faults.append(str(error)))
    found.on("request", lambda asked: None if asked.url.startswith(site) else faults.append(asked.url))
    found.on("response", lambda answer: None if answer.status < 400 else faults.append(f"{answer.status} {answer.url}"))
    return found, faults
