"""What settles a question about traps without a search, each by a lemma."""

from __future__ import annotations

from robustness import answers
from robustness.decision.ladder import settle_quickly
from robustness.definitions import largest_conceivable_r, r_reachable_ids
from robustness.digraph import Digraph
from robustness.limits import Limits
from robustness.traps.question import Question, Sets, TrapAnswer

__all__ = ["settle_trap"]


def settle_trap(
    graph: Digraph, question: Question, limits: Limits, settle: answers.Rung = settle_quickly
) -> TrapAnswer | None:
    """Return a solution, or that there is none, with the lemma that settles it; None when no lemma does.

    ``settle`` answers questions about (r,s)-robustness at little cost, or says None; whoever asks about many traps of
    one graph remembers what it said.
    """
    if graph.n < 2:
        return TrapAnswer.by_lemma(None, "fewer than two nodes: nobody to hold apart")
    for lemma in (_few_nodes, _low_degree, _high_degree):
        settled = lemma(graph, question)
        if settled is not None:
            return settled
    return _by_robustness(graph, question, limits, settle)


def _few_nodes(graph: Digraph, question: Question) -> TrapAnswer | None:
    """For ``f >= 1``, ``n <= 3f`` with two faces and ``n <= 2f`` with one: halves of at most f nodes each.

    With two faces f nodes (or all but two) are malicious, with one face nobody: a node of a half hears at most the
    other half, which is at most f.
    """
    f, two_faces, _ = question
    if f < 1 or graph.n > (3 * f if two_faces else 2 * f):
        return None
    bad = min(f, graph.n - 2) if two_faces else 0
    half = (graph.n - bad) // 2
    sets = Sets(frozenset(range(bad)), frozenset(range(bad, bad + half)), frozenset(range(bad + half, graph.n)))
    return TrapAnswer.by_lemma(sets, f"n <= {3 if two_faces else 2}f")


def _low_degree(graph: Digraph, question: Question) -> TrapAnswer | None:
    """For ``f >= 1`` and a node v of in-degree at most 2f: N1 = {v}, M ``d_v - f`` of its in-neighbours, N2 the rest.

    v hears f nodes that are not malicious; every other node hears only v from outside. N2 is nonempty:
    ``n - 1 - (d_v - f) >= f >= 1``. Hence every graph without a trap has in-degrees of at least 2f + 1.
    """
    f, two_faces, _ = question
    if f < 1 or not two_faces:
        return None
    node = int(graph.in_degrees.argmin())
    heard = graph.in_neighbours(node).tolist()
    if len(heard) > 2 * f:
        return None
    bad = frozenset(heard[: max(0, len(heard) - f)])
    rest = frozenset(range(graph.n)) - bad - {node}
    return TrapAnswer.by_lemma(Sets(bad, frozenset([node]), rest), "a node of in-degree at most 2f")


def _high_degree(graph: Digraph, question: Question) -> TrapAnswer | None:
    """In-degrees of ``floor((n-f)/2) + 2f`` (two faces) or ``floor(n/2) + f`` (one) leave no trap, whatever bounds M.

    Two faces: without M, of m nodes, the smaller of N1 and N2 has at most ``floor((n-m)/2)``; a node there loses at
    most ``min(m, f)`` in-neighbours to M, so it hears ``d - min(m, f) - floor((n-m)/2) + 1`` outside ``N_k | M``. That
    is least for m = f, and then at least f + 1. One face: every node of the smaller of S1 and S2 hears at least
    ``d - floor(n/2) + 1 >= f + 1`` outside, so none of them is normal.
    """
    f, two_faces, _ = question
    enough = max(0, graph.n - f) // 2 + 2 * f if two_faces else graph.n // 2 + f
    if int(graph.in_degrees.min()) < enough:
        return None
    return TrapAnswer.by_lemma(None, f"in-degrees of at least {enough}")


def _by_robustness(graph: Digraph, question: Question, limits: Limits, settle: answers.Rung) -> TrapAnswer | None:
    """(2f+1)-robust: none. A violation of (f+1)- or (f+1,f+1)-robustness: one. As far as ``settle`` tells."""
    f, highest = question.f, largest_conceivable_r(graph.n)
    for r, s in ((2 * f + 1, 1), (f + 1, 1), (f + 1, f + 1)):
        if r > highest or limits.expired():
            continue
        settled = settle(answers.Question(graph, r, s), limits)
        if settled is None:
            continue
        if settled.verdict is answers.Verdict.ROBUST and r == 2 * f + 1:
            return TrapAnswer.by_lemma(None, f"{r}-robust, so no trap for f = {f}")
        if settled.pair is not None and r == f + 1:
            S1, S2 = settled.pair
            bad = r_reachable_ids(graph, S1, r) | r_reachable_ids(graph, S2, r)
            found = Sets(bad, S1 - bad, S2 - bad) if question.two_faces else Sets(bad, S1, S2)
            rule = f"not ({r},{r})-robust" if bad else f"not {r}-robust: nobody need be malicious"
            return TrapAnswer.by_lemma(found, rule)
    return None
