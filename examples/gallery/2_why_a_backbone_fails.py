"""
Find out why a backbone fails
=============================

A real network, on its map: twelve cities of Poland and their links. Is it 2-robust, so that every two groups
of nodes listen to each other enough?
"""

# %%
import matplotlib.pyplot as plt

import robustness as rb

network = rb.read_topology("topohub:sndlib/polska")
result = rb.check_rs_robustness(network, 2)
print(result.summary())

# %%
# It is not, and two sets of nodes show it: none of their nodes hears two nodes outside its own set. Whoever
# doubts it can count.
S1, S2 = result.witness
print(sorted(S1), sorted(S2), sep="\n")

# %%
# On the map. Two values that the groups hold stay apart for ever, though nobody lies.
rb.draw(network, result)
plt.show()
