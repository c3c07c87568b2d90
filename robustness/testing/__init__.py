"""Hypothesis strategies and assertions for property tests of resilient-consensus code (extra ``testing``).

Every strategy keeps its promise *by construction*: an r-robust graph is drawn as a seed that is r-robust, nodes of
in-degree at least r added to it, and more links; nothing is drawn and thrown away. The sizes are small. Shrinking
drops nodes and links while the test goes on failing, so it ends in a graph with nodes 0, 1, 2, ... from which the
strategy can drop nothing more: mostly, not always, one with the fewest nodes of all that fail. A graph prints as an
expression that can be pasted: ``nx.Graph({0: [1], 1: []})``.

>>> from hypothesis import given
>>> from robustness.testing import assert_robust, r_robust_graphs
>>> @given(r_robust_graphs(2))
... def test_they_are(G):
...     assert_robust(G, 2)
>>> test_they_are()
"""

from robustness.testing.assertions import assert_not_robust, assert_robust
from robustness.testing.conformance import assert_adversary_conforms, assert_algorithm_conforms
from robustness.testing.strategies import (
    digraphs,
    graphs,
    malicious_sets,
    not_r_robust_graphs,
    r_robust_graphs,
    rs_robust_graphs,
    time_varying_graphs,
)

__all__ = [
    "assert_adversary_conforms",
    "assert_algorithm_conforms",
    "assert_not_robust",
    "assert_robust",
    "digraphs",
    "graphs",
    "malicious_sets",
    "not_r_robust_graphs",
    "r_robust_graphs",
    "rs_robust_graphs",
    "time_varying_graphs",
]
