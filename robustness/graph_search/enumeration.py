"""Exhaustive search: every graph on n nodes up to isomorphism, fewest edges first.

So the first graph that fits has the fewest edges, and when none fits it is proven that none exists.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from robustness.constructions.small_graphs import (
    LARGEST_DIGRAPHS,
    LARGEST_GRAPHS,
    Batch,
    batch_profiles,
    digraph_of_masks,
    digraphs_up_to_isomorphism,
    graphs_up_to_isomorphism,
)
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.graph_search.properties import Property, RSRobust
from robustness.limits import Limits

__all__ = ["can_enumerate", "first_fitting"]


def can_enumerate(n: int, *, directed: bool) -> bool:
    """Return whether all graphs on n nodes are listed."""
    return n <= (LARGEST_DIGRAPHS if directed else LARGEST_GRAPHS)


def first_fitting(
    n: int, satisfies: Sequence[Property], violates: Sequence[Property], *, directed: bool, limits: Limits
) -> Digraph | None:
    """Return a graph with the fewest edges that fits, or None when there is none.

    Raises
    ------
    Undecided
        When a limit came first.
    """
    batch = digraphs_up_to_isomorphism(n) if directed else graphs_up_to_isomorphism(n)
    for masks in batch[_may_fit(batch, satisfies, violates)]:
        if limits.expired():
            raise Undecided("the time limit was reached before all graphs were tried: raise it")
        graph = digraph_of_masks(masks, directed=directed)
        if all(each.holds(graph, limits) for each in satisfies) and not any(
            each.holds(graph, limits) for each in violates
        ):
            return graph
    return None


def _may_fit(batch: Batch, satisfies: Sequence[Property], violates: Sequence[Property]) -> np.ndarray:
    """Return which graphs fit as far as robustness goes, decided for all of them in one pass."""
    n = batch.shape[1]
    fits = np.ones(len(batch), dtype=bool)
    wanted = [(each, True) for each in satisfies] + [(each, False) for each in violates]
    if not any(isinstance(each, RSRobust) for each, _ in wanted):
        return fits
    profiles = batch_profiles(batch)
    for each, expected in wanted:
        if isinstance(each, RSRobust):
            known = each.r < profiles.shape[1] and each.s <= max(n, 1)
            fits &= (profiles[:, each.r] >= each.s if known else np.zeros(len(batch), dtype=bool)) == expected
    return fits
