r"""The lower bound checked again, from a certificate alone: by the kernel, or by another solver, HiGHS.

Nothing here is shared with the search. The kernel verifies the certificate: each of its pairs is a violation of the
network before mending; and it proves the bound where its tree over choices is small. Else the master problem is built
anew from the same bytes, row by row, as docs/certificate-format.md states it: over ``x_a`` (a link is chosen), ``y_iO``
(node i hears enough of the set O) and for each side of a pair ``f_S`` (all its normal nodes do), all 0 or 1::

    sum of the links that bring i an arc from O  >=  (enough - what i hears of O already) y_iO
    f_S <= y_iO                                                                  every normal i of S
    sum over both sides of y, and of s f_S        >=  s                          (r,s)-robustness
    sum over both sides of y, and of z            >=  1                          traps and violations
    sum over S of y, and of s f_S                 >=  s z                         every start S of a cover
    sum of the links inside no set of a cover     >=  what it lacks (1 - z)       every cover; one z for the same starts
    caps and required links

and, where every link that is not there can be added at one cost without constraints, for nodes u < v that hear and are
heard by the same others: u gains at least as many links as v. Swapping such nodes changes neither the network nor the
cost, so some cheapest choice that reaches the goal is of this form, and every choice that reaches the goal breaks
every violation. ``z`` is 0 but for a local bound: then the ``y`` of every node outside M to hear f + 1 of M. The model
is asked for a choice that costs less than the certificate claims. HiGHS computes with floating-point numbers, to a
tolerance of 1e-6; all data are integers.
"""

from __future__ import annotations

import enum
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from certificates.errors import MalformedCertificate, RejectedCertificate
from certificates.graph import decode_graph
from certificates.least_cost import DEFAULT_CHOICES
from certificates.mending import VerifiedMendingClaim, verify_mending
from certificates.stream import Stream
from certificates.strict_json import parse
from robustness.digraph import Digraph
from robustness.limits import Limits
from robustness.spelled import counted
from robustness.waiting import in_a_thread

__all__ = ["Confirmation", "LeastVerdict", "confirm_least", "subject_of"]


class LeastVerdict(enum.Enum):
    """What the second solver says about the least cost that a certificate claims."""

    #: No choice that breaks all violations costs less.
    CONFIRMED = "confirmed"
    #: There is one: the bound does not follow from these violations.
    REFUTED = "refuted"
    #: A limit was reached.
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Confirmation:
    """What the kernel proved, and what the second solver says about the rest.

    Attributes
    ----------
    claim : VerifiedMendingClaim
    verdict : LeastVerdict
    cheaper : tuple of pairs of ids
        When refuted: links that break all violations of the certificate and cost less than it claims.
    reason : str
        Why HiGHS decided nothing, where it was no limit.
    """

    claim: VerifiedMendingClaim
    verdict: LeastVerdict
    cheaper: tuple[tuple[int, int], ...] = ()
    reason: str = ""

    @property
    def solver(self) -> str:
        """Who was asked: ``"kernel"`` when it proved the bound itself, by its tree over choices; else ``"highs"``."""
        return "kernel" if self.claim.is_least else "highs"

    def __str__(self) -> str:
        least = self.claim.least
        what = "no choice breaks them all" if least is None else f"to break them all costs at least {least}"
        if self.claim.is_least:
            return f"the kernel's tree over choices confirms that {what}"
        if self.verdict is LeastVerdict.CONFIRMED:
            return f"HiGHS confirms that {what}"
        if self.verdict is LeastVerdict.REFUTED:
            found = counted(len(self.cheaper), "link")
            return f"HiGHS breaks them all with {found} that cost less than the certificate says"
        why = f"the kernel's tree over choices did not decide within its limits, and {self.reason}"
        neither = "neither the kernel's tree over choices nor HiGHS decided within the limits"
        return f"undecided whether {what}: {why if self.reason else neither}"


def confirm_least(
    graph_bytes: bytes,
    certificate_bytes: bytes,
    *,
    time_limit: float | None = None,
    choices: int = DEFAULT_CHOICES,
) -> Confirmation:
    """Verify a mending certificate, and have its lower bound confirmed from the certificate alone.

    By the kernel, where its tree over choices is small enough, and else by HiGHS.

    Parameters
    ----------
    graph_bytes, certificate_bytes : bytes
        As for :func:`certificates.verify_mending`.
    time_limit : float, optional
        Wall-clock seconds; past it the bound is UNDECIDED, and what the kernel proved still holds.
    choices : int
        Nodes of the kernel's tree over choices, before HiGHS is asked; with 0 HiGHS is asked at once.

    Returns
    -------
    Confirmation

    Raises
    ------
    CertificateError
        When the kernel refuses the certificate.

    >>> import networkx as nx
    >>> import robustness as rb
    >>> from robustness.mending import certify_mending
    >>> path = rb.Digraph.from_networkx(nx.path_graph(5))
    >>> print(confirm_least(path.canonical_bytes(), certify_mending(rb.mend(path, 2))))
    the kernel's tree over choices confirms that to break them all costs at least 2
    """
    limits = Limits.of(time_limit)
    claim = verify_mending(graph_bytes, certificate_bytes, lambda looked: looked < choices and not limits.expired())
    if claim.least == 0 or claim.is_least:
        return Confirmation(claim, LeastVerdict.CONFIRMED)
    document = parse(Stream(certificate_bytes).line(), MalformedCertificate, "the certificate")
    rebuilt = _Rebuilt(decode_graph(graph_bytes).hears, document)
    return rebuilt.cheaper_than(claim, limits)


def subject_of(graph: Digraph, certificate_bytes: bytes) -> Digraph:
    """Return what a mending certificate that goes with a graph is about.

    The graph itself, or, when it is a certificate of thinning, its nodes without any link: then every action is one of
    the graph's own links.
    """
    document = parse(Stream(certificate_bytes).line(), MalformedCertificate, "the certificate")
    empty = Digraph(graph.labels, [], directed=graph.directed)
    if not isinstance(document, dict) or document.get("graph") != empty.sha256 or graph.arc_count == 0:
        return graph
    own = set(graph.arcs())
    actions = document.get("actions")
    links = actions.get("links") if isinstance(actions, dict) else None
    if not isinstance(links, list) or any(not isinstance(each, list) or len(each) != 3 for each in links):
        raise MalformedCertificate("the links of a mending certificate are [u, v, cost]")
    if any((u, v) not in own for u, v, _ in links):
        raise RejectedCertificate("the certificate chooses among links that the network does not have")
    if len(links) * (1 if document["actions"].get("one_way") else 2) != len(own):
        raise RejectedCertificate("the certificate leaves out links of the network: it may keep them for less")
    return empty


def _room(size: int, r: int) -> int:
    return sum(min(r, before) for before in range(size))


class _Rebuilt:
    """The master problem of a certificate that the kernel has verified."""

    def __init__(self, hears: Iterable[Iterable[int]], document: dict[str, Any]) -> None:
        from ortools.math_opt.python import mathopt

        self._sum = mathopt.fast_sum
        self._hears = [frozenset(heard) for heard in hears]
        self._n = len(self._hears)
        actions = document["actions"]
        self._links = [(u, v) for u, v, _ in actions["links"]]
        self._costs = [cost for *_, cost in actions["links"]]
        self._model = mathopt.Model(name="mending")
        self._x = [self._model.add_binary_variable() for _ in self._links]
        self._cost = self._sum(cost * x for cost, x in zip(self._costs, self._x, strict=True))
        self._into: dict[int, list[tuple[int, Any]]] = defaultdict(list)
        for (u, v), x in zip(self._links, self._x, strict=True):
            for tail, head in ((u, v),) if actions["one_way"] else ((u, v), (v, u)):
                if tail not in self._hears[head]:
                    self._into[head].append((tail, x))
        self._hears_enough: dict[tuple[int, frozenset[int], int], Any] = {}
        for a in actions["required"]:
            self._model.add_linear_constraint(self._x[a] == 1)
        for i, most in enumerate(actions["most"] or ()):
            self._model.add_linear_constraint(self._sum(x for _, x in self._into[i]) <= most)
        if self._all_alike(actions):
            self._order_twins()
        for k, *sets in document["pairs"]:
            self._break(document["claim"]["parts"][k], *map(frozenset, sets))
        self._slow: dict[tuple[Any, ...], Any] = {}
        for k, starts, *sets in document["covers"]:
            part, key = document["claim"]["parts"][k], (k, *map(tuple, starts))
            if key not in self._slow:
                self._slow[key] = self._nothing_spreads(starts, part["r"], part["s"])
            self._need_links_outside(sets, part["r"], self._slow[key])

    def _all_alike(self, actions: dict[str, Any]) -> bool:
        """Return whether every link that is not there can be added, all at one cost, without constraints."""
        costs = {cost for *_, cost in actions["links"]}
        arcs = sum(map(len, self._into.values())) + sum(map(len, self._hears))
        complete = arcs == self._n * (self._n - 1)
        return complete and len(costs) == 1 and not actions["required"] and actions["most"] is None

    def _order_twins(self) -> None:
        """Nodes that hear and are heard by the same others can be swapped: the first of two gains no less."""
        heard_by: list[set[int]] = [set() for _ in range(self._n)]
        for i, heard in enumerate(self._hears):
            for j in heard:
                heard_by[j].add(i)
        for u in range(self._n):
            for v in range(u + 1, self._n):
                if all(near[u] - {v} == near[v] - {u} for near in (self._hears, heard_by)):
                    mutual = (v in self._hears[u]) == (u in self._hears[v])
                    if mutual:
                        first, second = (self._sum(x for _, x in self._into[i]) for i in (u, v))
                        self._model.add_linear_constraint(first >= second)

    def _break(self, part: dict[str, Any], M: frozenset[int], S1: frozenset[int], S2: frozenset[int]) -> None:
        """Add the row of one pair."""
        everybody = frozenset(range(self._n))
        robust = "r" in part
        enough, s = (part["r"], part["s"]) if robust else (part["f"] + 1, 1)
        terms = []
        for S in (S1, S2):
            around = everybody - S - (M if not robust and part["faces"] == 2 else frozenset())
            terms += self._worth(sorted(S - M), around, enough, s)
        if not robust and part["bound"] == "local":
            terms += [self._unit(i, M, enough) for i in sorted(everybody - M)]
        self._model.add_linear_constraint(self._sum(terms) >= s)

    def _worth(self, nodes: Iterable[int], around: frozenset[int], enough: int, s: int) -> list[Any]:
        """Return the terms of a side's worth: y of its nodes, and s times whether all of them hear enough."""
        met = [self._unit(i, around, enough) for i in nodes]
        if s == 1:
            return met
        full = self._model.add_binary_variable()
        for each in met:
            self._model.add_linear_constraint(full <= each)
        return [*met, s * full]

    def _nothing_spreads(self, starts: list[list[int]], r: int, s: int) -> Any:
        """Return the variable that no start takes the whole network in: then each is worth s."""
        slow = self._model.add_binary_variable()
        everybody = frozenset(range(self._n))
        for start in starts:
            worth = self._worth(start, everybody - set(start), r, s)
            self._model.add_linear_constraint(self._sum(worth) >= s * slow)
        return slow

    def _need_links_outside(self, cover: list[list[int]], r: int, slow: Any) -> None:
        """Add the row of one cover: the k-th node of a set has room for min(r, k) arcs by which it is taken in."""
        sets = [frozenset(V) for V in cover]
        lacking = _room(self._n, r) - sum(_room(len(V), r) for V in sets)
        outer = (x for (u, v), x in zip(self._links, self._x, strict=True) if not any({u, v} <= V for V in sets))
        self._model.add_linear_constraint(self._sum(outer) >= lacking * (1 - slow))

    def _unit(self, i: int, around: frozenset[int], enough: int) -> Any:
        key = (i, around, enough)
        if key not in self._hears_enough:
            met = self._model.add_binary_variable()
            missing = enough - len(self._hears[i] & around)
            supply = self._sum(x for tail, x in self._into[i] if tail in around)
            if missing > 0:
                self._model.add_linear_constraint(supply >= missing * met)
            self._hears_enough[key] = met
        return self._hears_enough[key]

    def cheaper_than(self, claim: VerifiedMendingClaim, limits: Limits) -> Confirmation:
        """Return whether a choice breaks all pairs and costs less than the certificate claims."""
        from ortools.math_opt.python import mathopt

        if claim.least is not None:
            self._model.add_linear_constraint(self._cost <= claim.least - 1)
        self._model.minimize(self._cost)
        seconds = None if limits.deadline is None else timedelta(seconds=max(limits.seconds_left(), 1e-3))
        parameters = mathopt.SolveParameters(time_limit=seconds)
        reached = mathopt.TerminationReason

        def work() -> Any:
            return mathopt.solve(self._model, mathopt.SolverType.HIGHS, params=parameters)

        try:
            found = in_a_thread("robustness-highs", work)
        except Exception as problem:  # noqa: BLE001  # whatever a solver fails with, it has decided nothing
            return Confirmation(claim, LeastVerdict.UNDECIDED, reason=f"HiGHS failed: {problem}")
        if found.termination.reason in (reached.OPTIMAL, reached.FEASIBLE):
            values = found.variable_values()
            taken = [a for a, x in enumerate(self._x) if values[x] > 0.5]
            if claim.least is not None and sum(self._costs[a] for a in taken) >= claim.least:
                # To a tolerance a link that costs 10^9 can be left out by a millionth.
                return Confirmation(claim, LeastVerdict.UNDECIDED, reason="the costs are too large for HiGHS")
            return Confirmation(claim, LeastVerdict.REFUTED, tuple(self._links[a] for a in taken))
        # Every variable lies between 0 and 1, so that nothing here is unbounded.
        confirmed = found.termination.reason in (reached.INFEASIBLE, reached.INFEASIBLE_OR_UNBOUNDED)
        return Confirmation(claim, LeastVerdict.CONFIRMED if confirmed else LeastVerdict.UNDECIDED)
