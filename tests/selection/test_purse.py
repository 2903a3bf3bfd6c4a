from hypothesis import given
from hypothesis import strategies as st

from palpate.selection.purse import Purse


def test_a_purse_without_a_limit_affords_all() -> None:
    """Where nothing limits the cost, costs need not be known."""
    assert Purse().affords(["look"] * 1000)


@given(st.lists(st.floats(0, 100), min_size=1, max_size=20))
def test_what_costs_exactly_the_rest_is_afforded(costs: list[float]) -> None:
    """Costs that meet the limit but for rounding are afforded in any order; a tenth more is not."""
    prices = {str(i): cost for i, cost in enumerate(costs)}
    purse = Purse(sum(costs), prices)
    assert purse.affords(list(prices))
    assert purse.affords(list(prices)[::-1])
    assert not Purse(sum(costs), {**prices, "more": 0.1}).affords([*prices, "more"])
