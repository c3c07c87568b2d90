"""Certificates from derivations: a graph made by operations is proven robust by its seed and the steps.

The certificate names the seed, a proof for it, and every step; the kernel carries the steps out again and compares.
No search is needed for the graph that was made, however large it is.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

from certificates import verify
from certificates.graph import Label, label_key
from robustness.answers import Question, Verdict
from robustness.constructions.guarantee import Guarantee, Guaranteed
from robustness.constructions.operations import carry_out, r_beside_clique, replay
from robustness.decision.certification import direct_evidence, encode
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InternalError, InvalidParameter, Undecided
from robustness.limits import Limits
from robustness.results import RobustnessResult

__all__ = ["certify_derivation"]

_Step = dict[str, Any]
_Arcs = set[tuple[Label, Label]]


def certify_derivation(
    guarantee: Guarantee,
    seeds: Iterable[GraphLike],
    r: int | None = None,
    s: int | None = None,
    *,
    time_limit: float | None = None,
) -> RobustnessResult:
    """Return a verified certificate of what a derivation guarantees.

    Parameters
    ----------
    guarantee : Guarantee
        What an operation returned, or :meth:`Guarantee.from_dict`.
    seeds : iterable of graphs
        The graphs that the leaves, the ``"checked"`` ones, speak about. Only these are searched.
    r, s : int, optional
        What to claim; by default the pair guaranteed. It has to follow from that by Lemma 1 (i) and (ii).
    time_limit : float, optional
        Seconds for the proof of the seed.

    Returns
    -------
    RobustnessResult
        ROBUST, with the ``certificate``; verify it with the canonical bytes of the graph that was made.

    Raises
    ------
    InvalidParameter
        When a seed is missing, a step does not give what the derivation says, (r,s) does not follow, or some r is 0.
    Undecided
        When no proof of the seed was found, for instance within the time limit.
    MalformedCertificate
        When the derivation makes a graph beyond the limits of the format.

    >>> import networkx as nx
    >>> from robustness.constructions import blow_up, guaranteed
    >>> seed = nx.cycle_graph(6)
    >>> made = blow_up(guaranteed(seed), 3)
    >>> certify_derivation(made.guarantee, [seed]).summary()
    '3-robust'
    """
    started = time.monotonic()
    by_digest = {graph.sha256: graph for graph in map(as_digraph, seeds)}
    r, s = guarantee.r if r is None else r, guarantee.s if s is None else s
    if r < 1 or s < 1 or not guarantee.implies(r, s):
        raise InvalidParameter(f"({r},{s}) does not follow from {guarantee}, or needs no proof")
    chain = [guarantee]
    while (last := chain[-1]).rule != "checked":
        chain.append(_best_premise(last))
    if min(each.r for each in chain) < 1:
        raise InvalidParameter(
            "the derivation passes through (0,s), which every graph has: it proves nothing from there"
        )
    leaf = chain.pop()
    if leaf.sha256 not in by_digest:
        raise InvalidParameter(f"the seed graph {leaf.sha256[:12]} is missing: give it in seeds")
    seed = by_digest[leaf.sha256]
    proof = direct_evidence(Question(seed, leaf.r, leaf.s), Limits.of(time_limit))
    if proof is None:
        why = "it is not, or the time limit is too short"
        raise Undecided(f"no proof was found that the seed is ({leaf.r},{leaf.s})-robust: {why}")
    made, nodes, steps = Guaranteed(seed.to_networkx(), leaf), list(seed.labels), list[_Step]()
    for each in reversed(chain):
        before, base = as_digraph(made.graph), made.guarantee
        best = _best_premise(each)
        premises = [made if premise is best else replay(premise, by_digest.values()) for premise in each.premises]
        made = carry_out(each, premises)
        steps += _steps(each, base, before, as_digraph(made.graph), nodes)
    graph = as_digraph(made.graph)
    evidence = {
        "kind": "derivation",
        "seed": {"nodes": seed.n, "arcs": [list(arc) for arc in seed.arcs()], "r": leaf.r, "s": leaf.s},
        "proof": proof[0],
        "steps": steps,
        "ids": [graph.index[label] for label in nodes],
    }
    certificate = encode(graph, r, s, Verdict.ROBUST, (evidence, proof[1]))
    claim = verify(graph.canonical_bytes(), certificate)
    if (claim.verdict, claim.r, claim.s) != ("robust", r, s):
        raise InternalError(f"the certificate proves {claim}, not ({r},{s})-robustness: please report")
    seconds = time.monotonic() - started
    return RobustnessResult(
        Verdict.ROBUST,
        r,
        s,
        algorithm="derivation",
        certificate=certificate,
        stats={"steps": len(steps)},
        seconds=seconds,
    )


def _best_premise(guarantee: Guarantee) -> Guarantee:
    """Return the premise that the conclusion is drawn from: the only one, or of a union the better one."""
    return max(guarantee.premises, key=lambda premise: (premise.r, premise.s))


def _steps(conclusion: Guarantee, base: Guarantee, before: Digraph, after: Digraph, nodes: list[Label]) -> list[_Step]:
    """Return the kernel's steps from ``before`` to ``after``; ``nodes``, in the kernel's numbering, is kept in step."""
    match conclusion.rule:
        case "weaken":
            return [_weaken(conclusion)]
        case "remove-nodes":
            gone = [i for i, label in enumerate(nodes) if label not in after.index]
            nodes[:] = [label for label in nodes if label in after.index]
            steps = [{"rule": "remove-nodes", "nodes": gone}]
            # The operation cuts r and s to what few nodes can have; the kernel's rule does not, and the next step of
            # the derivation was made for the pair that was cut.
            if (conclusion.r, conclusion.s) != (base.r - _most_lost(before, after), base.s):
                steps.append(_weaken(conclusion))
            return steps
        case "blow-up":
            copies, cliques = (conclusion.parameters[name] for name in ("copies", "cliques"))
            nodes[:] = [(label, copy) for label in nodes for copy in range(copies)]
            return [{"rule": "blow-up", "copies": copies, "cliques": cliques}]
        case "join-clique" if (conclusion.r, conclusion.s) == (_joined(base, before, after), 1):
            nodes += _fresh(before, after)
            return [{"rule": "join-clique", "size": after.n - before.n}]
    fresh = _fresh(before, after)
    steps = [_weaken(conclusion)] if fresh and (conclusion.r, conclusion.s) != (base.r, base.s) else []
    old, new = _arcs(before), _arcs(after)
    steps += _arc_step("remove-arcs", old - new, nodes)
    for node in fresh:
        heard = [i for i, label in enumerate(nodes) if (label, node) in new]
        old |= {(nodes[i], node) for i in heard}
        nodes.append(node)
        steps.append({"rule": "add-node", "hears": heard})
    return steps + _arc_step("add-arcs", new - old, nodes)


def _most_lost(before: Digraph, after: Digraph) -> int:
    """Return the most in-neighbours that a node which stays has among those that were removed."""
    gone = {before.index[label] for label in before.labels if label not in after.index}
    stay = (before.index[label] for label in after.labels)
    return max((sum(j in gone for j in before.in_neighbours(i).tolist()) for i in stay), default=0)


def _joined(base: Guarantee, before: Digraph, after: Digraph) -> int:
    """Return what the lemma of join-clique promises for r."""
    return r_beside_clique(base.r, before, after.n - before.n)


def _weaken(conclusion: Guarantee) -> _Step:
    return {"rule": "weaken", "r": conclusion.r, "s": conclusion.s}


def _fresh(before: Digraph, after: Digraph) -> list[Label]:
    """Return the nodes that were added, in canonical order, which is that in which ``grow`` adds them."""
    return sorted((label for label in after.labels if label not in before.index), key=label_key)


def _arcs(graph: Digraph) -> _Arcs:
    return {(graph.labels[u], graph.labels[v]) for u, v in graph.arcs()}


def _arc_step(rule: str, arcs: _Arcs, nodes: list[Label]) -> list[_Step]:
    """Return the step that adds or removes these arcs, or none."""
    place = {label: i for i, label in enumerate(nodes)}
    pairs = sorted([place[u], place[v]] for u, v in arcs)
    return [{"rule": rule, "arcs": pairs}] if pairs else []
