"""THE front of the trap search: validation, cheap lemmas, one algorithm, and a re-checked answer."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from certificates.graph import Label
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InternalError, InvalidParameter, Undecided
from robustness.limits import Limits, Progress
from robustness.natural_order import in_natural_order
from robustness.showing import Shown, labels_in_words
from robustness.traps.question import Question, Sets, solves
from robustness.traps.shortcuts import settle_trap

__all__ = ["TRAP_ALGORITHMS", "TrapResult", "decide_trap", "find_trap"]

#: Every exact algorithm for traps by the name users type.
TRAP_ALGORITHMS = ("search", "cp-sat", "exhaustive")

#: How many malicious sides a node can be inside.
_FACES = (1, 2)


@dataclass(frozen=True, slots=True, repr=False)
class TrapResult(Shown):
    """Whether the sets exist, and the sets.

    Attributes
    ----------
    exists : bool or None
        None when a limit stopped the search; nothing is claimed then.
    f, faces, local
        The question.
    M, S1, S2 : frozensets of labels
        When they exist, re-checked against the definition; empty otherwise.
    algorithm : str
        What decided: a name in ``TRAP_ALGORITHMS``, or ``"lemma"``.
    stats : mapping
        Counters, the lemma, or the reason why nothing is claimed.
    seconds : float
    """

    exists: bool | None
    f: int
    faces: int
    local: bool
    M: frozenset[Label] = frozenset()
    S1: frozenset[Label] = frozenset()
    S2: frozenset[Label] = frozenset()
    algorithm: str = ""
    stats: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}), compare=False, hash=False)
    seconds: float = field(default=0.0, compare=False)

    def __bool__(self) -> bool:
        raise TypeError("a TrapResult has three values, so it has no truth value: compare .exists, or call decided()")

    def summary(self) -> str:
        """Return the answer in one line."""
        kind = "trap" if self.faces == 2 else "violation"
        bound = f"{'local ' if self.local else ''}{kind} for f = {self.f}"
        if self.exists is None:
            return f"undecided: whether there is a {bound}"
        if not self.exists:
            return f"no {bound}"
        sets = (("M", self.M), ("S1", self.S1), ("S2", self.S2))
        return f"{bound}: " + ", ".join(f"{name} = {labels_in_words(labels)}" for name, labels in sets)

    def evidence(self) -> list[tuple[str, str]]:
        """Return what the answer rests on, as rows of a name and a text."""
        sets = (("M", self.M), ("S1", self.S1), ("S2", self.S2)) if self.exists else ()
        return [*((name, labels_in_words(labels)) for name, labels in sets), ("algorithm", self.algorithm)]

    def as_dict(self) -> dict[str, Any]:
        """Return the answer as JSON-ready values."""
        sets = {"M": self.M, "S1": self.S1, "S2": self.S2}
        return {
            "exists": self.exists,
            "f": self.f,
            "faces": self.faces,
            "local": self.local,
            "sets": {name: in_natural_order(labels) for name, labels in sets.items()} if self.exists else None,
            "algorithm": self.algorithm,
            "seconds": self.seconds,
        }

    def decided(self) -> bool:
        """Return whether the sets exist; raise :class:`Undecided` when a limit stopped the search."""
        if self.exists is None:
            raise Undecided(f"whether a trap for f = {self.f} exists was not decided: raise the time limit")
        return self.exists


def find_trap(
    G: GraphLike,
    f: int,
    *,
    faces: int = 2,
    local: bool = False,
    algorithm: str = "auto",
    time_limit: float | None = None,
    jobs: int = 1,
    seed: int = 0,
    progress: Callable[[Progress], None] | None = None,
    **options: Any,
) -> TrapResult:
    """Decide whether f malicious nodes can hold two groups of G apart, exactly.

    Definition: disjoint M, S1, S2 with S1 and S2 nonempty such that every node of S_k has at most f in-neighbours
    outside ``S_k ∪ M``. With ``faces=1`` malicious nodes are members of S1 and S2 instead, and every *other* node of
    S_k has at most f in-neighbours outside S_k.

    Parameters
    ----------
    G : networkx graph or Digraph
        An arc ``(u, v)`` means v hears u. Never changed.
    f : int
        At least 0.
    faces : 1 or 2
        Whether a malicious node says the same to all, or can show either side a face of its own: by lying to each
        neighbour differently, or by delays.
    local : bool
        False: ``|M| <= f``. True: every node outside M hears at most f nodes of M.
    algorithm : str
        A name in ``TRAP_ALGORITHMS`` or ``"auto"``: cheap lemmas, then ``"search"``.
    time_limit : float, optional
        Wall-clock seconds; past it ``exists`` is None.
    jobs, seed, progress
        As for :func:`robustness.check_rs_robustness`; ``search`` uses one thread.
    **options
        ``counting`` and ``look_ahead``: switches of ``search``.

    Returns
    -------
    TrapResult

    Raises
    ------
    InvalidGraph, InvalidParameter
        For input the definition does not speak about.

    Notes
    -----
    Exponential in the worst case. With two faces in total, "no trap" is the condition of Vaidya, Tseng and Liang
    (2012): for every M of at most f nodes, ``G - M`` is (f+1)-robust. With one face in total it is
    (f+1,f+1)-robustness.

    >>> import networkx as nx
    >>> find_trap(nx.wheel_graph(5), 1).M, find_trap(nx.complete_graph(5), 1).exists
    (frozenset({0}), False)
    >>> find_trap(nx.wheel_graph(5), 1, faces=1).exists
    False
    """
    started = time.monotonic()
    graph = as_digraph(G)
    if type(f) is not int or f < 0:
        raise InvalidParameter(f"f is an integer of at least 0, not {f!r}")
    if faces not in _FACES:
        raise InvalidParameter(f"a malicious node has 1 or 2 faces, not {faces!r}")
    if algorithm != "auto" and algorithm not in TRAP_ALGORITHMS:
        raise InvalidParameter(f"algorithm is 'auto' or one of {', '.join(TRAP_ALGORITHMS)}, not {algorithm!r}")
    question = Question(f, faces == 2, bool(local))
    limits = Limits.of(time_limit, jobs, seed, progress)
    exists, sets, name, stats = decide_trap(graph, question, limits, algorithm, options)
    M, S1, S2 = (graph.labels_of(ids) for ids in sets or (frozenset(), frozenset(), frozenset()))
    return TrapResult(
        exists, f, faces, bool(local), M, S1, S2, algorithm=name, stats=stats, seconds=time.monotonic() - started
    )


def decide_trap(
    graph: Digraph,
    question: Question,
    limits: Limits,
    algorithm: str = "auto",
    options: Mapping[str, Any] | None = None,
) -> tuple[bool | None, Sets | None, str, Mapping[str, Any]]:
    """Return (exists or None, the re-checked sets, what decided, stats) of one question on ids."""
    if algorithm == "auto" and not options:
        settled = settle_trap(graph, question, limits)
        if settled is not None:
            exists: bool | None = settled[0] is not None
            return exists, _checked(graph, question, settled[0], exists, "lemma"), "lemma", {"rule": settled[1]}
    name = "search" if algorithm == "auto" else algorithm
    exists, sets, stats = _run(graph, question, limits, name, options or {})
    return exists, _checked(graph, question, sets, exists, name), name, stats


def _run(
    graph: Digraph, question: Question, limits: Limits, name: str, options: Mapping[str, Any]
) -> tuple[bool | None, Sets | None, Mapping[str, Any]]:
    if options and (name != "search" or not {"counting", "look_ahead"}.issuperset(options)):
        raise InvalidParameter(
            f"the trap algorithm {name!r} does not take {', '.join(options)}: only 'search' has counting and look_ahead"
        )
    if limits.expired():
        return None, None, {"reason": "the time limit was reached"}
    match name:
        case "exhaustive":
            from robustness.traps import exhaustive

            return *exhaustive.decide(graph, question, limits), {}
        case "cp-sat":
            from robustness.traps import cp_sat

            return cp_sat.decide(graph, question, limits)
        case _:
            from robustness.traps import searching

            return searching.decide(graph, question, limits, **options)


def _checked(graph: Digraph, question: Question, sets: Sets | None, exists: bool | None, name: str) -> Sets | None:
    """Return the sets after re-checking them against the definition; wrong ones are an InternalError."""
    if exists and (sets is None or not solves(graph, question, sets)):
        raise InternalError(f"{name} returned {sets}, which does not solve {question}: please report")
    return sets
