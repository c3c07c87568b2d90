"""Draw the wheel with its trap beside K4, which has none: the picture of docs/how-many-liars.md.

python examples/how_many_liars.py docs/figures/how-many-liars.svg
"""

from __future__ import annotations

import sys

import networkx as nx

import robustness as rb
from robustness.figures.saving import new_figure, save_figure
from robustness.traps import find_trap


def main(path: str) -> None:
    """Draw both networks into one file."""
    figure = new_figure(10.5, 4.0)
    left, right = figure.subplots(1, 2, width_ratios=[1.0, 0.8])
    corners = {1: (-1.0, 1.0), 2: (1.0, 1.0), 3: (1.0, -1.0), 4: (-1.0, -1.0)}
    wheel, complete = nx.wheel_graph(5), nx.complete_graph(4)
    rb.draw(wheel, find_trap(wheel, 1), pos=corners | {0: (0.0, 0.0)}, ax=left)
    left.set_title("the wheel: a trap, so one liar splits it")
    rb.draw(complete, find_trap(complete, 1), pos={k - 1: place for k, place in corners.items()}, ax=right)
    right.set_title("K4: no trap, so it agrees against one liar")
    save_figure(figure, path)


if __name__ == "__main__":
    main(sys.argv[1])
