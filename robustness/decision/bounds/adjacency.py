"""The rows of a graph in both directions, as the passes over its arcs take them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph

__all__ = ["Adjacency", "adjacency"]


class Adjacency(NamedTuple):
    """In-neighbours and out-neighbours as compressed rows: ``indptr`` has shape ``(n + 1,)``, ``indices`` ``(m,)``."""

    in_indptr: npt.NDArray[np.int64]
    in_indices: npt.NDArray[np.int32]
    out_indptr: npt.NDArray[np.int64]
    out_indices: npt.NDArray[np.int32]

    @property
    def n(self) -> int:
        """The number of nodes."""
        return len(self.in_indptr) - 1


def adjacency(graph: Digraph) -> Adjacency:
    """Return the rows of ``graph`` in both directions. Linear time and memory."""
    from robustness.kernels.passes import transpose

    return Adjacency(graph.in_indptr, graph.in_indices, *transpose(graph.in_indptr, graph.in_indices))
