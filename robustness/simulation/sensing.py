"""Sensing: whether a vehicle believes what its neighbours send, or looks for itself.

*Passive* sensing (a radio) delivers the claim of a neighbour; *active* sensing (a camera, a lidar) its true
position. Both through the same delays: a measurement is processed at the vehicle's next update like a message.
A neighbour that withholds its messages is still seen by active sensing.

All claims and true positions of one step are written side by side on one board, in channels: ``0 .. n-1`` what each
node sends to all; then, if somebody senses actively, ``n`` true positions; then, under a Byzantine model, one channel
per arc for what is told to a single neighbour. Every arc listens to one channel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from robustness.digraph import Digraph
from robustness.simulation.dynamics import Floats

__all__ = ["Board", "board_for"]


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """The layout of the channels.

    Attributes
    ----------
    channel : integer array, shape ``(A,)``
        The channel each arc listens to.
    active : boolean array, shape ``(A,)``
        Whether the receiver of the arc senses actively.
    tails : integer array, shape ``(A,)``
        The sender of each arc.
    nodes : int
        n.
    byzantine : bool
        Whether there is one channel per arc.
    """

    channel: npt.NDArray[np.int64]
    active: npt.NDArray[np.bool_]
    tails: npt.NDArray[np.int64]
    nodes: int
    byzantine: bool

    @property
    def width(self) -> int:
        """The number of channels."""
        if self.byzantine:
            return 2 * self.nodes + len(self.tails)
        return self.nodes * (2 if self.active.any() else 1)

    def write(self, row: Floats, sent: Floats, positions: Floats, told: Floats | None) -> None:
        """Write one step: claims and true positions ``(B, n)``, and what arcs are told ``(B, A)`` (NaN: as sent)."""
        n = self.nodes
        row[:, :n] = sent
        if row.shape[1] > n:
            row[:, n : 2 * n] = positions
        if self.byzantine:
            claims = sent[:, self.tails]
            row[:, 2 * n :] = claims if told is None else np.where(np.isnan(told), claims, told)


def board_for(graph: Digraph, active: frozenset[int], *, byzantine: bool) -> Board:
    """Return the layout for these actively sensing nodes; single arcs get channels when ``byzantine``."""
    heads = graph.heads
    tails = graph.in_indices.astype(np.int64)
    sees = np.isin(heads, list(active))
    claims = 2 * graph.n + np.arange(graph.arc_count) if byzantine else tails
    channel = np.where(sees, graph.n + tails, claims).astype(np.int64)
    return Board(channel, sees, tails, graph.n, byzantine)
