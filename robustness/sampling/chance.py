"""How likely it is that a sample of a network that is not r-robust is more robust than can be expected.

Theorem (samples). Let G have n nodes, each of which hears at least d others, and let it not be r-robust, r >= 1. Let
U be a uniformly random set of t of its nodes, 2 <= t <= n, and G[U] the subgraph on U. Then G[U] is q-robust with
probability at most

    t P(H(n - 1, min(r, n) - 1, t - 1) >= q) + 2 P(H(n, z, t) = 0),    z = min(n, max(1, d - r + 2)),

where H(N, K, m) is how many of K marked elements are among m that are drawn from N without replacement.

Proof. Take disjoint nonempty S_1, S_2 with no node of S_k hearing r nodes outside S_k. *Let v be in S_k.* At most
``r - 1`` nodes that v hears are outside S_k. When v is in U, the rest of U is a uniform set of t - 1 of the other
n - 1 nodes, and of these outside nodes it holds H(n - 1, K, t - 1), for a K <= r - 1 (and < n), which is q or more at
most as likely as for the greatest such K. The expected number of v in S_1 and S_2 that are in U and hear q nodes of U
outside S_k is at most ``n (t / n)`` times that. *Sizes.* v hears at least d - (r - 1) nodes inside S_k, and is not one
of them: S_k has z nodes or more, and U meets it but for the second probability. So, but for the two, U cuts S_1 and
S_2 in nonempty sets, and no node of these hears q nodes of U outside its own: G[U] is not q-robust. QED.

For k samples drawn independently the probability that all are q-robust is at most the k-th power. The bound grows
with r and falls with q. So if the greatest r is claimed for which it is below a level, with q the least robustness of
the samples, a false claim has at most the probability of the level: were r* the network's robustness, the claim would
be at least r* + 1, and q one for which the bound for r* + 1 is below the level.
"""

from __future__ import annotations

import math
from fractions import Fraction

__all__ = ["chance_of_error", "greatest_claim", "least_needed"]

#: Binary digits that a power may have to be exact; of longer ones so many, rounded up, and none below 2 to minus this.
_EXACT, _DIGITS, _LEAST = 100_000, 256, 2000


def chance_of_error(n: int, least_degree: int, r: int, nodes: int, repeats: int, q: int) -> Fraction:
    """Return a bound on the probability that all samples of a network that is not r-robust are q-robust.

    Parameters
    ----------
    n, least_degree : int
        Of the network: its nodes, and how many others each of them hears at least.
    r : int
        At least 1.
    nodes, repeats : int
        Of each sample, in 2..n; and how many samples, at least 1.
    q : int
        At least 0.

    >>> chance_of_error(1000, 450, 1, 40, 1, 1) < Fraction(1, 10**9)
    True
    """
    size = min(n, max(1, least_degree - r + 2))
    missed = Fraction(math.comb(n - size, nodes), math.comb(n, nodes))
    one = nodes * _tail(n - 1, min(r, n) - 1, nodes - 1, q) + 2 * missed
    return _power(min(Fraction(1), one), repeats)


def _power(chance: Fraction, repeats: int) -> Fraction:
    """Return a power of a probability; when it has very many digits, a number above it that has few."""
    if chance in (0, 1) or chance.denominator.bit_length() * repeats < _EXACT:
        return chance**repeats
    whole, factor = Fraction(1), chance
    while repeats:
        if repeats & 1:
            whole = _shortened(whole * factor)
        factor = _shortened(factor * factor)
        repeats >>= 1
    return whole


def _shortened(chance: Fraction) -> Fraction:
    """Return a number of few digits that is not less than a probability, and not zero."""
    places = min(max(0, chance.denominator.bit_length() - chance.numerator.bit_length()), _LEAST) + _DIGITS
    return Fraction(-((-chance.numerator << places) // chance.denominator), 1 << places)


def _tail(population: int, marked: int, drawn: int, least: int) -> Fraction:
    """Return the probability of ``least`` or more marked elements among those drawn."""
    rest = population - marked
    fewest = max(0, drawn - rest)
    below, ways = 0, math.comb(marked, fewest) * math.comb(rest, drawn - fewest)
    for k in range(fewest, min(least, drawn + 1)):
        below += ways
        ways = ways * (marked - k) * (drawn - k) // ((k + 1) * (rest - drawn + k + 1))
    return 1 - Fraction(below, math.comb(population, drawn))


def least_needed(n: int, least_degree: int, r: int, nodes: int, repeats: int, level: Fraction) -> int | None:
    """Return the least q for which the bound is at most ``level``; None when no sample could have it."""
    low, high = 1, (nodes + 1) // 2
    while low < high:
        middle = (low + high) // 2
        if chance_of_error(n, least_degree, r, nodes, repeats, middle) <= level:
            high = middle
        else:
            low = middle + 1
    return low if chance_of_error(n, least_degree, r, nodes, repeats, low) <= level else None


def greatest_claim(n: int, least_degree: int, nodes: int, repeats: int, q: int, level: Fraction) -> int:
    """Return the greatest r for which the bound is at most ``level``; 0 when there is none."""
    low, high = 0, (n + 1) // 2
    while low < high:
        middle = (low + high + 1) // 2
        if chance_of_error(n, least_degree, middle, nodes, repeats, q) <= level:
            low = middle
        else:
            high = middle - 1
    return low
