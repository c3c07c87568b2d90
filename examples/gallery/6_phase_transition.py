"""
When do radio networks become robust?
=====================================

Nodes in a square, linked when they are in radio range. With a growing range r* grows as well, and closely
follows the least number of neighbours, which it can never exceed.
"""

# %%
import matplotlib.pyplot as plt
import networkx as nx
import numpy as np

import robustness as rb

places = {i: tuple(place) for i, place in enumerate(np.random.default_rng(3).random((30, 2)))}
ranges = np.linspace(0.1, 0.9, 17)
networks = [nx.random_geometric_graph(30, reach, pos=places) for reach in ranges]
rows = [rb.determine_robustness(network, s_time_limit=0.01) for network in networks]
print([row.r for row in rows])

# %%
# Each of these numbers is exact: a proof that all pairs of sets listen, and a pair that does not for one
# more.
fewest = [min(degree for _, degree in network.degree) for network in networks]
figure, axes = plt.subplots(figsize=(7, 4))
axes.step(ranges, fewest, where="post", label="least degree", color="lightgray", linewidth=7)
axes.step(ranges, [row.r for row in rows], where="post", label="r*, exact", color="tab:red")
axes.set(xlabel="radio range", ylabel="", title="Thirty nodes in a unit square")
axes.legend()
plt.show()

# %%
# The network where r* is 2 for the first time, and a pair of groups that keeps it from being 3-robust.
first = next(k for k, row in enumerate(rows) if row.r == 2)
rb.draw(networks[first], rb.check_rs_robustness(networks[first], 3), pos=places)
plt.show()
