"""
A swarm whose links come and go
===============================

Six drones talk in pairs, another pairing at each of five steps. No single step is even connected. Over how
many steps together does everybody listen to enough others?
"""

# %%
import matplotlib.pyplot as plt
import networkx as nx

import robustness as rb


def pairing(step, n=6):
    """The step-th round of a tournament in which each plays each once."""
    circle = [(step + i) % (n - 1) for i in range(n - 1)]
    return [(circle[0], n - 1), *((circle[i], circle[-i]) for i in range(1, n // 2))]


steps = []
for step in range(5):
    network = nx.empty_graph(6)
    network.add_edges_from(pairing(step))
    steps.append(network)
swarm = rb.TimeVaryingGraph(steps, period=5)

figure, panels = plt.subplots(1, 5, figsize=(12, 2.6))
for k, (network, axes) in enumerate(zip(steps, panels, strict=True)):
    rb.draw(network, ax=axes, pos=nx.circular_layout(network))
    axes.set_title(f"step {k}")
plt.show()

# %%
# For every r, the fewest consecutive steps whose union is r-robust wherever they start.
print(dict(rb.joint_curve(swarm)))

# %%
# Is that soon enough, when drones remember what they heard in the last five steps?
result = rb.check_joint_robustness(swarm, 2, tau=5)
print(result.summary())

# %%
# One step fewer, and two groups do not hear enough of each other: the links of those steps together.
shorter = rb.check_joint_robustness(swarm, 2, window=result.window - 1)
rb.draw(swarm, shorter)
plt.show()
