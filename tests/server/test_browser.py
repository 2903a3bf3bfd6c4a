"""The pages in a real browser: what people do, without an error on the console or a request to another host."""

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import pytest

from palpate.server.example import add_example
from palpate.server.security.accounts import Role, add_user, users
from palpate.server.security.logging_in import set_password
from palpate.server.security.tokens import issue
from palpate.store.blobs import FolderBlobs
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from palpate.store.pictures import png
from palpate.store.records import Channel, FileItem, Series, ThingRef
from palpate.store.store import Store
from tests.server.browsing import DESKTOP, IN_A_BROWSER, PASSWORD, PHONE, log_in, minding
from tests.server.packages import package
from tests.server.serving import served
from tests.store.made_up import squeeze
from tests.store.places import check_services, emptied

expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect
pytestmark = IN_A_BROWSER
LOADED = (
    "async player => { player.preload = 'auto'; player.load();"
    " await new Promise(done => player.addEventListener('loadedmetadata', done)); return player.duration; }"
)
"""How long a sound is that a player has loaded."""


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def place(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    """Where a store and its blobs are."""
    check_services(request.param)
    folder = tmp_path_factory.mktemp("site")
    where = str(emptied() if request.param == "postgresql" else folder / "store.sqlite")
    return where, str(folder / "blobs")


@pytest.fixture(scope="module")
def site(place: tuple[str, str]) -> Iterator[str]:
    """A server with example data, and with a recording that has a sound and a picture."""
    with Store(open_store(*place, durable=False).engine, FolderBlobs(Path(place[1]))) as store:
        add_example(store, count=60)
        tone = Channel("sound", "sound pressure", None, np.sin(np.arange(16_000) / 5), rate_hz=8000.0)
        store.put(
            squeeze(
                visibility="public",
                thing=ThingRef("lab", "bell"),
                action="knocking",
                series=(Series("microphone", (tone,)),),
                files=(
                    FileItem("front.png", "image/png", png(np.full((40, 60, 3), 99, np.uint8), "front")),
                    FileItem("note.html", "text/html", b"<script>document.title = 'evil'</script>"),
                ),
            )
        )
    with served(place[0], "--blobs", place[1]) as (address, _):
        yield address


@pytest.fixture(params=["desktop", "phone"])
def page(request: pytest.FixtureRequest, browser: Any, site: str) -> Iterator[Any]:
    """A page that minds errors, requests to other hosts, and what does not fit on the screen."""
    size = {"desktop": DESKTOP, "phone": PHONE}[request.param]
    context = browser.new_context(base_url=site, viewport=size, color_scheme="dark")
    found, faults = minding(context, site)
    found.on("domcontentloaded", lambda _: _fits(found, faults))
    yield found
    assert not faults
    context.close()


def _fits(page: Any, faults: list[str]) -> None:
    if page.evaluate("document.documentElement.scrollWidth > document.documentElement.clientWidth"):
        faults.append(f"{page.url} is wider than the screen")


def test_browse_search_and_open_a_recording(page: Any) -> None:
    """From the first page to an object by a search, and from a point of its plot to the recording behind it."""
    page.goto("/")
    page.get_by_role("searchbox").fill("banana_ycb")
    page.get_by_role("button", name="Search").click()
    page.wait_for_url("**/objects?*")
    page.get_by_role("link", name="banana ycb").first.click()
    page.wait_for_url("**/objects/simulated/banana_ycb")
    expect(page.locator("svg.plot circle.dot").nth(2)).to_be_attached()
    # the first device drew its outcomes and has no signals
    page.locator("svg.plot a[href^='/recordings/']").last.dispatch_event("click")
    page.wait_for_url("**/recordings/*")
    expect(page.locator("svg.plot polyline").first).to_be_attached()


def test_filters_leave_no_empty_fields_in_the_address(page: Any) -> None:
    """An address that one may send to somebody has only what was asked."""
    page.goto("/recordings")
    page.get_by_role("combobox", name="Action", exact=True).select_option("weighing")
    page.get_by_role("button", name="Search").click()
    page.wait_for_url("**/recordings?action=weighing&sort=recorded")
    assert set(page.locator("tbody td:nth-child(3)").all_inner_texts()) == {"weighing"}
    page.go_back()
    expect(page.get_by_label("Object", exact=True)).to_be_enabled()


def test_a_sound_plays_and_pictures_show(page: Any) -> None:
    """The sound of a knock runs in the player, and its spectrogram and the picture have pixels."""
    page.goto("/objects/lab/bell")
    page.locator("table.rows td.date a").first.click()
    page.wait_for_url("**/recordings/*")
    assert page.locator("audio").first.evaluate(LOADED) == pytest.approx(2.0, abs=0.05)
    for picture in page.locator("main img").all():
        picture.scroll_into_view_if_needed()
        picture.evaluate("one => one.decode()")
        assert picture.evaluate("one => one.naturalWidth") > 10
    with page.expect_download() as download:
        page.get_by_role("link", name="note.html").click()
    assert download.value.suggested_filename == "note.html"
    assert page.title() != "evil"


def test_zoom_a_plot(page: Any) -> None:
    """A picture becomes a figure: dragging zooms, reset takes it back, it is saved as PNG, and the picture returns."""
    page.goto("/objects/simulated/banana_ycb")
    frame = page.locator("figure.plotted").first
    words = frame.locator("svg.plot").get_attribute("aria-label")
    frame.get_by_role("button", name="Zoom").click()
    figure = frame.get_by_role("group", name=words)
    figure.locator("canvas").first.wait_for()
    expect(frame.locator("svg.plot")).to_be_hidden()
    ends = "() => { const { start, end } = Bokeh.documents.at(-1).roots()[0].x_range; return [start, end]; }"
    before, box = page.evaluate(ends), figure.locator(".bk-events").bounding_box()
    x, y = box["x"] + box["width"] * 0.6, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 20, y + 10, steps=3)
    page.mouse.move(x + 60, y + 20, steps=3)
    page.mouse.up()
    page.wait_for_function(
        f"([low, high]) => {{ const now = ({ends})(); return now[0] > low && now[1] < high; }}", arg=before
    )
    figure.get_by_title("Reset").click()
    page.wait_for_function(
        f"([low, high]) => {{ const now = ({ends})(); return now[0] === low && now[1] === high; }}", arg=before
    )
    with page.expect_download() as download:
        figure.get_by_title("Save as PNG").click()
    assert Path(download.value.path()).read_bytes()[:4] == b"\x89PNG"
    page.emulate_media(media="print")
    expect(frame.locator("svg.plot")).to_be_visible()
    page.emulate_media(media="screen")
    frame.get_by_role("button", name="Picture").click()
    expect(frame.locator("svg.plot")).to_be_visible()


def test_step_through_an_exploration(page: Any) -> None:
    """Each step shows its choice; from it one gets to the recording of its action."""
    page.goto("/episodes")
    page.locator("td.date a").first.click()
    page.get_by_role("navigation", name="Steps").get_by_role("link").first.click()
    page.wait_for_url("**?step=1")
    expect(page.locator("li.chosen")).to_have_count(1)
    page.get_by_role("link", name="its signals").click()
    page.wait_for_url("**/recordings/*")


def log_in_as_curator(page: Any, place: tuple[str, str]) -> None:
    """With an account that is made where there is none."""
    with Store(open_store(place[0], place[1], durable=False).engine, FolderBlobs(Path(place[1]))) as store:
        if "carl" not in {user.name for user in users(store)}:
            add_user(store, "carl", Role.CURATOR)
            set_password(store, "carl", PASSWORD)
    log_in(page, "carl")


def test_log_in_and_correct_an_object(page: Any, place: tuple[str, str]) -> None:
    """A curator logs in, renames an object, merges it with another one, splits it, and takes the name back."""
    log_in_as_curator(page, place)
    page.goto("/objects/lab/bell")
    page.get_by_role("link", name="Change what is said of it").click()
    page.get_by_label("Common name").fill("brass bell")
    page.get_by_role("button", name="Save the description").click()
    page.get_by_role("heading", name="brass bell", exact=True).wait_for()
    page.goto("/objects/lab/bell/edit")
    page.get_by_label("Data set and name").fill("ycb/011_banana")
    page.get_by_role("button", name="Let it count as that one").click()
    page.get_by_text("It counts as").wait_for()
    page.goto("/objects/lab/bell/edit")
    page.get_by_role("button", name="Split it off again").click()
    # the page with the form has the name in its heading too
    page.get_by_role("heading", name="brass bell", exact=True).wait_for()
    page.goto("/objects/lab/bell/edit")
    page.get_by_role("button", name="Take back").click()
    page.get_by_role("heading", name="bell", exact=True).wait_for()
    page.get_by_role("button", name="Log out").click()
    page.get_by_role("link", name="Log in").click()
    page.wait_for_url("**/login")


@pytest.mark.parametrize("page", ["desktop"], indirect=True)
def test_upload_a_file_look_at_it_and_keep_it(page: Any, place: tuple[str, str]) -> None:
    """Files are chosen and dropped, looked at before they are sent, shown as they look and sound, and kept."""
    log_in_as_curator(page, place)
    page.get_by_role("link", name="Upload", exact=True).click()
    tone = Channel("sound", "sound pressure", None, np.sin(np.arange(16_000) / 5), rate_hz=8000.0)
    looks = FileItem("front.png", "image/png", png(np.full((40, 60, 3), 99, np.uint8), "front"))
    more = {"series": (*squeeze(77).series, Series("microphone", (tone,))), "files": (looks,)}
    sent = package(squeeze(77, thing=ThingRef("lab", "wet sponge"), visibility="lab", **more))
    page.get_by_label("Choose files").set_input_files(
        [
            {"name": "sponge.zip", "mimeType": "application/zip", "buffer": sent},
            {"name": "broken.json", "mimeType": "application/json", "buffer": b"{"},
        ]
    )
    page.get_by_text("broken.json, 1 byte: is no JSON").wait_for()
    page.get_by_role("button", name="Remove broken.json").click()
    page.evaluate(
        "() => { const held = new DataTransfer(); held.items.add(new File(['hello'], 'hello.txt'));"
        " const drop = new DragEvent('drop', {dataTransfer: held, bubbles: true});"
        " document.querySelector('form.drop').dispatchEvent(drop) }"
    )
    page.get_by_text("hello.txt, 5 bytes").wait_for()
    expect(page.locator("ul.chosen li")).to_have_count(2)
    page.get_by_role("button", name="Show what is in them").click()
    page.get_by_role("heading", name="Squeezing of wet sponge").wait_for(timeout=60_000)
    expect(page.locator("svg.plot").first).to_be_attached()
    assert page.locator("audio").evaluate(LOADED) == pytest.approx(2.0, abs=0.05)
    page.get_by_alt_text("front.png").evaluate("one => one.decode()")
    assert page.get_by_alt_text("front.png").evaluate("one => one.naturalWidth") == 60
    page.get_by_text("hello.txt is left out").wait_for()
    page.get_by_label("Who may see").select_option("public")
    page.get_by_role("button", name="Keep").click()
    page.get_by_role("link", name="Squeezing of wet sponge").click()
    page.wait_for_url("**/recordings/*")
    page.get_by_role("heading", name="Squeezing of wet sponge").wait_for()


def test_watch_an_exploration_that_another_process_makes(page: Any, place: tuple[str, str]) -> None:
    """The page follows it step by step without being loaded again, and says in the end why it stopped."""
    with Store(open_store(place[0], place[1], durable=False).engine, FolderBlobs(Path(place[1]))) as store:
        shown = get_episode(store, list_episodes(store, limit=1).rows[0].id)
        grown = replace(shown, steps=(), id=uuid4(), started_at=datetime.now(UTC))
        put_episode(store, grown)
        page.goto(f"/episodes/{grown.id}")
        page.get_by_text("No step was taken yet").wait_for()
        page.evaluate("window.same = true")
        for number, step in enumerate(shown.steps[:-1], 1):
            grown = grown.continued(step.record, step.recording)
            put_episode(store, grown)
            page.get_by_role("heading", name=f"Step {number}: which action?").wait_for(timeout=5000)
        put_episode(store, grown.continued(shown.steps[-1].record))
        page.get_by_role("log").get_by_text("It ended because").wait_for(timeout=5000)
        assert page.evaluate("window.same")


@pytest.mark.parametrize("page", ["desktop"], indirect=True)
def test_an_earlier_step_stays_while_the_rest_of_its_page_goes_on(page: Any, place: tuple[str, str]) -> None:
    """What is told of all steps is told once, and is true; what the step shows is left alone."""
    with Store(open_store(place[0], place[1], durable=False).engine, FolderBlobs(Path(place[1]))) as store:
        shown = get_episode(store, list_episodes(store, limit=1).rows[0].id)
        grown = replace(shown, steps=shown.steps[:1], id=uuid4(), started_at=datetime.now(UTC))
        put_episode(store, grown)
        page.goto(f"/episodes/{grown.id}?step=1")
        page.locator(".beliefs").evaluate("one => { one.same = true }")
        steps, state = page.get_by_role("navigation", name="Steps").get_by_role("link"), page.locator(".live")
        expect(steps).to_have_count(1)
        expect(state).to_contain_text(["It goes on; the last word came at", ""])
        put_episode(store, grown := grown.continued(shown.steps[1].record))
        expect(steps).to_have_count(2)
        expect(page.get_by_role("log").locator("li")).to_have_count(2)
        expect(page.get_by_role("link", name="Step after")).to_be_attached()
        assert "steps by now" not in page.inner_text("main")
        put_episode(store, grown.continued(shown.steps[-1].record))
        expect(state).to_have_text([f"It ended because {shown.stop}."])
        expect(page.get_by_role("link", name="Follow the newest step")).to_have_count(0)
        page.get_by_role("heading", name="Step 1: which action?").wait_for()
        assert page.locator(".beliefs").evaluate("one => one.same")


SLOW = """
import time
from palpate.cli import main
from palpate.robots.sampled import SampledRobot
perform = SampledRobot.perform
SampledRobot.perform = lambda robot, action: (time.sleep(1.5), perform(robot, action))[1]
main()
"""


def test_watch_what_palpate_explore_sends_over_the_network(
    browser: Any, site: str, place: tuple[str, str], tmp_path: Path
) -> None:
    """Two watch an exploration of another process; one loses the network in the middle, and catches up."""
    with Store(open_store(place[0], place[1], durable=False).engine, FolderBlobs(Path(place[1]))) as store:
        add_user(store, "robot", Role.OWNER)
        set_password(store, "robot", PASSWORD)
        token = issue(store, "robot")
    watchers = []
    for _ in range(2):
        page, faults = minding(browser.new_context(base_url=site), site)
        log_in(page, "robot")
        watchers.append((page, faults))
    (first, faults), (second, _) = watchers
    asked = ("explore", "ceramic_mug", "--seed", "5", "--steps", "4", "--live", "--to", f"{site}/api/v1")
    environment = {**os.environ, "PALPATE_TOKEN": token, "PALPATE_SPOOL": str(tmp_path / "spool")}
    command = [sys.executable, "-u", "-c", SLOW, *asked]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=environment) as run:
        assert run.stdout is not None
        address = next(line.split()[-1] for line in run.stdout if "watch it at" in line)
        for page in (first, second):
            # the address is told before the server has heard of it
            while page.goto(address).status == 404:
                time.sleep(0.1)
        del faults[:]
        first.get_by_role("heading", name="Step 1: which action?").wait_for(timeout=9000)
        first.evaluate("window.same = true")
        second.context.set_offline(True)
        first.get_by_role("heading", name="Step 2: which action?").wait_for(timeout=9000)
        expect(first.locator("li.chosen")).to_have_count(1)
        expect(first.locator(".beliefs figure").nth(3)).to_be_attached()
        expect(first.locator("[data-part=state]")).to_contain_text("It goes on")
        second.context.set_offline(False)
        for page in (first, second):
            page.get_by_role("log").get_by_text("It ended because").wait_for(timeout=20_000)
            expect(page.get_by_role("log").locator("li")).to_have_count(5)
            page.get_by_role("heading", name="Step 4: which action?").wait_for()
        assert first.evaluate("window.same")
        assert "did not get" not in run.stdout.read()
    assert run.returncode == 0
    assert not faults
    first.keyboard.press("ArrowLeft")
    first.get_by_role("heading", name="Step 3: which action?").wait_for()
    for page in (first, second):
        page.context.close()


def test_keyboard_gets_past_the_menu(page: Any) -> None:
    """The first stop of the tabulator leads to the content."""
    page.goto("/compare")
    page.keyboard.press("Tab")
    expect(page.locator(":focus")).to_have_text("Skip to the content")


def test_pages_read_without_javascript(browser: Any, site: str) -> None:
    """All that a page shows is there without a script."""
    context = browser.new_context(base_url=site, java_script_enabled=False)
    page = context.new_page()
    page.goto("/objects?text=&property=elasticity&gripper=")
    expect(page.locator("li.card").nth(3)).to_be_attached()
    page.locator("li.card a").first.click()
    page.wait_for_url("**/objects/*/*")
    expect(page.locator("svg.plot").first).to_be_attached()
    context.close()
