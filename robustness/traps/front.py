"""THE front of the trap search: a question is validated here, once; :mod:`robustness.traps.ladder` answers it."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from robustness.digraph import GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits, Progress
from robustness.traps.ladder import TRAP_ALGORITHMS, decide_trap
from robustness.traps.question import Question, Sets
from robustness.traps.results import TrapResult

__all__ = ["find_trap"]

#: How many malicious sides a node can be inside.
_FACES = (1, 2)


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
        As for :func:`robustness.check_rs_robustness`; ``search`` uses two threads at most.
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
    answer = decide_trap(graph, question, limits, algorithm, options)
    M, S1, S2 = (graph.labels_of(ids) for ids in answer.sets or Sets(frozenset(), frozenset(), frozenset()))
    return TrapResult(
        answer.exists,
        f,
        faces,
        bool(local),
        M,
        S1,
        S2,
        algorithm=answer.decided_by,
        stats=answer.stats,
        seconds=time.monotonic() - started,
        graph=graph,
    )
