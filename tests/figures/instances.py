"""Networks that are drawn, and what they are drawn on."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import networkx as nx
from matplotlib.figure import Figure

mpl.use("agg")

PETERSEN, WHEEL = nx.petersen_graph(), nx.wheel_graph(5)


def axes() -> Any:
    return Figure(layout="constrained").subplots()
