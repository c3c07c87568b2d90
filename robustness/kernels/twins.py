"""Links that swapping two nodes makes the same: of those one is enough, in a question that swapping does not change."""

# mypy: ignore-errors
# Types are in twins.pxd, which the compiler checks.

from __future__ import annotations

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.words import bit_of, count

__all__ = ["are_twins", "is_like_another"]


def are_twins(heard, usable, u, v):
    """Return whether two nodes can be swapped: nothing that is there, or could be, tells them apart.

    Parameters
    ----------
    heard, usable : arrays of uint64, shape (n,)
        Whom every node hears, and whom it could hear by links that may still be chosen.
    u, v : int
    """
    others = ~(bit_of(u) | bit_of(v))
    if (heard[u] ^ heard[v]) & others or (usable[u] ^ usable[v]) & others:
        return False
    if count(heard[u] & bit_of(v)) != count(heard[v] & bit_of(u)):
        return False
    if count(usable[u] & bit_of(v)) != count(usable[v] & bit_of(u)):
        return False
    for i in range(heard.shape[0]):
        if not count(bit_of(i) & others):
            continue
        if count(heard[i] & ~others) == 1 or count(usable[i] & ~others) == 1:
            return False
    return True


def is_like_another(arcs, options, link, found, both, heard, usable):
    """Return whether swapping two nodes makes a link one of the options before it.

    A choice with the one is as good as with the other: where no choice with the first reaches the goal, none with the
    second does.

    Parameters
    ----------
    arcs : array of int32, shape (links, 4)
        Tail and head of the arcs of every link.
    options : array of int32, shape (links,)
        The options, of which ``found`` are known.
    link, found, both : int
        ``both``: 2 for links that bring an arc each way, else 1.
    heard, usable : arrays of uint64, shape (n,)
        As for :func:`are_twins`.
    """
    tail, head = arcs[link, 0], arcs[link, 1]
    for k in range(found):
        u, v = arcs[options[k], 0], arcs[options[k], 1]
        if u == tail and v != head and are_twins(heard, usable, v, head):
            return True
        if v == head and u != tail and are_twins(heard, usable, u, tail):
            return True
        if both == 2 and u == head and v != tail and are_twins(heard, usable, v, tail):
            return True
        if both == 2 and v == tail and u != head and are_twins(heard, usable, u, head):
            return True
    return False


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
