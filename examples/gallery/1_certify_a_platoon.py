"""
Certify a platoon
=================

Vehicles drive in a line, and each talks to the next few ahead and behind. How far must they hear, so that one
of them may lie?
"""

# %%
# Eight vehicles, each in touch with the two before and the two after it.
import matplotlib.pyplot as plt

import robustness as rb
from robustness.constructions import build

platoon = build("platoon", n=8, k=2)
print(rb.determine_robustness(platoon).summary())

# %%
# So one vehicle may lie, as long as it tells everybody the same: (2,2)-robust is what that takes. A liar who
# tells each neighbour another story is worse.
for model in ("malicious", "byzantine"):
    answer = rb.tolerance(platoon, model)
    print(f"{model}: up to {answer.guaranteed} liars for certain, and {answer.refuted} can split it")

# %%
# Who is in touch with three vehicles either way survives that liar, too.
wider = build("platoon", n=8, k=3)
print(rb.tolerance(wider, "byzantine").guaranteed)

# %%
# The answer carries its evidence. A certificate is checked by a program that shares nothing with the search
# and needs nothing but Python's own library.
from certificates import verify

result = rb.certify(wider, 3)
graph = rb.Digraph.from_networkx(wider)
print(len(result.certificate), "bytes")
print(verify(graph.canonical_bytes(), result.certificate))

# %%
# And the narrow platoon, with the liar in the middle and the two groups that it holds apart.
line = {vehicle: (vehicle, 0.3 * (vehicle % 2)) for vehicle in platoon}
rb.draw(platoon, rb.tolerance(platoon, "byzantine"), pos=line)
plt.show()
