"""From a result of mending to a certificate of it, which the kernel verifies before it is handed out."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from certificates.errors import RejectedCertificate
from certificates.mending import FORMAT, verify_mending
from robustness.decision.certification import certify
from robustness.digraph import Digraph
from robustness.errors import InternalError, InvalidParameter
from robustness.limits import Limits, Progress
from robustness.mending.actions import with_actions
from robustness.mending.completing import completed
from robustness.mending.demands import bits
from robustness.mending.goal import Part
from robustness.mending.results import MendResult, Problem
from robustness.results import Verdict
from robustness.threat_models.certification import certify_promise

__all__ = ["certify_mending", "least_claimed"]


def certify_mending(
    result: MendResult,
    *,
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
) -> bytes | None:
    """Return a certificate of a result: that the links reach the goal, and the violations behind the lower bound.

    It is about the network before mending (of :func:`robustness.thin`: about its nodes without any link). The kernel
    verifies all of it but the lower bound; that is for :func:`robustness.mending.confirm_least`, or any other solver.

    Parameters
    ----------
    result : MendResult
        Of :func:`robustness.mend` or :func:`robustness.thin`.
    time_limit, jobs, seed, progress
        As for :func:`robustness.certify`.

    Returns
    -------
    bytes or None
        Its bound may be below that of the result, where it would take very many violations. None when a limit was
        reached, or when the kernel has no evidence of the kind that the goal needs: local bounds
        beyond what (2f+1)-robustness gives.

    Raises
    ------
    InvalidParameter
        For a result that was made by hand and does not know its question.

    >>> import networkx as nx
    >>> import robustness as rb
    >>> path = rb.Digraph.from_networkx(nx.path_graph(5))
    >>> claim = verify_mending(path.canonical_bytes(), certify_mending(rb.mend(path, 2)))
    >>> claim.cost, claim.least
    (2, 2)
    """
    problem = result.problem
    if problem is None:
        raise InvalidParameter("the result does not know its question: certify what mend or thin returned")
    limits = Limits.of(time_limit, jobs, seed, progress)
    proofs: list[bytes] = []
    if problem.chosen is not None:
        mended = with_actions(problem.graph, problem.actions, problem.chosen)
        for part in problem.parts:
            proof = None if limits.expired() else _proof(mended, part, limits)
            if proof is None:
                return None
            proofs.append(proof)
    elif problem.least is None and not problem.pairs:
        return None  # too few nodes for a pair
    return _encoded(completed(problem, limits), proofs)


def least_claimed(certificate: bytes) -> int | None:
    """Return the least cost that a mending certificate claims, in units of its actions."""
    least: int | None = json.loads(certificate.partition(b"\n")[0])["claim"]["least"]
    return least


def _proof(mended: Digraph, part: Part, limits: Limits) -> bytes | None:
    if part.trap is not None:
        return certify_promise(mended, part.trap, limits)
    found = certify(mended, part.r, part.s, **limits.keywords())
    return found.certificate if found.verdict is Verdict.ROBUST else None


def _encoded(problem: Problem, proofs: list[bytes]) -> bytes:
    """Return the certificate's bytes, after the kernel has accepted them and found the same claim."""
    items = problem.actions.items
    order = sorted(range(len(items)), key=lambda a: items[a].ends)
    place = {a: k for k, a in enumerate(order)}
    cost = None if problem.chosen is None else sum(items[a].cost for a in problem.chosen)
    most = problem.actions.most
    header = {
        "format": FORMAT,
        "graph": problem.graph.sha256,
        "claim": {"parts": [_part(part) for part in problem.parts], "cost": cost, "least": problem.least},
        "actions": {
            "one_way": problem.actions.one_way,
            "links": [[*items[a].ends, items[a].cost] for a in order],
            "required": sorted(place[a] for a in problem.actions.required),
            "most": None if most is None else list(most),
            "chosen": None if problem.chosen is None else sorted(place[a] for a in problem.chosen),
        },
        "pairs": [
            [problem.parts.index(part), *(sorted(ids) for ids in sets)]
            for part, sets in problem.pairs
        ],
        "covers": [
            [problem.parts.index(part), [sorted(bits(U)) for U in starts], *sorted(sorted(bits(V)) for V in cover)]
            for part, starts, cover in problem.covers
        ],
        "lengths": [len(proof) for proof in proofs],
    }  # fmt: skip
    data = json.dumps(header, separators=(",", ":")).encode("ascii") + b"\n" + b"".join(proofs)
    try:
        proven = verify_mending(problem.graph.canonical_bytes(), data)
    except RejectedCertificate as problem_found:
        raise InternalError(f"the kernel rejects what was found ({problem_found}): please report") from problem_found
    known = (cost, problem.least, len(problem.pairs), len(problem.covers))
    if (proven.cost, proven.least, proven.violations, proven.covers) != known:
        raise InternalError(f"the certificate proves {proven}, which was not the claim: please report")
    return data


def _part(part: Part) -> dict[str, Any]:
    if part.trap is None:
        return {"r": part.r, "s": part.s}
    faces, bound = 2 if part.trap.two_faces else 1, "local" if part.trap.local else "total"
    return {"f": part.trap.f, "faces": faces, "bound": bound}
