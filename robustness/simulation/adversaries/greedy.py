"""Greedy: the claim that leaves the normal vehicles farthest apart one step later."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from robustness.simulation.adversaries.protocol import Move, View

__all__ = ["Greedy"]


@dataclass(frozen=True, slots=True)
class Greedy:
    """Searches, node by node, over the values at which some neighbour changes what it keeps.

    What a vehicle drops changes only where a claim passes the value of another vehicle, and in between the next
    positions move one way with the claim; so the values of all vehicles, and one beyond each end, are candidates
    enough for one malicious node. Several are improved one after the other. Among equal candidates the first wins.
    """

    def play(self, view: View) -> Move:
        """Return the best claims found, which are also the true positions."""
        setting = view.setting
        low, high = setting.normal_range(view.p)
        outside = high - low + 1.0
        ends = np.concatenate([low - outside, low, high, high + outside], axis=1)
        inside = np.where(setting.malicious, low, view.p)
        candidates = np.concatenate([inside, ends], axis=1).T[:, :, None]
        sent = inside
        runs, choices = np.arange(len(sent)), len(candidates)
        p, q = np.tile(view.p, (choices, 1)), np.tile(view.q, (choices, 1))
        malicious = np.tile(setting.malicious, (choices, 1))
        counts = setting.malicious.sum(axis=1)
        members = np.argsort(~setting.malicious, axis=1, kind="stable")
        for turn in range(int(counts.max(initial=0))):
            # In each run the turn of another node: the malicious ones come first in their row of ``members``.
            mine = (np.arange(setting.graph.n) == members[:, turn, None]) & (turn < counts)[:, None]
            trials = np.where(mine, candidates, sent)
            reached = setting.trial(p, q, trials.reshape(p.shape))
            top = np.where(malicious, -np.inf, reached).max(axis=1, initial=-np.inf)
            bottom = np.where(malicious, np.inf, reached).min(axis=1, initial=np.inf)
            best = (top - bottom).reshape(choices, -1).argmax(axis=0)
            sent = trials[best, runs]
        claims = np.where(setting.malicious, sent, np.nan)
        return Move(sent=claims, positions=claims)
