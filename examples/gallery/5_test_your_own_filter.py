"""
Property-test your own filter
=============================

A theorem about every robust network and every liar is a property to be tested with generated networks. The
strategies of ``robustness.testing`` draw networks that are robust by construction, and shrink what fails to
something small.
"""

# %%
# A filter that has been written more than once: sort what is heard and cut f values off either end.
from statistics import fmean

import matplotlib.pyplot as plt
import networkx as nx
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import robustness as rb
from robustness.testing import rs_robust_graphs


def cut_both_ends(heard, f):
    return sorted(heard)[f : len(heard) - f]


def spread_after(network, start, f, rounds=100):
    values = dict(start)
    for _ in range(rounds):
        kept = {i: cut_both_ends([values[j] for j in network[i]], f) for i in network}
        values = {i: fmean([values[i], *kept[i]]) for i in network}
    return max(values.values()) - min(values.values())


# %%
# On a (2,2)-robust network the normal nodes agree, whoever lies. Here nobody even does. (A busy machine is no failure.)
@settings(derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(rs_robust_graphs(2, 2), st.data())
def normal_nodes_agree(network, data):
    start = {i: data.draw(st.integers(0, 9), label=f"node {i} starts at") for i in network}
    assert spread_after(network, start, f=1) < 1e-3


try:
    normal_nodes_agree()
except AssertionError as failure:
    print("it does not hold:", *getattr(failure, "__notes__", []), sep="\n")

# %%
# Every node of a triangle hears two values and drops both, so nobody ever moves. The rule of W-MSR compares with
# the own value first, for this very reason: a node at the bottom drops nothing below itself.
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 3.5), layout="constrained")
for rule, axes in ((lambda own, heard: fmean([own, *cut_both_ends(heard, f=1)]), left), ("w-msr", right)):
    rb.simulate(nx.complete_graph(3), rule, 1, [], steps=20, positions=[0, 5, 9]).plot(ax=axes)
left.set_title("cut both ends", loc="left")
right.set_title("W-MSR", loc="left")
plt.show()
