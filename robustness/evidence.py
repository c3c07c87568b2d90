"""What an answer about (r,s)-robustness rests on: one type for each kind of evidence.

The type tells what decided; what a certificate can carry of it is said in one place,
:func:`robustness.decision.certification.kernel_evidence`. None of these types decides anything itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from robustness.transcripts import Transcript

__all__ = [
    "Convention",
    "DegreeRule",
    "Evidence",
    "Exhausted",
    "Growth",
    "LimitReached",
    "Pair",
    "Refutation",
    "Spectral",
    "ViolatingPair",
]


class Pair(NamedTuple):
    """A violating pair as id sets."""

    first: frozenset[int]
    second: frozenset[int]


@dataclass(frozen=True, slots=True)
class Convention:
    """No pair of sets exists, or none matters, and a convention of :mod:`robustness.definitions` decides."""

    holds: bool
    rule: str


@dataclass(frozen=True, slots=True)
class ViolatingPair:
    """A pair for which the definition fails."""

    pair: Pair


@dataclass(frozen=True, slots=True)
class DegreeRule:
    """Every node hears at least ``floor(n/2) + r - 1`` others: :mod:`robustness.decision.bounds.degree`."""


@dataclass(frozen=True, slots=True, eq=False)
class Growth:
    """A robust seed from which all other nodes grow: :mod:`robustness.decision.bounds.growth`.

    Attributes
    ----------
    r, s : int
        What it proves.
    seed : tuple of int
        Ids of nodes whose induced subgraph is (r,s)-robust.
    order : array of int32, shape (n - len(seed),)
        All other ids; each hears at least r + s - 1 nodes of the seed and of those before it.
    seed_proof : str
        ``"node"``: one node (r = s = 1); ``"degree"``: each node of the seed of k nodes hears at least floor(k/2) +
        r - 1 of it; ``"exhaustive"``: every pair of subsets of it was examined.
    """

    r: int
    s: int
    seed: tuple[int, ...]
    order: npt.NDArray[np.int32]
    seed_proof: Literal["node", "degree", "exhaustive"]


@dataclass(frozen=True, slots=True)
class Spectral:
    """The spectral theorem of :mod:`robustness.decision.bounds.spectral`, with lambda_2 above ``mu = 2 (r - 1)``."""

    r: int
    mu: int


@dataclass(frozen=True, slots=True)
class Refutation:
    """The transcript of a complete search, which ``certificates`` replays (docs/certificate-format.md)."""

    transcript: Transcript


@dataclass(frozen=True, slots=True)
class Exhausted:
    """An algorithm looked for a violating pair until none was left; what is trusted is that algorithm's code."""


@dataclass(frozen=True, slots=True)
class LimitReached:
    """Nothing was decided, for this reason."""

    reason: str


Evidence = Convention | ViolatingPair | DegreeRule | Growth | Spectral | Refutation | Exhausted | LimitReached
