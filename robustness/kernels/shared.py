"""What the two searches share: writing transcripts, copying and shrinking sets, and whom look-ahead tries first.

Their states differ in kind; the caller says in which rows the sets are. Everything here runs without the interpreter's
lock. Node sets are rows of ``words`` 64-bit words (uint64), numbers int64.
"""

# mypy: ignore-errors
# Types are in shared.pxd, which the compiler checks.

from __future__ import annotations

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

if not cython.compiled:
    from robustness.kernels.words import bit_of, count, first

__all__ = ["copy_state", "core", "most_promising", "varint"]


def varint(buffer, place, value):
    """Write a number to ``buffer``, seven bits a byte, low first; return the place behind it.

    Parameters
    ----------
    buffer : array of uint8, shape (room,)
    place, value : int
    """
    while value >= 128:
        buffer[place] = value & 127 | 128
        place += 1
        value >>= 7
    buffer[place] = value
    return place + 1


def copy_state(target, source):
    """Copy a state.

    Parameters
    ----------
    target, source : arrays of uint64, shape (rows, words)
    """
    for row in range(source.shape[0]):
        for w in range(source.shape[1]):
            target[row, w] = source[row, w]


def core(hears, need, candidates, support):
    """Shrink ``candidates`` to its largest subset K with ``|N_i & (K | support)| >= need_i`` on K.

    Return whether K is nonempty. Such subsets are closed under union, so there is one largest, whatever the order.

    Parameters
    ----------
    hears : array of uint64, shape (n, words)
    need : array of int64, shape (n,)
    candidates, support : arrays of uint64, shape (words,)
    """
    words = candidates.shape[0]
    while True:
        changed, some = False, False
        for w in range(words):
            rest = candidates[w]
            while rest:
                i = (w << 6) + first(rest)
                rest &= rest - 1
                inside = 0
                for x in range(words):
                    inside += count(hears[i, x] & (candidates[x] | support[x]))
                if inside < need[i]:
                    candidates[w] &= ~bit_of(i)
                    changed = True
            if candidates[w]:
                some = True
        if not changed:
            return some


def most_promising(hears, margin, state, possible, certain, side, value, chosen):
    """Fill ``chosen`` with the nodes that look-ahead tries on ``side``, best first; return how many there are.

    Of the nodes that may still be on both sides these are nearest to being excluded from this one by *count*, and hear
    most of those that are on a side for certain. Ties go to the lower id.

    Parameters
    ----------
    hears : array of uint64, shape (n, words)
    margin : array of int64, shape (2, n)
        How far every node of either side is from being excluded.
    state : array of uint64, shape (rows, words)
    possible, certain : int
        The rows of who may be on side 0, and who is; the next row is that of side 1.
    side : int
    value, chosen : arrays of int64, shape (tried,)
        Their length says how many are wanted.
    """
    found = 0
    for w in range(state.shape[1]):
        rest = state[possible, w] & state[possible + 1, w]
        while rest:
            v = (w << 6) + first(rest)
            rest &= rest - 1
            worth = -4 * margin[side, v]
            for x in range(state.shape[1]):
                worth += count(hears[v, x] & (state[certain, x] | state[certain + 1, x]))
            place = found
            if found < chosen.shape[0]:
                found += 1
            elif worth <= value[found - 1]:
                continue
            else:
                place -= 1
            while place > 0 and value[place - 1] < worth:
                value[place] = value[place - 1]
                chosen[place] = chosen[place - 1]
                place -= 1
            value[place] = worth
            chosen[place] = v
    return found


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
