"""The inner loop of the simulator: what every normal vehicle hears, keeps and does, for all runs of a batch.

The arithmetic is that of :mod:`robustness.simulation.reference`, operation by operation and in the same order, so that
the two agree bit for bit: no fused or reordered floating-point operations are allowed.

Lengths: B runs, n nodes, A arcs (by receiver, then by sender, both ascending), C channels, H remembered steps. An
array of ``1 or B`` rows has one row for all runs, or one for each.
"""

from __future__ import annotations

import numpy as np

try:
    import cython
except ImportError:
    from robustness.kernels import uncompiled as cython

__all__ = ["Turn", "drop_extremes", "extremes", "fill_uniform", "worst_delays"]

_INFINITY = np.inf
_ALL = 0xFFFFFFFFFFFFFFFF
_GOLDEN, _FIRST, _SECOND = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB


def drop_extremes(rel, number_heard, drop, strict, above, below, keep):
    """Set ``keep[t]`` for t < number_heard: ``drop`` rounds, each of which takes the largest and the smallest value.

    A value is dropped above when it is at least 0 (``strict``: above 0), below when it is at most 0 (below 0). Ties:
    the first of equal values goes above, the last below.

    ``O(number_heard * drop)``, but without unpredictable branches: for the few values that filters drop this is twice
    as fast as insertion buffers, which were tried.

    Parameters
    ----------
    rel : array of float64, shape (d,)
        What was heard, less the own value.
    number_heard, drop : int
    strict : bool
    above, below : arrays of float64, shape (d,)
        Scratch.
    keep : array of uint8, shape (d,)
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


class Turn:
    """One step of a batch: who hears what, by which rule it moves, and where the next states go.

    A turn has scratch memory of its own, so that each thread makes one.

    Parameters
    ----------
    step : int
        Which step; those of the history are negative.
    tau : int
        How old a remembered value may be.
    law : Law
        What holds at every step. ``f``: how many values to drop on either side, less those that were withheld;
        ``first_order``, ``strict``: which rule; ``T``: the sampling period.
    hearing : Hearing
        What reaches the vehicles now, and who updates.
    stores : Stores
        What they keep. ``hold``: held values act between updates; ``remember``: an arc without a link gives the last
        value that it delivered.
    states : States
        The states now, and arrays for those one step later.

    Attributes
    ----------
    indptr : array of int64, shape (n + 1,)
        Arcs ``indptr[i] .. indptr[i + 1] - 1`` end in node i.
    weight : array of float64, shape (A,)
        Of every arc; for first-order rules beside a weight of 1 for the own value.
    alpha : array of float64, shape (n,)
        The gains of second-order rules.
    ring : array of float64, shape (H, B, C)
        What was announced on every channel at step k, in slot ``k % H``.
    channel : array of int64, shape (A,)
        The channel that an arc listens to.
    delay : array of int64, shape (1 or B, A)
        Steps, fewer than H.
    status : array of uint8, shape (1 or B, A)
        0: no link now, 1: delivered, 2: withheld by the sender.
    update : array of uint8, shape (1 or B, n)
        Who updates at this step.
    held : array of float64, shape (B, A)
        The values heard at the last update. Of shape (1, 1) unless ``hold``.
    kept : array of uint8, shape (B, A)
        Whether they passed the filter. Of shape (1, 1) unless ``hold``.
    memory : array of float64, shape (B, A)
        The last delivered value of every arc. Of shape (1, 1) unless ``remember``.
    stamp : array of int64, shape (B, A)
        The step at which it left its sender. Of shape (1, 1) unless ``remember``.
    p, q, new_p, new_q : arrays of float64, shape (B, n)
        Positions and velocities now, and one step later.
    values, rel, above, below : arrays of float64, shape (d,)
        Scratch for the d arcs of the node that hears most: what it hears, less its own value, and what
        :func:`drop_extremes` needs.
    arcs : array of int64, shape (d,)
        The arcs that these values came by.
    keep : array of uint8, shape (d,)
        Which of them pass the filter.
    """

    def __init__(self, step, tau, law, hearing, stores, states):
        self.step, self.tau = step, tau
        self.f, self.first_order, self.strict, self.T = law.f, law.first_order, law.strict, law.T
        self.indptr, self.weight, self.alpha = law.indptr, law.weight, law.alpha
        self.ring, self.channel, self.delay, self.status, self.update = hearing
        self.hold, self.remember, self.held, self.kept, self.memory, self.stamp = stores
        self.p, self.q, self.new_p, self.new_q = states
        widest = 1
        for i in range(self.indptr.shape[0] - 1):
            widest = max(widest, self.indptr[i + 1] - self.indptr[i])
        self.values, self.rel = np.empty(widest), np.empty(widest)
        self.above, self.below = np.empty(widest), np.empty(widest)
        self.arcs, self.keep = np.empty(widest, np.int64), np.empty(widest, np.uint8)

    def _listen(self, b, begin, end):
        """Write what one node hears to ``values`` and ``arcs``; return how many it hears and how many were withheld."""
        slots = self.ring.shape[0]
        now = (self.step % slots + slots) % slots  # the steps of the history are negative
        delay_row = b if self.delay.shape[0] > 1 else 0
        status_row = b if self.status.shape[0] > 1 else 0
        heard, missing = 0, 0
        for e in range(begin, end):
            state = self.status[status_row, e]
            if state == 1:
                late = self.delay[delay_row, e]
                # Delays are shorter than the ring, so this is (step - late) % slots without a division.
                value = self.ring[now - late if late <= now else now - late + slots, b, self.channel[e]]
                if self.remember:
                    self.memory[b, e] = value
                    self.stamp[b, e] = self.step - late
            elif state == 0 and self.remember and self.step - self.stamp[b, e] <= self.tau:
                value = self.memory[b, e]
            else:
                if state == 2:
                    missing += 1
                continue
            self.values[heard] = value
            self.arcs[heard] = e
            heard += 1
        return heard, missing

    def _pull(self, b, i, own, heard, missing):
        """Return the weighted sum of the relative values that pass the filter, and of their weights."""
        for t in range(heard):
            self.rel[t] = self.values[t] - own
        drop_extremes(self.rel, heard, self.f - missing, self.strict, self.above, self.below, self.keep)
        if self.hold:
            for e in range(self.indptr[i], self.indptr[i + 1]):
                self.kept[b, e] = 0
        total, mass = 0.0, 0.0
        for t in range(heard):
            if self.keep[t]:
                e = self.arcs[t]
                total += self.weight[e] * self.rel[t]
                mass += self.weight[e]
                if self.hold:
                    self.held[b, e] = self.values[t]
                    self.kept[b, e] = 1
        return total, mass

    def _advance(self, lo, hi):
        half = self.T * self.T / 2
        for b in range(lo, hi):
            update_row = b if self.update.shape[0] > 1 else 0
            for i in range(self.indptr.shape[0] - 1):
                own, speed = self.p[b, i], self.q[b, i]
                updates = self.update[update_row, i]
                total, mass, heard, missing = 0.0, 0.0, 0, 0
                if updates or self.remember:
                    heard, missing = self._listen(b, self.indptr[i], self.indptr[i + 1])
                if updates:
                    total, mass = self._pull(b, i, own, heard, missing)
                elif self.hold and not self.first_order:
                    for e in range(self.indptr[i], self.indptr[i + 1]):
                        if self.kept[b, e]:
                            total += self.weight[e] * (self.held[b, e] - own)
                if self.first_order:
                    self.new_p[b, i] = own + total / (1.0 + mass)
                    self.new_q[b, i] = 0.0
                else:
                    u = total - self.alpha[i] * speed
                    self.new_p[b, i] = (own + self.T * speed) + half * u
                    self.new_q[b, i] = speed + self.T * u

    def advance(self, lo, hi):
        """Advance the runs ``lo .. hi - 1`` by one step."""
        first, last = lo, hi
        with cython.nogil:
            self._advance(first, last)


def worst_delays(step, bound, ring, channel, heads, above, delays):
    """Write to ``delays`` the least of the delays 0 .. bound that shows each receiver the greatest value, or the least.

    Parameters
    ----------
    step, bound : int
    ring : array of float64, shape (H, B, C)
        As of :class:`Turn`.
    channel, heads : arrays of int64, shape (A,)
        The channel that an arc listens to, and its receiver.
    above : array of uint8, shape (B, n)
        1: the receiver is to be shown the greatest value, 0: the least.
    delays : array of int64, shape (B, A)
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
    """Write to ``values`` the uniform numbers that :mod:`robustness.simulation.draws` defines.

    Row b holds the SplitMix64 outputs of the counters ``stream[b] + (1 .. m) * golden``, as multiples of 2**-53.

    Parameters
    ----------
    stream : array of uint64, shape (B,)
    values : array of float64, shape (B, m)
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
    """Write, for every run, the least and greatest p and the greatest ``|q|`` of the normal vehicles.

    Parameters
    ----------
    p, q : arrays of float64, shape (B, n)
    normal : array of uint8, shape (B, n)
    low, high, fastest : arrays of float64, shape (B,)
        For a run without a normal vehicle: infinity, minus infinity and 0.
    """
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
