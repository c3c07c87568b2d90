r"""The whole robustness profile by a subset-minimum transform: every node set once instead of every pair.

Idea (ours). For a node set S let ``c(S) = |X_S^r|``, or infinity when ``X_S^r = S`` (so also for the empty set).
A pair violates (r,s)-robustness iff ``c(S1) + c(S2) <= s - 1``. With ``M(T) = min { c(S) : S subset of T }``,

    s_max(r) = min over S of c(S) + M(V \ S),   or n when that is infinite,

because s_max(r) is the least ``|X_S1| + |X_S2|`` over the disjoint pairs in which neither side is fully reachable.
M comes from c by the subset-minimum (zeta) transform: one pass per node v, ``M(T) <- min(M(T), M(T - v))`` for all T
that hold v. This is ``O(n 2^n)`` per r, where the definition needs ``O(3^n)``.

A node set is a bit mask used as an array index. Swapping S1 and S2 changes nothing, so S need only run over the sets
without the last node; only their c is kept beside M, which makes ``1.5 * 2^n`` bytes in all.

The numpy passes work on blocks of ``2^16`` sets, which stay in the cache. For a block, the high part h of all masks is
fixed: node i of S has at least r in-neighbours outside S iff ``|N_i & low part| <= d_i - r - |N_i & h|``, one
comparison of a precomputed table with a constant. Between blocks the deadline and Ctrl-C are honoured.
"""

from __future__ import annotations

import os
from pathlib import Path
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from robustness.answers import Answer
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph
from robustness.errors import Undecided
from robustness.evidence import Exhausted, Pair
from robustness.limits import Limits, Progress
from robustness.results import Bound, Bounds
from robustness.spelled import counted

__all__ = ["available_memory", "decide", "largest_s", "memory_needed", "memory_suffices", "profile"]

_Bytes = npt.NDArray[np.uint8]

#: 2^16 one-byte counts fit the level-2 cache together with a buffer and the tables of a few nodes.
_BLOCK_BITS = 16
#: "No such set": greater than every count, and twice this still fits a byte.
_INFINITE = 127
#: Below this many contiguous bytes a masked full-width pass beats numpy's strided one (measured).
_SMALL_STRIDE = 64
#: Part of the available memory that may be taken.
_SHARE = 0.8
#: What is assumed to be available where the operating system does not say.
_UNKNOWN_MEMORY = 1 << 30


def decide(graph: Digraph, r: int, s: int, limits: Limits) -> Answer:
    """Decide (r,s)-robustness of a digraph by one subset-minimum transform.

    Parameters
    ----------
    graph : Digraph
        Any digraph with at least two nodes.
    r, s : int
        ``r >= 1`` and ``1 <= s <= n``.
    limits : Limits
        The deadline is looked at after every block of 65,536 sets; ``jobs`` and ``seed`` change nothing.

    Returns
    -------
    Answer
        ROBUST, NOT_ROBUST with a pair that has the least ``|X_S1| + |X_S2|`` of all; UNDECIDED when the deadline
        passed or when the memory needed (see :func:`memory_needed`) is not available, decided before allocating.

    Notes
    -----
    Time ``O(n 2^n)``, memory ``1.5 * 2^n`` bytes.

    >>> import networkx as nx
    >>> decide(Digraph.from_networkx(nx.cycle_graph(6)), 2, 1, Limits()).verdict
    <Verdict.NOT_ROBUST: 'not-robust'>
    """
    try:
        greatest, pair = largest_s(graph, r, limits)
    except Undecided as limit:
        return Answer.undecided(str(limit), {"sets": 0})
    stats = {"sets": 1 << graph.n}
    if pair is None or greatest >= s:
        return Answer(Exhausted(), stats)
    return Answer.violated_by(pair, stats)


def largest_s(graph: Digraph, r: int, limits: Limits) -> tuple[int, Pair | None]:
    """Return s_max(r), at most n, and a pair with so few exempt nodes; None when no pair violates (r,s) for any s.

    Takes, costs and raises what :func:`profile` does, for one r.
    """
    lattice = _Lattice(graph, limits)
    total, first = lattice.least_exempt(r)
    if total >= graph.n:
        return graph.n, None
    second = lattice.least_subset(((1 << graph.n) - 1) ^ first)
    return total, Pair(_ids(lattice.least_subset(first)), _ids(second))


def profile(graph: Digraph, limits: Limits) -> dict[int, int]:
    """Return ``r -> s_max(r)`` for r = 1 .. ceil(n/2) of any digraph, one transform for every r up to r* + 1.

    Parameters
    ----------
    graph : Digraph
        Any digraph. The empty graph has the empty profile; one node has ``{1: 1}`` by convention.
    limits : Limits
        As for :func:`decide`.

    Raises
    ------
    Undecided
        When the deadline passed or the memory needed is not available; with the part of the profile that is proven.

    Notes
    -----
    Once s_max(r) is 0 it is 0 for every greater r, since (r+1,s)-robust implies (r,s)-robust.

    >>> import networkx as nx
    >>> profile(Digraph.from_networkx(nx.wheel_graph(5)), Limits())
    {1: 5, 2: 5, 3: 0}
    """
    if graph.n < 2:
        return dict.fromkeys(range(1, graph.n + 1), 1)
    lattice = _Lattice(graph, limits)
    table: dict[int, int] = {}
    most = graph.n
    for r in range(1, largest_conceivable_r(graph.n) + 1):
        try:
            most = table[r] = min(lattice.least_exempt(r)[0], graph.n) if most else 0
        except Undecided as limit:
            implied = Bounds(Bound(0, "nothing proven yet"), Bound(most, f"s_max({r - 1})" if table else "s_max <= n"))
            raise Undecided(str(limit), bounds=implied, profile=MappingProxyType(table)) from None
    return table


def memory_needed(n: int) -> int:
    """Return the bytes the transform allocates for n nodes: M, half of c, and the block's tables and buffers."""
    tables = n + 16  # one-byte tables per node; small strides, sizes, buffers and the temporaries of building them
    return (1 << n) + (1 << max(n - 1, 0)) + tables * (1 << min(n, _BLOCK_BITS))


def available_memory() -> int:
    """Return the bytes this process may still allocate without swapping, as far as the system says.

    Linux: ``MemAvailable`` of /proc/meminfo, and no more than what a version 2 control group leaves. Elsewhere:
    all of the physical memory that ``os.sysconf`` reports, or else 1 GiB.
    """
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        free = next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))
    except (OSError, ValueError, StopIteration):
        try:
            free = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
        except (AttributeError, ValueError, OSError):
            free = _UNKNOWN_MEMORY
    try:
        group = Path("/sys/fs/cgroup")
        used, most = (int((group / name).read_text(encoding="ascii")) for name in ("memory.current", "memory.max"))
        free = min(free, max(0, most - used))
    except (OSError, ValueError):
        pass  # No control group, or one without a limit ("max").
    return free


class _Lattice:
    """The arrays over all node sets, and the passes over them."""

    def __init__(self, graph: Digraph, limits: Limits) -> None:
        """Guarantees that the memory is there before it is taken; raises Undecided otherwise."""
        _require_memory(graph.n)
        self.n, self.hears, self.limits = graph.n, graph.in_masks, limits
        self.low_bits = min(graph.n, _BLOCK_BITS)
        block = 1 << self.low_bits
        low = np.arange(block, dtype=np.uint32)
        self.size = np.bitwise_count(low)
        # heard[i] = |N_i & low|, or 255, which no threshold reaches, where low does not hold i.
        self.heard = [np.bitwise_count(low & np.uint32(mask & (block - 1))) for mask in self.hears]
        for i in range(self.low_bits):
            self.heard[i][(low >> np.uint32(i)) & np.uint32(1) == 0] = 255
        self.without = [
            np.where((low >> np.uint32(i)) & np.uint32(1) == 0, 255, 0).astype(np.uint8)
            for i in range(min(self.low_bits, _SMALL_STRIDE.bit_length()))
        ]
        self.buffer = np.empty(block, dtype=np.uint8)
        self.hits = np.empty(block, dtype=np.bool_)
        #: c, then M. Row h holds the sets whose high part is h.
        self.least = np.empty((1 << (graph.n - self.low_bits), block), dtype=np.uint8)
        #: c of the sets without the last node.
        self.count = np.empty(1 << (graph.n - 1), dtype=np.uint8)

    def least_exempt(self, r: int) -> tuple[int, int]:
        r"""Return the least ``c(S) + M(V \ S)`` (at least 127 when infinite) and the first S that has it."""
        flat, half = self.least.reshape(-1), len(self.count)
        for row in range(len(self.least)):
            self._pause(row, f"r = {r}: reachable nodes of every set")
            self._count_reachable(row, r)
            start = row << self.low_bits
            kept = self.count[start : start + self.least.shape[1]]
            kept[:] = self.least[row, : len(kept)]
            self._spread_low(self.least[row])
        for bit in range(self.n - self.low_bits):
            self._spread_high(1 << bit)
        best, found = 2 * _INFINITE, 0
        upper = flat[half:][::-1]  # V \ S is the mirror image of S, and holds the last node when S does not.
        for start in range(0, half, 1 << self.low_bits):
            self._pause(start >> self.low_bits, f"r = {r}: best pair")
            piece = slice(start, min(start + (1 << self.low_bits), half))
            total = np.add(self.count[piece], upper[piece], out=self.buffer[: piece.stop - start])
            place = int(total.argmin())
            if total[place] < best:
                best, found = int(total[place]), start + place
        return best, found

    def least_subset(self, members: int) -> int:
        """Return an inclusion-minimal S within ``members`` with ``M(S) = M(members)``; then c(S) is M(S) too."""
        flat = self.least.reshape(-1)
        for i in range(self.n):
            without = members & ~(1 << i)
            if flat[without] == flat[members]:
                members = without
        return members

    def _count_reachable(self, row: int, r: int) -> None:
        """Write c of every set of one block."""
        count, hits = self.least[row], self.hits
        count[:] = 0
        for i, mask in enumerate(self.hears):
            if i >= self.low_bits and not row >> (i - self.low_bits) & 1:
                continue
            most = mask.bit_count() - r - (mask >> self.low_bits & row).bit_count()
            if most >= 0:
                np.less_equal(self.heard[i], most, out=hits)
                np.add(count, hits.view(np.uint8), out=count)
        np.equal(count, self.size + np.uint8(row.bit_count()), out=hits)
        np.multiply(hits.view(np.uint8), _INFINITE, out=self.buffer)
        np.maximum(count, self.buffer, out=count)

    def _spread_low(self, least: _Bytes) -> None:
        """Transform one block along its low bits."""
        for bit in range(self.low_bits):
            stride = 1 << bit
            if stride <= _SMALL_STRIDE:
                # All sets shifted by one bit; 255 where the shift does not remove node ``bit`` from the set.
                shifted = np.bitwise_or(least[:-stride], self.without[bit][stride:], out=self.buffer[stride:])
                np.minimum(least[stride:], shifted, out=least[stride:])
            else:
                halves = least.reshape(-1, 2, stride)
                np.minimum(halves[:, 1], halves[:, 0], out=halves[:, 1])

    def _spread_high(self, stride: int) -> None:
        """Transform all blocks along one high bit."""
        for row in range(len(self.least)):
            if row & stride:
                self._pause(row, "subset minimum")
                np.minimum(self.least[row], self.least[row - stride], out=self.least[row])

    def _pause(self, block: int, note: str) -> None:
        if self.limits.expired():
            raise Undecided("the time limit was reached: raise it")
        if self.limits.progress is not None and block & 127 == 127:
            self.limits.progress(Progress(block << self.low_bits, note))


def memory_suffices(n: int) -> bool:
    """Return whether the memory for n nodes is there now."""
    # 2^60 bytes exist nowhere; beyond, the estimate itself would be a huge integer.
    return n <= 60 and memory_needed(n) <= available_memory() * _SHARE


def _require_memory(n: int) -> None:
    if not memory_suffices(n):
        raise Undecided(
            f"the transform needs 1.5 * 2^{n} bytes for {counted(n, 'node')}, more than {_SHARE:.0%} of the memory "
            "available: use subset-search"
        )


def _ids(mask: int) -> frozenset[int]:
    return frozenset(i for i in range(mask.bit_length()) if mask >> i & 1)
