"""
Watch an attack
===============

A network that is refuted comes with an attack, and the attack can be played.
"""

# %%
# A wheel of five nodes agrees although one node lies, as long as it tells everybody the same and every
# message is in time.
import matplotlib.pyplot as plt
import networkx as nx

import robustness as rb
from robustness.simulation import find_attack

wheel = nx.wheel_graph(5)
print(find_attack(wheel, 1, "malicious").reason)

# %%
# With delays one liar is enough to split it: a late message lets it show either side the face that it likes.
found = find_attack(wheel, 1, "delayed")
print(found.reason)
rb.draw(wheel, found.attack)
plt.show()

# %%
# The same attack, carried out. Two groups stay where they are, to the last bit.
outcome = found.attack.run(40, rule="w-msr", record=True)
print(outcome.summary())
outcome.plot()
plt.show()

# %%
# The same liar on a network without such sets.
outcome = rb.simulate(nx.complete_graph(5), rule="w-msr", f=1, malicious=[4], adversary="sine", steps=40, seed=1)
print(outcome.summary())
outcome.plot()
plt.show()
