"""The inner loop of the simulator: what every normal vehicle hears, keeps and does, for all runs of a batch.

The arithmetic is that of :mod:`robustness.simulation.reference`, operation by operation and in the same order, so that
the two agree bit for bit: no fused or reordered floating-point operations are allowed.

Arrays, with B runs, n nodes, A arcs (receiver-major, senders ascending), C channels, H remembered steps:

* ``ring (H, B, C)``: what was announced on every channel at step k, in slot ``k % H``;
* ``channel (A,)``: the channel an arc listens to;
* ``delay``, ``status``: ``(1 or B, A)``; status 0: no link now, 1: delivered, 2: withheld by the sender;
* ``update (1 or B, n)``: who updates at this step;
* ``held (B, A)``, ``kept (B, A)``: the values heard at the last update and whether they passed the filter;
* ``memory (B, A)``, ``stamp (B, A)``: the last delivered value of every arc and the step it left its sender.

Floating-point numbers are float64, counts int64, flags uint8.
"""

from __future__ import annotations

import numpy as np

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

__all__ = ["advance", "drop_extremes", "extremes", "fill_uniform", "worst_delays"]

_INFINITY = np.inf
_ALL = 0xFFFFFFFFFFFFFFFF
_GOLDEN, _FIRST, _SECOND = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


def drop_extremes(rel, number_heard, drop, strict, above, below, keep):
    """Set ``keep[t]`` for t < count: ``drop`` rounds, each of which finds the largest and the smallest value left.

    ``O(count * drop)``, but without unpredictable branches: for the few values that filters drop this is twice as
    fast as insertion buffers, which were tried. Ties: the first of equal values goes above, the last below.
    """
    for t in range(number_heard):
        above[t] = rel[t]
        below[t] = rel[t]
        keep[t] = 1
    for _ in range(min(drop, number_heard)):
        high, low, high_at, low_at = -_INFINITY, _INFINITY, 0, 0
        for t in range(number_heard):
            if above[t] > high:
                high, high_at = above[t], t
            if below[t] <= low:
                low, low_at = below[t], t
        if high > 0 or (high == 0 and not strict):
            keep[high_at] = 0
            above[high_at] = -_INFINITY
        if low < 0 or (low == 0 and not strict):
            keep[low_at] = 0
            below[low_at] = _INFINITY


def _listen(b, begin, end, step, tau, ring, channel, delay, status, remember, memory, stamp, values, arcs):
    """Write what one node hears to ``values`` and ``arcs``; return how many it hears and how many were withheld."""
    slots = ring.shape[0]
    now = (step % slots + slots) % slots  # the steps of the history are negative
    delay_row = b if delay.shape[0] > 1 else 0
    status_row = b if status.shape[0] > 1 else 0
    heard, missing = 0, 0
    for e in range(begin, end):
        state = status[status_row, e]
        if state == 1:
            late = delay[delay_row, e]
            # Delays are shorter than the ring, so this is (step - late) % slots without a division.
            value = ring[now - late if late <= now else now - late + slots, b, channel[e]]
            if remember:
                memory[b, e] = value
                stamp[b, e] = step - late
        elif state == 0 and remember and step - stamp[b, e] <= tau:
            value = memory[b, e]
        else:
            if state == 2:
                missing += 1
            continue
        values[heard] = value
        arcs[heard] = e
        heard += 1
    return heard, missing


def _advance(
    lo, hi, step, tau, f, first_order, strict, hold, remember, T,
    p, q, ring, channel, delay, status, update, held, kept, memory, stamp,
    indptr, weight, self_weight, alpha, new_p, new_q, values, rel, above, below, arcs, keep,
):  # fmt: skip
    half = T * T / 2
    for b in range(lo, hi):
        update_row = b if update.shape[0] > 1 else 0
        for i in range(indptr.shape[0] - 1):
            begin, end = indptr[i], indptr[i + 1]
            own = p[b, i]
            updates = update[update_row, i]
            total, mass, heard, missing = 0.0, 0.0, 0, 0
            if updates or remember:
                heard, missing = _listen(
                    b, begin, end, step, tau, ring, channel, delay, status, remember, memory, stamp, values, arcs
                )
            if updates:
                for t in range(heard):
                    rel[t] = values[t] - own
                drop_extremes(rel, heard, f - missing, strict, above, below, keep)
                if hold:
                    for e in range(begin, end):
                        kept[b, e] = 0
                for t in range(heard):
                    if keep[t]:
                        total += weight[arcs[t]] * rel[t]
                        mass += weight[arcs[t]]
                        if hold:
                            held[b, arcs[t]] = values[t]
                            kept[b, arcs[t]] = 1
            elif hold and not first_order:
                for e in range(begin, end):
                    if kept[b, e]:
                        total += weight[e] * (held[b, e] - own)
            if first_order:
                new_p[b, i] = own + total / (self_weight[i] + mass)
                new_q[b, i] = 0.0
            else:
                u = total - alpha[i] * q[b, i]
                new_p[b, i] = (own + T * q[b, i]) + half * u
                new_q[b, i] = q[b, i] + T * u


def advance(
    lo, hi, step, tau, f, first_order, strict, hold, remember, T,
    p, q, ring, channel, delay, status, update, held, kept, memory, stamp,
    indptr, weight, self_weight, alpha, new_p, new_q,
):  # fmt: skip
    """Advance the runs ``lo .. hi - 1`` by one step: reads ``p, q (B, n)``, writes ``new_p, new_q (B, n)``."""
    widest = 1
    for i in range(indptr.shape[0] - 1):
        widest = max(widest, indptr[i + 1] - indptr[i])
    values, rel, above, below = np.empty(widest), np.empty(widest), np.empty(widest), np.empty(widest)
    arcs, keep = np.empty(widest, np.int64), np.empty(widest, np.uint8)
    with cython.nogil:
        _advance(
            lo, hi, step, tau, f, first_order, strict, hold, remember, T,
            p, q, ring, channel, delay, status, update, held, kept, memory, stamp,
            indptr, weight, self_weight, alpha, new_p, new_q, values, rel, above, below, arcs, keep,
        )  # fmt: skip


def worst_delays(step, bound, ring, channel, heads, above, delays):
    """Write to ``delays (B, A)`` the least delay that shows each receiver the greatest value, or the least.

    The greatest where ``above (B, n)`` is nonzero at the receiver ``heads (A,)``, the least elsewhere, among the
    delays 0 .. bound.
    """
    slots = ring.shape[0]
    now = (step % slots + slots) % slots  # the steps of the history are negative
    for b in range(delays.shape[0]):
        for e in range(delays.shape[1]):
            place, up = channel[e], above[b, heads[e]]
            chosen, best = 0, ring[now, b, place]
            for late in range(1, bound + 1):
                value = ring[now - late if late <= now else now - late + slots, b, place]
                if value > best if up else value < best:
                    chosen, best = late, value
            delays[b, e] = chosen


def fill_uniform(stream, values):
    """Write to ``values (B, m)`` the uniform numbers that :mod:`robustness.simulation.draws` defines.

    Row b holds the SplitMix64 outputs of the counters ``stream[b] + (1 .. m) * golden``, as multiples of 2**-53.
    """
    for b in range(values.shape[0]):
        counter = int(stream[b])
        for j in range(values.shape[1]):
            counter = (counter + _GOLDEN) & _ALL
            mixed = ((counter ^ (counter >> 30)) * _FIRST) & _ALL
            mixed = ((mixed ^ (mixed >> 27)) * _SECOND) & _ALL
            top = (mixed ^ (mixed >> 31)) >> 11
            values[b, j] = top * 2.0**-53


def extremes(p, q, normal, low, high, fastest):
    """Write, for every run, the least and greatest p and the greatest ``|q|`` of the normal vehicles."""
    for b in range(p.shape[0]):
        lo, hi, quick = _INFINITY, -_INFINITY, 0.0
        for i in range(p.shape[1]):
            if normal[b, i]:
                value, fast = p[b, i], abs(q[b, i])
                # Not min and max: they pass over NaN, so that a run of NaN would end in agreement. NaN stays here.
                if value < lo or value != value:
                    lo = value
                if value > hi or value != value:
                    hi = value
                if fast > quick or fast != fast:
                    quick = fast
        low[b], high[b], fastest[b] = lo, hi, quick


#: The digest of the sources that this machine code was made from.
built_from = SOURCES.decode() if cython.compiled else ""
