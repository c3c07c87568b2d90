"""The compiled inner loop: what every normal vehicle hears, keeps and does, for all runs of a batch.

Importing this module imports numba; the engine does so when a run starts. The arithmetic is that of
:mod:`robustness.simulation.reference`, operation by operation and in the same order, so that the two agree bit
for bit: no fused or reordered floating-point operations are allowed.

Arrays, with B runs, n nodes, A arcs (receiver-major, senders ascending), C channels, H remembered steps:

* ``ring (H, B, C)``: what was announced on every channel at step k, in slot ``k % H``;
* ``channel (A,)``: the channel an arc listens to;
* ``delay``, ``status``: ``(1 or B, A)``; status 0: no link now, 1: delivered, 2: withheld by the sender;
* ``update (1 or B, n)``: who updates at this step;
* ``held (B, A)``, ``kept (B, A)``: the values heard at the last update and whether they passed the filter;
* ``memory (B, A)``, ``stamp (B, A)``: the last delivered value of every arc and the step it left its sender.
"""

from __future__ import annotations

import numba
import numpy as np

__all__ = ["advance", "extremes", "fill_uniform", "worst_delays"]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_FIRST, _SECOND = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_11, _27, _30, _31 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31)


@numba.njit(nogil=True, cache=True)
def _drop_extremes(rel, count, drop, strict, above, below, keep):  # type: ignore[no-untyped-def]
    """Set ``keep[t]`` for t < count: ``drop`` rounds, each of which finds the largest and the smallest value left.

    ``O(count * drop)``, but without unpredictable branches: for the few values that filters drop this is twice as
    fast as insertion buffers, which were tried. Ties: the first of equal values goes above, the last below.
    """
    for t in range(count):
        above[t] = below[t] = rel[t]
        keep[t] = 1
    for _ in range(min(drop, count)):
        high, low = -np.inf, np.inf
        high_at = low_at = 0
        for t in range(count):
            if above[t] > high:
                high, high_at = above[t], t
            if below[t] <= low:
                low, low_at = below[t], t
        if high > 0 or (high == 0 and not strict):
            keep[high_at] = 0
            above[high_at] = -np.inf
        if low < 0 or (low == 0 and not strict):
            keep[low_at] = 0
            below[low_at] = np.inf


@numba.njit(nogil=True, cache=True)
def _listen(b, first, last, step, tau, ring, channel, delay, status, remember, memory, stamp, values, arcs):  # type: ignore[no-untyped-def]
    """Write what one node hears to ``values`` and ``arcs``; return how many it hears and how many were withheld."""
    slots = ring.shape[0]
    now = step % slots
    delay_row = b if delay.shape[0] > 1 else 0
    status_row = b if status.shape[0] > 1 else 0
    count = missing = 0
    for e in range(first, last):
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
            missing += state == 2
            continue
        values[count] = value
        arcs[count] = e
        count += 1
    return count, missing


@numba.njit(nogil=True, cache=True)
def advance(  # type: ignore[no-untyped-def]
    lo, hi, step, tau, f, first_order, strict, hold, remember, T,
    p, q, ring, channel, delay, status, update, held, kept, memory, stamp,
    indptr, weight, self_weight, alpha, new_p, new_q,
):  # fmt: skip
    """Advance the runs ``lo .. hi - 1`` by one step: reads ``p, q (B, n)``, writes ``new_p, new_q (B, n)``."""
    widest = 1
    for i in range(indptr.shape[0] - 1):
        widest = max(widest, indptr[i + 1] - indptr[i])
    values, rel = np.empty(widest), np.empty(widest)
    arcs, keep = np.empty(widest, np.int64), np.empty(widest, np.uint8)
    above, below = np.empty(widest), np.empty(widest)
    half = T * T / 2
    for b in range(lo, hi):
        update_row = b if update.shape[0] > 1 else 0
        for i in range(indptr.shape[0] - 1):
            first, last = indptr[i], indptr[i + 1]
            own = p[b, i]
            updates = update[update_row, i]
            total = mass = 0.0
            if updates or remember:
                count, missing = _listen(
                    b, first, last, step, tau, ring, channel, delay, status, remember, memory, stamp, values, arcs
                )
            if updates:
                for t in range(count):
                    rel[t] = values[t] - own
                _drop_extremes(rel, count, f - missing, strict, above, below, keep)
                if hold:
                    for e in range(first, last):
                        kept[b, e] = 0
                for t in range(count):
                    if keep[t]:
                        total += weight[arcs[t]] * rel[t]
                        mass += weight[arcs[t]]
                        if hold:
                            held[b, arcs[t]] = values[t]
                            kept[b, arcs[t]] = 1
            elif not first_order:
                for e in range(first, last):
                    if kept[b, e]:
                        total += weight[e] * (held[b, e] - own)
            if first_order:
                new_p[b, i] = own + total / (self_weight[i] + mass)
                new_q[b, i] = 0.0
            else:
                u = total - alpha[i] * q[b, i]
                new_p[b, i] = (own + T * q[b, i]) + half * u
                new_q[b, i] = q[b, i] + T * u


@numba.njit(nogil=True, cache=True)
def worst_delays(step, bound, ring, channel, heads, above, delays):  # type: ignore[no-untyped-def]
    """Write to ``delays (B, A)`` the least delay that shows each receiver the greatest value, or the least.

    The greatest where ``above (B, n)`` is nonzero at the receiver ``heads (A,)``, the least elsewhere, among the
    delays 0 .. bound.
    """
    slots = ring.shape[0]
    now = step % slots
    for b in range(delays.shape[0]):
        for e in range(delays.shape[1]):
            place, up = channel[e], above[b, heads[e]]
            chosen, best = 0, ring[now, b, place]
            for late in range(1, bound + 1):
                value = ring[now - late if late <= now else now - late + slots, b, place]
                if value > best if up else value < best:
                    chosen, best = late, value
            delays[b, e] = chosen


@numba.njit(nogil=True, cache=True)
def fill_uniform(stream, values):  # type: ignore[no-untyped-def]
    """Write to ``values (B, m)`` the uniform numbers that :mod:`robustness.simulation.draws` defines.

    Row b holds the SplitMix64 outputs of the counters ``stream[b] + (1 .. m) * golden``, as multiples of 2**-53.
    """
    for b in range(values.shape[0]):
        word = stream[b]
        for j in range(values.shape[1]):
            word += _GOLDEN
            mixed = (word ^ (word >> _30)) * _FIRST
            mixed = (mixed ^ (mixed >> _27)) * _SECOND
            values[b, j] = np.float64((mixed ^ (mixed >> _31)) >> _11) * 2.0**-53


@numba.njit(nogil=True, cache=True)
def extremes(p, q, normal, low, high, fastest):  # type: ignore[no-untyped-def]
    """Write, for every run, the least and greatest p and the greatest ``|q|`` of the normal vehicles."""
    for b in range(p.shape[0]):
        lo, hi, quick = np.inf, -np.inf, 0.0
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
