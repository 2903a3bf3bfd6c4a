"""Pages can be read, reached and operated by everybody: axe, the keyboard, less motion, and paper."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any
from uuid import uuid4

import numpy as np
import pytest

from palpate.server.app import application
from palpate.server.example import add_example
from palpate.server.pages import templates, upload
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.logging_in import set_password
from palpate.server.settings import Settings
from palpate.server.uploading.previews import Previews
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from palpate.store.pictures import png
from palpate.store.records import Channel, Device, FileItem, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_setups import seen_devices
from tests.server.browsing import DESKTOP, IN_A_BROWSER, PASSWORD, PHONE, log_in
from tests.server.packages import package
from tests.server.serving import listening
from tests.store.made_up import squeeze

axe = pytest.importorskip("axe_playwright_python.base", reason="axe is not installed")
expect = pytest.importorskip("playwright.sync_api", reason="playwright is not installed").expect
pytestmark = IN_A_BROWSER
TEMPLATES = templates.STATIC.with_name("templates")
FAULTS = """options => axe.run({resultTypes: ["violations"], ...options}).then(found => found.violations
  .filter(one => ["serious", "critical"].includes(one.impact))
  .map(one => `${one.id}: ${one.help}: ` + one.nodes.slice(0, 3).map(node => node.html.slice(0, 200)).join(" | ")))"""
COLOURS = {"runOnly": ["color-contrast"]}
"""All that depends on light or dark."""
LOOKS: list[tuple[str, Any, dict[str, Any]]] = [
    ("dark", DESKTOP, {}),
    ("light", DESKTOP, COLOURS),
    ("light", PHONE, {}),
    ("dark", PHONE, COLOURS),
]


def bell() -> Recording:
    """With all that a recording may have: a sound, a picture, a page, a log, notices, parameters and a calibration."""
    tone = Channel("sound", "sound pressure", None, np.sin(np.arange(16_000) / 5), rate_hz=8000.0)
    device = Device("gripper", "hand", "somebody", {"stroke_mm": 85}, {"offset_mm": 0.5}, "2024-01-02")
    return squeeze(
        visibility="public",
        thing=ThingRef("lab", "bell", "brass bell", "somebody", {"colour": "yellow"}, ("gong",)),
        action="knocking",
        setup=Setup(gripper=device),
        series=(*squeeze().series, Series("microphone", (tone,))),
        files=(
            FileItem("front.png", "image/png", png(np.full((40, 60, 3), 99, np.uint8), "front")),
            FileItem("note.html", "text/html", b"<p>"),
        ),
        log="knock\n" * 40,
        notices=("the gripper slipped",),
    )


class Place:
    """A server with example data, one account, and the addresses of its pages."""

    def __init__(self, store: Store) -> None:
        add_example(store, count=40)
        recording = bell()
        store.put(recording)
        add_user(store, "carl", Role.ADMIN)
        set_password(store, "carl", PASSWORD)
        shown = get_episode(store, list_episodes(store, limit=1).rows[0].id)
        unfinished = replace(shown, steps=(), id=uuid4(), started_at=datetime.now(UTC))
        put_episode(store, unfinished)
        self.public = [
            "/",
            "/objects",
            "/objects?text=nothing+of+that+name",
            "/objects/lab/bell",
            "/objects/ycb/011_banana",
            "/recordings?limit=8",
            f"/recordings/{recording.id}",
            "/compare",
            "/devices",
            *(f"/devices/{one.digest}" for one in seen_devices(store, Viewer())[:1]),
            "/benchmark",
            "/compare?property=elasticity&object=ycb%2F011_banana",
            f"/setups/{recording.setup.digest}",
            "/episodes",
            f"/episodes/{shown.id}",
            f"/episodes/{unfinished.id}",
            "/guides",
            *(f"/guides/{name}" for name in ("record", "upload", "accounts", "api", "cite", "watch")),
            "/login",
            "/login/provider",
            "/nothing/of/that/name",
            "/recordings?limit=0",
        ]
        self.own = ["/objects/lab/bell/edit", f"/recordings/{recording.id}", f"/episodes/{shown.id}"]
        self.own += ["/account", "/users", "/upload"]
        self.recording, self.episode = f"/recordings/{recording.id}", f"/episodes/{shown.id}"
        self.made = set[str]()
        """Templates that were made into pages."""

    def noting(self, get_template: Callable[..., Any]) -> Callable[..., Any]:
        """The same, noting what was asked for."""

        def noted(name: str, *rest: Any) -> Any:
            self.made.add(name)
            return get_template(name, *rest)

        return noted


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Place, str]]:
    """In this process, as one is to see what it makes pages of; its provider of log-ins does not answer."""
    folder = tmp_path_factory.mktemp("site")
    settings = Settings(requests_per_s=None, oidc_issuer="http://127.0.0.1:1", oidc_client_id="palpate")
    store = open_store(folder / "store.sqlite", folder / "blobs", durable=False)
    found, environment = Place(store), templates._environment()
    with pytest.MonkeyPatch.context() as patched, listening(application(store, settings)) as address:
        patched.setattr(environment, "get_template", found.noting(environment.get_template))
        yield found, address


@pytest.fixture
def page(browser: Any, place: tuple[Place, str]) -> Iterator[Any]:
    context = browser.new_context(base_url=place[1], viewport=DESKTOP)
    yield context.new_page()
    context.close()


def faults_of(page: Any) -> Iterator[str]:
    """What axe finds serious or critical in the page that is open, in each look."""
    # of one that a button led to, all of it
    page.wait_for_load_state()
    page.evaluate(axe.AXE_SCRIPT)
    for scheme, size, options in LOOKS:
        page.emulate_media(color_scheme=scheme)
        page.set_viewport_size(size)
        for fault in page.evaluate(FAULTS, options):
            yield f"{page.url} {scheme} {size['width']}: {fault}"


def of_everybody(page: Any, place: Place) -> Iterator[str]:
    """Open each page that anybody sees, one after the other."""
    for address in place.public:
        page.goto(address)
        yield address
    page.goto("/login")
    page.get_by_label("Name").fill("carl")
    page.get_by_label("Password").fill("wrong")
    page.get_by_role("button", name="Log in").click()
    page.get_by_role("alert").wait_for()
    yield "who is refused"


def of_who_is_logged_in(page: Any, place: Place) -> Iterator[str]:
    """Open each page that an account has of its own, and those of an upload until it is kept."""
    for address in place.own:
        page.goto(address)
        yield address
    page.goto(place.recording)
    page.get_by_label("But not before").fill("9999-12-31T00:00")
    page.get_by_role("button", name="Save").click()
    page.get_by_role("heading", name="Nothing was changed").wait_for()
    yield "the end of an embargo that is refused"
    page.goto("/upload")
    for name, value in TYPED.items():
        page.locator(f"input[name={name}]").fill(value)
    page.get_by_role("button", name="Keep it").click()
    page.get_by_role("alert").wait_for()
    yield "a typed measurement that is refused"
    sent = package(replace(bell(), id=uuid4(), thing=ThingRef("lab", "wet bell"), owner=None))
    page.get_by_label("Choose files").set_input_files(
        [
            {"name": "bell.zip", "mimeType": "application/zip", "buffer": sent},
            {"name": "hello.txt", "mimeType": "text/plain", "buffer": b"hello"},
            {"name": "broken.zip", "mimeType": "application/zip", "buffer": b"PK"},
        ]
    )
    page.get_by_text("hello.txt, 5 bytes").wait_for()
    yield "files that were chosen"
    page.get_by_role("button", name="Show what is in them").click()
    page.get_by_role("heading", name="What was understood").wait_for(timeout=60_000)
    expect(page.locator("svg.plot").first).to_be_attached()
    yield "what was understood"
    waiting = page.url
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(Previews, "is_being_kept", lambda *_: True)
        patched.setattr(upload, "LOOKS_AGAIN_S", 600)
        page.goto(f"{waiting}/kept")
        page.get_by_role("heading", name="It is being kept just now").wait_for()
        yield "what is being kept"
    page.goto(waiting)
    page.get_by_role("button", name="Keep").click()
    page.get_by_role("heading", name="1 recording is in the store").wait_for()
    yield "what was kept"
    page.goto("/upload")
    for name, value in TYPED.items():
        page.locator(f"input[name={name}]").fill(value)
    page.context.clear_cookies()
    page.get_by_role("button", name="Keep it").click()
    page.get_by_role("button", name="Log in").wait_for()
    yield "what was typed when the session had ended"
    page.get_by_label("Name").fill("carl")
    page.get_by_label("Password").fill(PASSWORD)
    page.get_by_role("button", name="Log in").click()
    page.get_by_role("button", name="Send it now").wait_for()
    yield "what was typed, to be sent"


TYPED = {
    "dataset": "lab",
    "object": "bell",
    "action": "weighing",
    "property": "mass",
    "value": "-1",
    "unit": "g",
    "recorded_at": "2024-01-02T03:04",
}


def test_axe_finds_nothing_serious(page: Any, place: tuple[Place, str]) -> None:
    """On each kind of page, light and dark, on a desktop and on a phone, for everybody and for who is logged in."""
    faults = [fault for _ in of_everybody(page, place[0]) for fault in faults_of(page)]
    log_in(page, "carl")
    faults += [fault for _ in of_who_is_logged_in(page, place[0]) for fault in faults_of(page)]
    assert not faults, "\n".join(faults)
    every = templates._environment().list_templates()
    pages = {name for name in every if "{% extends" in (TEMPLATES / name).read_text()}
    assert pages - place[0].made == set(), "pages that nobody has looked at"


def stops(page: Any) -> Iterator[tuple[str, bool]]:
    """What the tabulator stops at, and whether one sees that it does, until it comes around."""
    seen = 0
    while seen < 200:
        page.keyboard.press("Tab")
        found = page.evaluate(STOP)
        if found is None:
            return
        seen += 1
        yield found[0], found[1]


STOP = """() => { const one = document.activeElement; if (one === document.body) return null;
  const style = getComputedStyle(one);
  return [(one.textContent.trim() || one.name || one.outerHTML).slice(0, 40),
          style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 2]; }"""


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_the_keyboard_reaches_all_and_shows_where_it_is(page: Any, place: tuple[Place, str], size: Any) -> None:
    """Menu, search, filters and buttons; the first stop leads past the menu to the content."""
    page.set_viewport_size(size)
    page.goto("/")
    found = list(stops(page))
    assert [name for name, shown in found if not shown] == []
    names = [name for name, _ in found]
    assert names[0] == "Skip to the content"
    if size is PHONE:
        assert "Objects" not in names
        page.locator(".menu summary").press("Enter")
        expect(page.locator(".menu nav")).to_be_visible()
        opened = list(stops(page))
        assert [name for name, shown in opened if not shown] == []
        names += [name for name, _ in opened]
    for wanted in ("Objects", "Recordings", "Compare", "Explorations", "Devices", "Guides", "Log in", "text", "Search"):
        assert wanted in names
    page.goto("/recordings")
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.keyboard.press("Tab")
    expect(page.locator("input[name=text]")).to_be_focused()
    page.keyboard.type("bell")
    page.keyboard.press("Enter")
    page.wait_for_url("**/recordings?text=bell**")
    page.goto(place[0].recording)
    assert [name for name, shown in stops(page) if not shown] == []


def test_who_wants_less_motion_gets_none(page: Any, place: tuple[Place, str]) -> None:
    """Nothing moves by itself or slides where the reader has asked for less."""
    page.emulate_media(reduced_motion="reduce")
    for address in ("/", place[0].recording):
        page.goto(address)
        assert page.evaluate(MOVING) == []


MOVING = """() => [...document.querySelectorAll("*")].filter(one => { const style = getComputedStyle(one);
  const longest = times => Math.max(...times.split(",").map(parseFloat));
  return longest(style.transitionDuration) > 0.01 || longest(style.animationDuration) > 0.01
      || style.scrollBehavior === "smooth"; }).map(one => one.tagName)"""


@pytest.mark.parametrize("name", ["recording", "object", "benchmark", "episode"])
def test_pages_print(page: Any, place: tuple[Place, str], name: str) -> None:
    """Dark pages too are black on white on paper, without what only a screen can do, and no wider than the paper."""
    page.emulate_media(media="print", color_scheme="dark")
    page.set_viewport_size({"width": 720, "height": 1000})
    addresses = {"object": "/objects/ycb/011_banana", "benchmark": "/benchmark"}
    addresses |= {"recording": place[0].recording, "episode": place[0].episode}
    page.goto(addresses[name])
    colours = "one => [getComputedStyle(document.body).color, getComputedStyle(document.body).backgroundColor]"
    assert page.evaluate(colours) == ["rgb(0, 0, 0)", "rgb(255, 255, 255)"]
    inks = "all => all.map(one => getComputedStyle(one).backgroundColor)"
    assert set(page.locator("pre, header").evaluate_all(inks)) <= {"rgb(255, 255, 255)", "rgba(0, 0, 0, 0)"}
    assert not [one for one in page.get_by_role("button").all() if one.is_visible()]
    for hidden in ("nav[aria-label=Main]", ".who", ".skip"):
        assert not page.locator(hidden).is_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    # grounds are left out on most printers, and what is light on them would be gone
    assert page.evaluate(LIGHT) == []
    assert page.pdf(format="A4")[:5] == b"%PDF-"


LIGHT = """() => [...document.querySelectorAll("body *")].filter(one => one.innerText && one.checkVisibility()
  && getComputedStyle(one).color.match(/\\d+/g).slice(0, 3).every(part => part > 200)).map(one => one.outerHTML)"""
