"""Products of named tables against `numpy.einsum`."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.inference.tensors import Table, contract, product

SIZES = {"c": 2, "m": 3, "r": 4, "v": 1, "y": 5}
AXES = st.permutations(sorted(SIZES))


@st.composite
def names(draw: st.DrawFn, most: int = 4) -> tuple[str, ...]:
    return tuple(draw(AXES)[: draw(st.integers(0, most))])


@st.composite
def problems(draw: st.DrawFn, most: int) -> tuple[list[Table], tuple[str, ...]]:
    """Tables over any axes, and any of their axes in any order."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    axes = draw(st.lists(names(), min_size=1, max_size=most))
    tables = [Table(rng.normal(size=[SIZES[n] for n in own]), own) for own in axes]
    used = {n for own in axes for n in own}
    return tables, tuple(n for n in draw(names(5)) if n in used)


def by_einsum(tables: Sequence[Table], out: Sequence[str]) -> Any:
    place = {name: i for i, name in enumerate(SIZES)}
    operands: list[Any] = []
    for table in tables:
        operands += [table.values, [place[n] for n in table.names]]
    return np.einsum(*operands, [place[n] for n in out])


@given(problems(2).filter(lambda problem: len(problem[0]) == 2))
@settings(max_examples=300)
def test_a_product_is_that_of_einsum(problem: tuple[list[Table], tuple[str, ...]]) -> None:
    """Any two tables, with axes in any order, multiply and sum out as einsum does."""
    (a, b), out = problem
    made = product(a, b, out)
    assert made.names == out
    np.testing.assert_allclose(made.values, by_einsum([a, b], out), rtol=1e-12, atol=1e-12)


@given(problems(5))
@settings(max_examples=200)
def test_a_contraction_is_that_of_einsum(problem: tuple[list[Table], tuple[str, ...]]) -> None:
    """Any number of tables contracts to what einsum makes of all of them at once."""
    tables, out = problem
    made = contract(tables, out)
    assert made.names == out
    np.testing.assert_allclose(made.values, by_einsum(tables, out), rtol=1e-11, atol=1e-11)


@given(problems(4), st.randoms(use_true_random=False))
@settings(max_examples=100)
def test_the_order_of_the_tables_does_not_matter(problem: tuple[list[Table], tuple[str, ...]], random: Any) -> None:
    """A contraction of the same tables in another order is the same."""
    tables, out = problem
    shuffled = list(tables)
    random.shuffle(shuffled)
    np.testing.assert_allclose(contract(shuffled, out).values, contract(tables, out).values, rtol=1e-11, atol=1e-11)


@given(problems(1))
@settings(max_examples=60)
def test_sums_name_what_they_keep(problem: tuple[list[Table], tuple[str, ...]]) -> None:
    """A table summed to some of its axes has them in the order asked for."""
    (table,), out = problem
    summed = table.sum_to(out)
    assert summed.names == out
    np.testing.assert_allclose(summed.values, by_einsum([table], out), rtol=1e-12, atol=1e-12)


def test_operands_stay_as_they_are() -> None:
    """Multiplying leaves the operands unchanged, and a table asked for as it stands is itself."""
    a, b = (Table(np.arange(6.0).reshape(2, 3), own) for own in (("c", "m"), ("c", "m")))
    product(a, b, ("m",))
    assert a.values.tolist() == b.values.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert a.sum_to(("c", "m")) is a


def test_one_plan_serves_tables_of_other_sizes() -> None:
    """What is kept from one product depends on names alone: other sizes come out as right."""
    for n, k in ((2, 3), (5, 2), (1, 7)):
        a, b = Table(np.ones((n, k)), ("a", "b")), Table(np.full((k, 4), 2.0), ("b", "c"))
        assert product(a, b, ("c", "a")).values == pytest.approx(np.full((4, n), 2.0 * k))
        assert contract([a, b, a], ("a",)).values == pytest.approx(np.full(n, 8.0 * k))
