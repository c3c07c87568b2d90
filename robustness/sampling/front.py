"""The test by samples: :func:`sample_robustness`. What it claims, and why, is in :mod:`robustness.sampling.chance`."""

from __future__ import annotations

import math
import random
import secrets
import time
from collections.abc import Callable
from fractions import Fraction

from robustness.decision.front import check_rs_robustness, determine_robustness
from robustness.definitions import largest_conceivable_r
from robustness.digraph import Digraph, GraphLike, as_digraph
from robustness.errors import InvalidParameter
from robustness.limits import Limits, Progress
from robustness.results import Verdict
from robustness.sampling.chance import chance_of_error, greatest_claim, least_needed
from robustness.sampling.results import SampleResult, SampleVerdict
from robustness.spelled import counted
from robustness.whole_numbers import taking_numpy_integers

__all__ = ["sample_robustness"]


@taking_numpy_integers
def sample_robustness(
    G: GraphLike,
    r: int | None = None,
    *,
    error: float = 0.001,
    nodes: int = 40,
    repeats: int = 10,
    seed: int | None = None,
    time_limit: float | None = None,
    jobs: int = 1,
    progress: Callable[[Progress], None] | None = None,
) -> SampleResult:
    """Test whether G is r-robust by random samples of its nodes: with a bounded chance of error, and never a proof.

    Each sample is a uniformly random set of nodes whose induced subgraph is decided exactly. If all of them are robust
    enough, a network that is not r-robust would have been an unlikely one to show that: the theorem of samples, in
    :mod:`robustness.sampling.chance`, has no other hypothesis than that the samples are drawn at random. That
    samples are not robust enough says nothing.

    Parameters
    ----------
    G : graph or digraph
    r : int, optional
        At least 1. Without it: the greatest r that the samples speak for.
    error : float
        The bound on the chance of error, in (0, 0.5].
    nodes, repeats : int
        Of each sample, in 2..n (cut to n); and how many samples. Larger samples say more and are harder to decide.
    seed : int, optional
        Of the draws. None draws it from the system. It must not be chosen with the network in view, nor the network
        with the seed in view: the chance is that of the draws.
    time_limit, jobs, progress
        As for :func:`robustness.check_rs_robustness`.

    Returns
    -------
    SampleResult

    Raises
    ------
    InvalidParameter
        For parameters out of range, and for a network of fewer than two nodes.

    Notes
    -----
    For published work see docs/sampling.md: Yi, Wang, He, Patterson and Johansson (2022) tell (r + eps n)-robust
    networks from those that are not r-robust, in time exponential in 1 / eps^2.

    >>> import networkx as nx
    >>> found = sample_robustness(nx.complete_graph(400), 40, seed=1)
    >>> found.verdict.value, found.q, found.chance < 0.001
    ('likely-robust', 9, True)
    """
    started = time.monotonic()
    graph = as_digraph(G)
    level = _level(error)
    if graph.n < 2:
        raise InvalidParameter(f"a network of {counted(graph.n, 'node')} has no samples: check decides it")
    if r is not None and r < 1:
        raise InvalidParameter(f"r is at least 1, not {r}: every network is 0-robust")
    if nodes < 2 or repeats < 1:
        raise InvalidParameter(f"a sample has at least 2 nodes, and there is at least 1, not {nodes} and {repeats}")
    if seed is not None and seed < 0:
        raise InvalidParameter(f"seed is at least 0, not {seed}")
    drawn = secrets.randbits(63) if seed is None else seed
    limits = Limits.of(time_limit, jobs, drawn % 2**31, progress)  # as solvers take seeds; no verdict depends on it
    test = _Test(graph, min(nodes, graph.n), repeats, drawn, level, limits)
    return test.result(r, started)


def _level(error: float) -> Fraction:
    if isinstance(error, bool) or not (math.isfinite(error) and 0 < error <= 0.5):
        raise InvalidParameter(f"error is a probability in (0, 0.5], not {error!r}")
    return Fraction(error)


class _Test:
    """One test: the draws, and what is known of them."""

    def __init__(self, graph: Digraph, nodes: int, repeats: int, seed: int, level: Fraction, limits: Limits) -> None:
        self.graph, self.nodes, self.repeats = graph, nodes, repeats
        self.seed, self.level, self.limits = seed, level, limits
        self.least_degree = int(graph.in_degrees.min())

    def result(self, r: int | None, started: float) -> SampleResult:
        """Draw the samples, decide them and say what follows."""
        n = self.graph.n
        needed = None if r is None else least_needed(n, self.least_degree, r, self.nodes, self.repeats, self.level)
        if r is not None and needed is None:
            return self._undecided(r, 0, self._why_never(r), started)
        q, reason = self._least_of_samples(needed)
        if needed is not None and r is not None:
            if q < needed:
                return self._undecided(r, q, reason or f"a sample is not {needed}-robust", started)
            q = needed
        else:
            r = greatest_claim(n, self.least_degree, self.nodes, self.repeats, q, self.level)
            if r == 0:
                return self._undecided(0, q, reason or f"the samples are {q}-robust, which says nothing", started)
        chance = chance_of_error(n, self.least_degree, r, self.nodes, self.repeats, q)
        return SampleResult(
            SampleVerdict.LIKELY, r, _rounded_up(chance), self.nodes, self.repeats, q, self.seed,
            seconds=time.monotonic() - started,
        )  # fmt: skip

    def _why_never(self, r: int) -> str:
        """Return why no samples of this size could speak for r."""
        if r > largest_conceivable_r(self.graph.n):
            return f"no network of {counted(self.graph.n, 'node')} is {r}-robust"
        what = f"{counted(self.repeats, 'sample')} of {counted(self.nodes, 'node')}"
        return f"{what} cannot speak for r = {r}: take larger ones"

    def _undecided(self, r: int, q: int, reason: str, started: float) -> SampleResult:
        seconds = time.monotonic() - started
        return SampleResult(
            SampleVerdict.UNDECIDED, r, 1.0, self.nodes, self.repeats, q, self.seed, reason, seconds=seconds
        )

    def _least_of_samples(self, needed: int | None) -> tuple[int, str]:
        """Return what all samples are proven to be, and which limit kept it low, if one did.

        With ``needed`` no more than that is asked, and the first sample that is less ends it.
        """
        draw = random.Random(self.seed)  # a published seed, so that the test can be repeated
        least, reason = self.graph.n, ""
        for k in range(self.repeats):
            sample = sorted(draw.sample(range(self.graph.n), self.nodes))
            if self.limits.progress is not None:
                self.limits.progress(Progress(0, f"sample {k + 1} of {self.repeats}"))
            share = self.limits.share(1 / (self.repeats - k))
            induced = self._induced(sample)
            if needed is None:
                found = determine_robustness(induced, **share.keywords())
                known = found.r if found.bounds is None else found.bounds.lower.value
                if found.bounds is not None and found.bounds.lower.value < found.bounds.upper.value:
                    reason = "the time limit was reached"
            else:
                decided = check_rs_robustness(induced, needed, **share.keywords()).verdict
                known = needed if decided is Verdict.ROBUST else 0
                if decided is Verdict.UNDECIDED:
                    reason = "the time limit was reached"
            least = min(least, known)
            if not least:
                break
        return least, reason

    def _induced(self, sample: list[int]) -> Digraph:
        place = {i: k for k, i in enumerate(sample)}
        arcs = [(place[j], k) for i, k in place.items() for j in self.graph.in_neighbours(i).tolist() if j in place]
        return Digraph(range(len(sample)), arcs)


def _rounded_up(chance: Fraction) -> float:
    """Return a float that is not less than an exact probability."""
    value = float(chance)
    return value if Fraction(value) >= chance else math.nextafter(value, 2.0)
