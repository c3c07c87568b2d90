"""The filter: three implementations, one meaning."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustness.kernels.steps import drop_extremes
from robustness.simulation.filters import kept_by_msr
from robustness.simulation.reference import kept_neighbours

#: Few different values, so that ties and exact zeros are the rule.
TIED = st.sampled_from([-2.0, -1.0, -0.0, 0.0, 1.0, 2.0, 3.0])
VALUES = st.lists(st.one_of(TIED, st.floats(-1e6, 1e6)), max_size=9)


def by_hand(values: list[float], f: int, *, strict: bool) -> list[int]:
    """Algorithm 1 in the shortest words: from each end take away f values, but none of the other side."""
    order = sorted(range(len(values)), key=lambda j: (-values[j], j))
    top = [j for j in order[:f] if (values[j] > 0 if strict else values[j] >= 0)]
    bottom = [j for j in order[::-1][:f] if (values[j] < 0 if strict else values[j] <= 0)]
    return [j for j in range(len(values)) if j not in top + bottom]


def compiled(values: list[float], f: int, *, strict: bool) -> list[int]:
    count = len(values)
    keep = np.empty(count, np.uint8)
    drop_extremes(np.array(values), count, f, strict, np.empty(count), np.empty(count), keep)
    return np.flatnonzero(keep).tolist()


@given(VALUES, st.integers(0, 5), st.booleans())
def test_all_implementations_keep_the_same(values: list[float], f: int, strict: bool) -> None:
    expected = by_hand(values, f, strict=strict)
    assert kept_neighbours(dict(enumerate(values)), f, strict=strict) == expected
    assert compiled(values, f, strict=strict) == expected
    heard = np.ones(len(values), dtype=bool)
    assert np.flatnonzero(kept_by_msr(np.array(values), heard, np.array(f), strict=strict)).tolist() == expected


@given(VALUES, st.integers(0, 4), st.data())
def test_what_is_not_heard_is_neither_kept_nor_counted(values: list[float], f: int, data: st.DataObject) -> None:
    heard = np.array([data.draw(st.booleans()) for _ in values], dtype=bool)
    kept = kept_by_msr(np.array(values), heard, np.array(f), strict=False)
    places = np.flatnonzero(heard)
    expected = by_hand([values[j] for j in places], f, strict=False)
    assert np.flatnonzero(kept).tolist() == [places[t] for t in expected]


@given(VALUES, st.integers(0, 4), st.booleans())
def test_what_is_kept_lies_between_honest_values(values: list[float], f: int, strict: bool) -> None:
    """Whichever f of the values are false, a kept one lies in the hull of the honest ones and the own value 0."""
    for j in by_hand(values, f, strict=strict):
        if values[j] > 0:
            assert sum(other >= values[j] for other in values) > f
        if values[j] < 0:
            assert sum(other <= values[j] for other in values) > f


@given(VALUES, st.integers(0, 4))
def test_strictness_shows_only_in_zeros(values: list[float], f: int) -> None:
    loose, strict = (set(by_hand(values, f, strict=choice)) for choice in (False, True))
    assert loose <= strict
    assert all(values[j] == 0 for j in strict - loose)


@pytest.mark.parametrize(
    ("values", "f", "kept"),
    [
        ([5.0, 4.0, -1.0], 2, []),  # two above: both dropped; one below: fewer than f, dropped
        ([5.0, 4.0, 3.0, -1.0], 2, [2]),
        ([1.0, 1.0, 1.0], 1, [1, 2]),  # a tie above: the smallest id goes
        ([-1.0, -1.0, -1.0], 1, [0, 1]),  # a tie below: the largest id goes
        ([0.0, 0.0, 0.0], 1, [1]),  # an equal value counts on both sides
        ([0.0], 1, []),
        ([], 3, []),
        ([7.0, -7.0], 0, [0, 1]),
    ],
)
def test_corners_of_algorithm_1(values: list[float], f: int, kept: list[int]) -> None:
    assert compiled(values, f, strict=False) == kept
    assert kept_neighbours(dict(enumerate(values)), f, strict=False) == kept


def test_rows_are_independent() -> None:
    relative = np.array([[[1.0, 2.0, 3.0]], [[-1.0, 0.0, 5.0]]])
    kept = kept_by_msr(relative, np.ones_like(relative, dtype=bool), np.array([[1], [2]]), strict=False)
    assert kept.tolist() == [[[True, True, False]], [[False, False, False]]]
