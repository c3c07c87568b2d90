"""Natural order: total, by value, whatever the labels are."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st

from robustness.natural_order import in_natural_order, natural_key

LABELS = st.recursive(
    st.integers() | st.text(alphabet="an019²-é", max_size=6) | st.floats(allow_nan=False),
    lambda parts: st.tuples(parts, parts),
    max_leaves=4,
)


def test_numbers_count_by_value() -> None:
    names = [f"n{k}" for k in (10, 2, 1, 100, 20)]
    assert in_natural_order(names) == ["n1", "n2", "n10", "n20", "n100"]
    assert in_natural_order({10, 9, -1, 100}) == [-1, 9, 10, 100]
    assert in_natural_order([(10, 1), (9, 2), (9, 10)]) == [(9, 2), (9, 10), (10, 1)]


def test_a_number_may_be_of_any_length() -> None:
    assert in_natural_order(["x" + "9" * 5000, "x1" + "0" * 5000]) == ["x" + "9" * 5000, "x1" + "0" * 5000]


@given(st.lists(LABELS, max_size=5))
def test_the_order_does_not_depend_on_how_the_labels_came(labels: list[object]) -> None:
    orders = {tuple(map(repr, in_natural_order(each))) for each in itertools.permutations(labels)}
    keys = {natural_key(label) for label in labels}
    assert len(orders) == 1 or len(keys) < len(set(map(repr, labels)))


@given(st.text(alphabet="a019", max_size=6), st.text(alphabet="a019", max_size=6))
def test_different_names_have_different_keys(first: str, second: str) -> None:
    assert (natural_key(first) == natural_key(second)) == (first == second)
