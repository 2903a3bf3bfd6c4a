"""Who is slow makes room for others, and nobody else does."""

from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from palpate.server.security.rooms import LONGEST_WAIT_S, SHORTEST_WAIT_S, Room
from tests.server.holders import Somebody

MOST, MOST_OF_A_NETWORK = 8, 5
NETWORKS = st.sampled_from("abc")
SIZES = st.integers(1, 4)
WAITS_S = st.sampled_from([0.0, 0.9, 1.5, 3.0, 6.0, 99.0])
ARRIVALS = st.lists(st.tuples(NETWORKS, SIZES, WAITS_S, st.booleans()), max_size=25)


def may_be_ended(one: Somebody, taken: Counter[str]) -> bool:
    """Waited for longer than what is left of the longest wait, in parts of what its network may have."""
    left_s = LONGEST_WAIT_S * (MOST_OF_A_NETWORK - taken[one.network]) / MOST_OF_A_NETWORK
    return one.waited_s > left_s and one.waited_s > SHORTEST_WAIT_S


@given(ARRIVALS)
def test_the_slow_make_room(arrivals: list[tuple[str, int, float, bool]]) -> None:
    """One enters where those who are slow, all together, have enough; as few as are needed end, the slowest first."""
    room, there = Room(MOST, MOST_OF_A_NETWORK), dict[Somebody, int]()
    for network, size, waited_s, leaves in arrivals:
        taken = Counter[str]()
        for one, its_size in there.items():
            taken[one.network] += its_size
        slow = [one for one in there if may_be_ended(one, taken)]
        missing = taken.total() + size - MOST
        own_missing = taken[network] + size - MOST_OF_A_NETWORK
        fits = sum(there[one] for one in slow) >= missing
        fits = fits and sum(there[one] for one in slow if one.network == network) >= own_missing

        new = Somebody(network, waited_s)
        assert room.enter(new, size) == fits
        ended = [one for one in there if one.is_ended]
        assert not ended or (fits and max(missing, own_missing) > 0)
        assert set(ended) <= set(slow)
        spared_s = [one.waited_s for one in slow if not one.is_ended]
        if own_missing <= 0:
            assert all(one.waited_s >= max(spared_s, default=0.0) for one in ended)
            last_s = min((one.waited_s for one in ended), default=0.0)
            last = max((there[one] for one in ended if one.waited_s == last_s), default=0)
            assert not ended or sum(there[one] for one in ended) - last < missing
        for one in ended:
            del there[one]
        if fits:
            there[new] = size
        assert room.is_full_of("a") == (sum(n for one, n in there.items() if one.network == "a") >= MOST_OF_A_NETWORK)
        if leaves and there:
            gone = next(iter(there))
            room.leave(gone)
            room.leave(gone)
            del there[gone]
        assert sum(there.values()) <= MOST


def test_the_room_is_one_s_own_where_all_others_are_slow() -> None:
    """However much is wanted; and whoever has some already ends not himself by taking more."""
    room, slow, quick = Room(4, 4), Somebody("slow", 9.0), Somebody("quick")
    assert room.enter(slow, 2)
    assert room.enter(quick, 2)
    large = Somebody("large", 99.0)
    assert not room.enter_alone(large, 99)
    room.leave(quick)
    assert room.enter_alone(large, 99)
    assert slow.is_ended
    assert not room.enter(large)
    assert not large.is_ended


def test_a_crowd_makes_room_for_one() -> None:
    """Who has no place, or few, need not wait until any of a network that has ten times as many is slow."""
    room = Room(49, 40)
    crowd = [Somebody("crowd", 0.2) for _ in range(40)]
    others = [Somebody("others", 0.9) for _ in range(9)]
    assert all(room.enter(one) for one in (*crowd, *others))
    assert not room.enter(Somebody("crowd"))
    assert not room.enter(Somebody("others"))
    assert all(room.enter(Somebody("one")) for _ in range(3))
    assert sum(one.is_ended for one in crowd) == 3
    # thirty-seven are less than ten times four
    assert not room.enter(Somebody("one"))
    assert not any(one.is_ended for one in others)
