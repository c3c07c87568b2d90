"""Many unions that resemble each other: each distinct one decided once, and as far as possible without a search.

In this order, all exact:

1. *Equal*: a union seen before (same arcs, by SHA-256 of the packed marks) has its verdict.
2. *Pair*: a violating pair of an earlier union is re-checked on this one, in integers.
3. *Subgraph*: when the arcs that proved an earlier union robust are all here, this one is robust. Adding arcs
   only enlarges every ``X_S^r``, so each condition of the definition that held still holds.
4. *Growth*: an earlier seed still is robust and everything still grows from it (:mod:`robustness.time_varying.growth`).
   Seeds are searched for and tried as long as they settle about as many windows as they cost searches.
5. *Ahead*: where no seed shows up, the arcs that this union has in common with the next m are searched first.
   If they are robust, so are all these unions; m doubles when that works and halves when it does not.
6. *Exact* search through the front. What it finds, a pair or a proof, serves the unions that follow.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from robustness.decision.front import check_within
from robustness.digraph import Digraph
from robustness.evidence import Growth
from robustness.limits import Limits
from robustness.results import RobustnessResult, Verdict, Witness
from robustness.time_varying.growth import Arcs, Seed, find_seed, grow
from robustness.time_varying.results import UnionVerdict
from robustness.time_varying.sequence import SlidingUnion, TimeVaryingGraph

_Marks = npt.NDArray[np.bool_]

__all__ = ["RULES", "TIME_IS_UP", "UnionDecider"]

#: The reason of an UNDECIDED after the deadline.
TIME_IS_UP = "the time limit was reached"

#: The rules that save a search; ``reuse`` of the decider switches each on or off. The verdicts stay the same.
RULES = frozenset({"equal", "pair", "subgraph", "growth", "ahead"})

#: How many pairs, proofs and seeds are kept, most recently useful first.
_KEPT = 8

#: How many searches seeds may cost before the first has to have paid, and out of how many exact searches they get one.
_SEED_CREDIT, _SEED_SHARE = 64, 4

#: What one search may spend whose only use is to save others (about a second); how far ahead to look first and at most.
_EXTRA_STEPS = 1_000_000_000
_AHEAD_FIRST, _AHEAD_MOST = 4, 1024

#: The bare search is tried for so many steps (about a tenth of a second), on graphs of so many nodes, before the front
#: takes all its means.
_QUICK_STEPS, _QUICK_NODES = 100_000_000, range(19, 513)


class UnionDecider:
    """Decides (r,s)-robustness of unions of one sequence, learning from each for the next.

    Parameters
    ----------
    sequence : TimeVaryingGraph
        Whose arc universe the unions are marked in.
    r, s : int
        As for :func:`~robustness.decision.front.check_rs_robustness`.
    algorithm : str
        For the exact search.
    limits : Limits
        Of everything; past the deadline a union that needs a search is UNDECIDED.
    reuse : set of str
        Which of :data:`RULES` are on.
    """

    def __init__(
        self,
        sequence: TimeVaryingGraph,
        r: int,
        s: int,
        algorithm: str = "auto",
        limits: Limits | None = None,
        reuse: frozenset[str] = RULES,
    ) -> None:
        self.sequence, self.r, self.s = sequence, r, s
        self._algorithm, self._limits, self._reuse = algorithm, limits or Limits(), reuse
        heads, tails = np.divmod(sequence.arc_codes, max(sequence.n, 1))
        self._arcs = Arcs(sequence.n, heads, tails)
        self._verdicts: dict[bytes, UnionVerdict] = {}
        self._pairs: list[_Pair] = []
        self._proofs: list[_Proof] = []
        self._seeds: list[Seed] = []
        self._ahead_luck, self._ahead = _Luck(), 0
        #: Windows that growth settled, searches that seeds cost, and the exact searches of unions.
        self._grown = self._seed_searches = self._exact_searches = 0
        #: How often each rule settled a window, and how many searches were made for it.
        self.settled: Counter[str] = Counter()
        self.searches = 0

    def decide(self, window: SlidingUnion, *, known_robust: bool = False) -> tuple[bytes, UnionVerdict]:
        """Return a key that equal unions share, and the verdict on the union of ``window``.

        ``known_robust`` says that a shorter window with the same start is robust; then no search is made.
        """
        present = window.present
        key = hashlib.sha256(np.packbits(present).tobytes()).digest()
        found = self._verdicts.get(key) if "equal" in self._reuse else None
        if found is not None and not (known_robust and found.verdict is Verdict.UNDECIDED):
            self.settled["equal"] += 1
            return key, found
        verdict = self._from_earlier(window, present)
        if verdict is None and known_robust:
            verdict = UnionVerdict(Verdict.ROBUST, "shorter-window")
        elif verdict is None:
            verdict = self._from_common_arcs(window) or self._search(window, present)
        self.settled[verdict.rule if verdict.verdict is not Verdict.UNDECIDED else "undecided"] += 1
        self._verdicts[key] = verdict
        return key, verdict

    def _from_earlier(self, window: SlidingUnion, present: _Marks) -> UnionVerdict | None:
        """Return the verdict if a pair, a proof or a seed of an earlier union settles this one."""
        for pair in self._pairs:
            if pair.violates(present, self.r, self.s):
                _keep(self._pairs, pair)
                return UnionVerdict(Verdict.NOT_ROBUST, "pair", pair.witness)
        for proof in self._proofs:
            if present[proof.places].all():
                _keep(self._proofs, proof)
                self._grown += proof.grown
                return UnionVerdict(Verdict.ROBUST, "subgraph", growth=proof.evidence)
        for seed in self._seeds if self._seeds_pay() else ():
            if (growth := self._grow(window, present, seed)) is not None:
                _keep(self._seeds, seed)
                self._grown += 1
                return UnionVerdict(Verdict.ROBUST, "growth", growth=growth.evidence)
        return None

    def _seeds_pay(self) -> bool:
        """Return whether seeds have earned what they cost, so that where nothing lasts they cost little for nothing."""
        earned = _SEED_CREDIT + self._grown + self._exact_searches // _SEED_SHARE
        return self._seed_searches <= earned

    def _grow(self, window: SlidingUnion, present: _Marks, seed: Seed) -> _Proof | None:
        """Return the arcs that prove growth from ``seed`` if there is one, and keep them."""
        grown = grow(self._arcs, present, seed, self.r + self.s - 1, window.last) if seed.robust(present) else None
        if grown is None:
            return None
        order, core = grown
        kind = seed.proof(present, self.r)
        evidence = kind and Growth(self.r, self.s, seed.members, np.array(order, dtype=np.int32), kind)
        proof = _Proof(core, evidence, grown=True)
        if "subgraph" in self._reuse:
            # Of the arcs that would do, those that stay longest were taken.
            _keep(self._proofs, proof)
        return proof

    def _from_common_arcs(self, window: SlidingUnion) -> UnionVerdict | None:
        """Return ROBUST if the arcs that this union shares with the next ones are already enough."""
        if not self._ahead or not self._ahead_luck.tries():
            return None
        common = window.lasting(self._ahead)
        refuted = any(pair.violates(common, self.r, self.s) for pair in self._pairs)
        worked = not refuted and self._extra_search(self.sequence.digraph(common)) is Verdict.ROBUST
        self._ahead_luck.note(worked)
        self._ahead = min(2 * self._ahead, _AHEAD_MOST) if worked else max(1, self._ahead // 2)
        if not worked:
            return None
        _keep(self._proofs, _Proof(np.flatnonzero(common), None))
        return UnionVerdict(Verdict.ROBUST, "subgraph")

    def _search(self, window: SlidingUnion, present: _Marks) -> UnionVerdict:
        """Decide the union through the front, and keep what was found for the next ones."""
        if self._limits.expired():
            return UnionVerdict(Verdict.UNDECIDED, "exact", reason=TIME_IS_UP)
        self.searches += 1
        self._exact_searches += 1
        graph = self.sequence.digraph(present)
        result = self._ask(graph, self._limits)
        if result.witness is not None and "pair" in self._reuse:
            _keep(self._pairs, _Pair(graph, self._arcs, result.witness))
        growth = self._learn(window, present) if result.verdict is Verdict.ROBUST else None
        reason = str(result.stats.get("reason", TIME_IS_UP)) if result.verdict is Verdict.UNDECIDED else ""
        return UnionVerdict(result.verdict, "exact", result.witness, growth, result.algorithm, reason)

    def _learn(self, window: SlidingUnion, present: _Marks) -> Growth | None:
        """Look for a seed of a union that is robust; without one, all its arcs are the proof to reuse."""
        if "growth" in self._reuse and self._seeds_pay():
            seed = find_seed(self._arcs, present, self.r, self.s, self._is_robust_seed)
            growth = None if seed is None else self._grow(window, present, seed)
            if seed is not None and growth is not None:
                _keep(self._seeds, seed)
                return growth.evidence
        if "subgraph" in self._reuse:
            _keep(self._proofs, _Proof(np.flatnonzero(present), None))
            if "ahead" in self._reuse:
                self._ahead = self._ahead or _AHEAD_FIRST
        return None

    def _is_robust_seed(self, graph: Digraph) -> bool:
        self._seed_searches += 1
        return self._extra_search(graph) is Verdict.ROBUST

    def _extra_search(self, graph: Digraph) -> Verdict:
        """Return the verdict on a graph that is no union itself; it may take a moment only."""
        if self._limits.expired():
            return Verdict.UNDECIDED
        self.searches += 1
        return self._ask(graph, self._limits.counted(_EXTRA_STEPS)).verdict

    def _ask(self, graph: Digraph, limits: Limits) -> RobustnessResult:
        """Decide through the front; ``auto`` tries the bare search first.

        The front's cheap bounds look for what the earlier unions have taught already, and on graphs of middling size
        they take far longer than most searches.
        """
        if self._algorithm == "auto" and graph.n in _QUICK_NODES:
            quick = check_within(graph, self.r, self.s, limits.counted(_QUICK_STEPS), "subset-search")
            if quick.verdict is not Verdict.UNDECIDED or limits.expired():
                return quick
        return check_within(graph, self.r, self.s, limits, self._algorithm)

    def expired(self) -> bool:
        """Return whether the deadline has passed."""
        return self._limits.expired()


class _Luck:
    """Whether to try again what may save work: always while it works, ever more rarely while it fails."""

    def __init__(self) -> None:
        self._failures = self._wait = 0

    def tries(self) -> bool:
        """Return whether it is time for another try. Every call that says no counts as one step of the wait."""
        self._wait -= 1
        return self._wait < 0

    def note(self, worked: bool) -> None:
        """Note how the try went."""
        self._failures = 0 if worked else self._failures + 1
        self._wait = 0 if worked else 2 ** min(self._failures - 1, 10) - 1


@dataclass(frozen=True, slots=True, eq=False)
class _Proof:
    """Arcs, as places in the universe, that are enough to be robust.

    ``grown`` says that they come from a seed; ``evidence`` is that growth, if a certificate can carry it.
    """

    places: npt.NDArray[np.int64]
    evidence: Growth | None
    grown: bool = False


class _Pair:
    """A violating pair, ready to be re-checked: for each side the arcs that enter it from outside."""

    def __init__(self, graph: Digraph, arcs: Arcs, witness: Witness) -> None:
        self.witness = witness
        self._sides = []
        for labels in witness:
            inside = np.zeros(arcs.n, dtype=bool)
            inside[list(graph.ids(labels))] = True
            places = np.flatnonzero(inside[arcs.heads] & ~inside[arcs.tails])
            rank = np.cumsum(inside) - 1
            self._sides.append((places, rank[arcs.heads[places]], int(inside.sum())))

    def violates(self, present: _Marks, r: int, s: int) -> bool:
        """Return whether the pair violates (r,s)-robustness of the union: the definition, in integers."""
        reachable = 0
        for places, heads, size in self._sides:
            heard = np.bincount(heads[present[places]], minlength=size)
            here = int(np.count_nonzero(heard >= r))
            if here == size:
                return False
            reachable += here
        return reachable < s


_Item = TypeVar("_Item")


def _keep(items: list[_Item], item: _Item) -> None:
    """Put ``item`` first; forget the ones that have been useless for longest."""
    if item in items:
        items.remove(item)
    items.insert(0, item)
    del items[_KEPT:]
