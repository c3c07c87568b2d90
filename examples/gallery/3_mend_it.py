"""
Mend it
=======

Which links would make the network of the last story robust, and are they the fewest?
"""

# %%
import matplotlib.pyplot as plt

import robustness as rb

network = rb.read_topology("topohub:sndlib/polska")
found = rb.mend(network, 2)
print(found.summary())
print(found.links)

# %%
# With the new link drawn thick:
rb.draw(found.graph, found)
plt.show()

# %%
# A goal may also be what the network is to survive: here one liar who tells everybody the same.
found = rb.mend(network, rb.Goal(survive=1, model="malicious"))
print(found.summary())
rb.draw(found.graph, found)
plt.show()

# %%
# "Nothing cheaper" is a proof: violations that every choice of links has to break, and a second solver that
# finds no cheaper choice which breaks them all. How many links may fail before the goal is lost again?
print(rb.margin(found.graph, rb.Goal(survive=1, model="malicious")).summary())
