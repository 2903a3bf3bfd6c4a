"""The table of limits in the guide is that of the program."""

import re
from pathlib import Path

from palpate.server import app, batches, explorations, receiving, running, state
from palpate.server.api import queries, recordings, series
from palpate.server.pages import allowance, signals
from palpate.server.security import askers, bodies, connections, places, request_heads, rooms
from palpate.server.security.addresses import IPV6_BITS
from palpate.server.security.tries import Tries
from palpate.server.settings import Settings
from palpate.store import sizes, texts

PAGE = Path("docs/server.md").read_text(encoding="utf-8")
SECTION = PAGE[PAGE.index("## Limits") : PAGE.index("## How fast it is")]


def size(number_bytes: int) -> str:
    for power, name in ((30, "GiB"), (20, "MiB"), (10, "KiB")):
        if number_bytes >= 1 << power:
            assert not number_bytes % (1 << power)
            return f"{number_bytes >> power} {name}"
    raise AssertionError(number_bytes)


def test_the_table_of_limits_is_that_of_the_program() -> None:
    """Each number of it is the constant that holds."""
    settings, tries = Settings(), Tries()
    rate = settings.requests_per_s or 0.0
    expected = [
        f"{rate:g}/s",
        f"{app.BURST_S * rate:,.0f}",
        f"{app.OF_ACCOUNT * rate:g}/s",
        f"{tries.of_name_here.burst}; {tries.of_address.burst}",
        f"{connections.MOST_OPEN}; {connections.MOST_OPEN_OF_A_NETWORK}",
        f"{places.MOST_REQUESTS}; {places.MOST_REQUESTS_OF_A_NETWORK}",
        f"{places.MOST_WATCHERS}; {places.MOST_WATCHERS_OF_A_NETWORK}",
        f"{rooms.LONGEST_WAIT_S:g} s; {rooms.SHORTEST_WAIT_S:g} s where its address has all it may; "
        f"{rooms.CROWDED_WAIT_S:g} s where it has ten times the places of the one that comes",
        size(request_heads.LARGEST_HEADERS_BYTES),
        f"{2 * connections.HELD_S:g} s; {running.KEEP_ALIVE_S} s",
        f"{size(bodies.LEAST_BYTES_PER_S)}/s at least",
        f"{connections.IDLE_LOOKS * connections.HELD_S:g} s",
        f"{size(settings.largest_upload_bytes)}; {size(settings.largest_unpacked_bytes)}; {receiving.MOST_PARTS:,}",
        size(settings.largest_body_bytes),
        f"{recordings.MOST_PACKAGES:,}; {batches.MOST_LINES:,}",
        f"{sizes.MOST_ENTRIES:,}",
        size(sizes.LONGEST_LOG),
        size(sizes.LARGEST_JSON_BYTES),
        f"{texts.LARGEST_SI:g}",
        f"{explorations.MOST_LINES:,}; {size(explorations.MOST_BYTES)}",
        f"{queries.LONGEST_PAGE}",
        f"{series.LARGEST_VALUES:,}",
        size(series.LARGEST_READ_BYTES),
        f"{size(state.MOST_HELD_BYTES)}; {size(state.MOST_HELD_BYTES_OF_A_NETWORK)}",
        f"{allowance.MOST_NUMBERS:,}",
        f"{allowance.MOST_FITTED:,}",
        f"{signals.MOST_SERIES}; {signals.MOST_FILES}; {allowance.MOST_DRAWN}",
    ]
    rows = re.findall(r"^\| ([^|]+) \| ([^|]+) \| ([^|]+) \|$", SECTION, re.MULTILINE)[1:]
    assert [found for _, found, _ in rows] == expected
    beyond = {what: told for what, _, told in rows}
    assert f"after {1 / tries.of_name_here.per_s:.0f} s; {1 / tries.of_address.per_s:.0f} s" in str(beyond)
    assert f"a body, after {bodies.GRACE_S:g} s" in beyond
    assert sizes.MOST_ENTRIES == sizes.MOST_NOTICES == sizes.MOST_ALIASES
    assert f"the first {IPV6_BITS} bits" in SECTION
    assert rooms.CROWD == 10
    assert f"Each {size(askers.ENOUGH_BYTES_PER_S)} that come or go take a second off," in SECTION
