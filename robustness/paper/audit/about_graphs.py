"""Claims about which graphs promise agreement and which have an attack: decided by search over all small ones."""

from __future__ import annotations

from itertools import combinations

from robustness.constructions.families import complete
from robustness.constructions.lemma_1 import profile
from robustness.decision.front import check_rs_robustness
from robustness.definitions import r_reachable_ids
from robustness.digraph import Digraph, as_digraph
from robustness.paper.audit.claims import (
    Claim,
    Outcome,
    example,
    failing,
    holding,
    marked,
    robust,
    sharper,
    small_graphs,
    trapped,
)
from robustness.spelled import counted
from robustness.traps import is_trap

__all__ = ["CLAIMS"]

_LARGEST_F = 3


def _incoming_anywhere(graph: Digraph) -> str | None:
    """The proof's reading of X without "from outside": all nodes of in-degree f + 1 or more."""
    for f in range(1, graph.n):
        pair = check_rs_robustness(graph, f + 1, f + 1).witness if f < graph.n else None
        if pair is None:
            continue
        sides = [graph.ids(side) for side in pair]
        literal = [i for side in sides for i in side if graph.in_degrees[i] >= f + 1]
        meant = sum(len(r_reachable_ids(graph, side, f + 1)) for side in sides)
        if len(literal) > f:
            many, links = counted(len(literal), "node"), counted(f + 1, "incoming link")
            return f"f = {f}: {many} have {links}, {meant} have them from outside"
    return None


def _trap_implied_by_violation(graph: Digraph) -> str | None:
    for f in range(_LARGEST_F + 1):
        if f < graph.n and not robust(graph, f + 1, f + 1) and not trapped(graph, f):
            return f"f = {f}: not ({f + 1},{f + 1})-robust, without a trap"
    return None


def _robust_and_trapped(graph: Digraph) -> str | None:
    for f in range(1, _LARGEST_F + 1):
        if robust(graph, f + 1, f + 1) and trapped(graph, f):
            return f"f = {f}: ({f + 1},{f + 1})-robust, with a trap"
    return None


def _twice_robust_and_trapped(local: bool) -> Outcome:
    def refute(graph: Digraph) -> str | None:
        for f in range(_LARGEST_F + 1):
            if robust(graph, 2 * f + 1) and trapped(graph, f, local):
                return f"{2 * f + 1}-robust, with a trap for f = {f}"
        return None

    return holding(refute)


def _gap_without_trap() -> Outcome:
    for graph in small_graphs():
        for f in range(1, _LARGEST_F + 1):
            if not robust(graph, 2 * f + 1) and not trapped(graph, f):
                note = f"f = {f}: not {2 * f + 1}-robust, and no trap either: (2f+1)-robustness is not necessary"
                return Outcome("fails", "search, smallest first", note, graph)
    return Outcome("holds", "search, smallest first")


def _fewer_liars(graph: Digraph) -> str | None:
    """What withstands f withstands f - 1: promises and traps are monotone."""
    for f in range(1, _LARGEST_F + 1):
        if robust(graph, 2 * f + 1) and not robust(graph, 2 * f - 1):
            return f"promised f = {f}, but not f = {f - 1}"
        if not trapped(graph, f) and trapped(graph, f - 1):
            return f"a trap for f = {f - 1}, but none for f = {f}"
    return None


def _misled_for_ever(graph: Digraph) -> str | None:
    for f in (1, 2):
        if robust(graph, f + 1) and trapped(graph, f):
            return f"f = {f}: {f + 1}-robust, with a trap for {counted(f, 'liar')}"
    return None


def _split_without_liars(graph: Digraph) -> str | None:
    """Without a liar, a graph that is not (f+1)-robust is split by what vehicles discard."""
    for f in range(_LARGEST_F + 1):
        pair = check_rs_robustness(graph, f + 1).witness
        if pair is not None and not is_trap(graph, f, (), pair.S1, pair.S2):
            return f"f = {f}: not {f + 1}-robust, but nobody is held"
    return None


def _rooted_without_liars(graph: Digraph) -> str | None:
    table = profile(graph)
    for f in range(1, len(table) - 1):
        for size in range(f + 1) if table[f + 1] >= f + 1 else ():
            for bad in combinations(range(graph.n), size):
                if graph.n - size >= 2 and not robust(graph.without(frozenset(bad)), 1):
                    return f"({f + 1},{f + 1})-robust, but without {set(bad)} no node reaches all"
    return None


def _complete_graphs() -> Outcome:
    """K_{3f+1} is between the conditions and has no trap."""
    for f in (1, 2, 3):
        graph = as_digraph(complete(3 * f + 1))
        if not robust(graph, f + 1, f + 1) or robust(graph, 2 * f + 1) or trapped(graph, f):
            return Outcome("fails", "search, f = 1, 2, 3", f"f = {f}", graph)
    return Outcome("holds", "search, f = 1, 2, 3", "the smallest is K_4 with f = 1", as_digraph(complete(4)))


#: Claims of this kind.
CLAIMS: tuple[Claim, ...] = (
    Claim(
        "Theorem 1, proof",
        "X are the nodes with at least f+1 incoming links",
        lambda: failing(_incoming_anywhere, "it must be links from outside the set", "holds corrected"),
    ),
    Claim(
        "Theorem 1",
        "(f+1,f+1)-robustness is necessary under delays",
        lambda: holding(_trap_implied_by_violation),
    ),
    Claim(
        "Theorem 1",
        "(f+1,f+1)-robustness suffices under delays (nobody says so; the gap)",
        lambda: marked(failing(_robust_and_trapped, "a trap splits it")),
        False,
    ),
    Claim(
        "Theorem 1",
        "(2f+1)-robust graphs have no trap: sufficiency does not contradict the sharper condition",
        lambda: _twice_robust_and_trapped(local=False),
        False,
    ),
    Claim(
        "Theorem 1",
        "(2f+1)-robustness is necessary as well: every other graph has a trap",
        _gap_without_trap,
        False,
    ),
    Claim(
        "Conclusion",
        "a condition that is both necessary and sufficient is left to find",
        lambda: Outcome(
            "answered",
            "proof in docs/theorems.md; the rows on Theorem 1, the census below",
            "no trap for f: without any f nodes the graph is (f+1)-robust. Necessary for all gains, sufficient for "
            "gains "
            "in their region",
        ),
    ),
    Claim("Theorem 1", "K_n with n = 3f+1 lies in the gap and has no trap", _complete_graphs, False),
    Claim(
        "Introduction",
        "f need only be an upper bound on the number of malicious vehicles",
        lambda: sharper("holds", _fewer_liars, "but an f that is too large splits: see below, after Theorem 1"),
    ),
    Claim(
        "Section 3.1",
        "misbehaviour only makes convergence longer, whatever it is",
        lambda: marked(
            failing(_misled_for_ever, "on (2f+1)-robust graphs; elsewhere it can last for ever", "holds corrected")
        ),
    ),
    Claim(
        "after Theorem 1",
        "a spanning tree is necessary even when nobody misleads",
        lambda: sharper(
            "holds", _split_without_liars, "sharper: (f+1)-robustness is, since vehicles discard f values either way"
        ),
    ),
    Claim(
        "after Theorem 1",
        "delays give malicious vehicles more freedom than they have without",
        lambda: marked(example(_robust_and_trapped)),
    ),
    Claim(
        "Section 3.2, normal vehicles",
        "normal vehicles alone have a spanning tree, if the graph is (f+1,f+1)-robust",
        lambda: holding(_rooted_without_liars),
    ),
    Claim(
        "Corollary 1",
        "(2f+1)-robust graphs have no f-local trap either",
        lambda: _twice_robust_and_trapped(local=True),
        False,
    ),
)
