"""What :func:`robustness.sampling.sample_robustness` returns: its own verdict, which no other command has."""

from __future__ import annotations

import enum
from dataclasses import dataclass, field
from decimal import ROUND_CEILING, Context, Decimal
from typing import Any, NoReturn

from robustness.spelled import counted
from robustness.told import Told

__all__ = ["SampleResult", "SampleVerdict"]


class SampleVerdict(enum.Enum):
    """What samples say. Neither value is a proof; :class:`robustness.Verdict` has the verdicts that are proven."""

    #: Were the network not r-robust, samples like these would be rarer than the level.
    LIKELY = "likely-robust"
    #: The samples do not say so, or a limit came first. Nothing is claimed.
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True, repr=False)
class SampleResult(Told):
    """What samples of a network say.

    Attributes
    ----------
    verdict : SampleVerdict
    r : int
        What was asked; without a question, the greatest r that the samples speak for, 0 if none.
    chance : float
        For LIKELY: an upper bound, rounded up, on the probability that samples of a network which is not r-robust say
        so. It is no probability that the network is r-robust.
    nodes, repeats, q : int
        Of each sample; how many samples; and what each of them has been proven to be: q-robust.
    seed : int
        What the samples were drawn with.
    reason : str
        Of UNDECIDED.
    stats : dict
    seconds : float
    """

    verdict: SampleVerdict
    r: int
    chance: float
    nodes: int
    repeats: int
    q: int
    seed: int
    reason: str = ""
    stats: dict[str, Any] = field(default_factory=dict, compare=False)
    seconds: float = field(default=0.0, compare=False)

    def __bool__(self) -> NoReturn:
        raise TypeError("a sample proves nothing, and is no truth value: look at .verdict and .chance")

    def summary(self) -> str:
        """Return a sentence that says what is claimed and what is not."""
        if self.verdict is SampleVerdict.UNDECIDED:
            return f"undecided: {self.reason} (samples prove nothing in any case)"
        return (
            f"likely {self.r}-robust, not a proof: {counted(self.repeats, 'random sample')} of "
            f"{counted(self.nodes, 'node')} {'is' if self.repeats == 1 else 'are all'} "
            f"{self.q}-robust; of a network that is not {self.r}-robust they are with probability "
            f"{_rounded_up(self.chance)} at most"
        )

    def evidence(self) -> list[tuple[str, str]]:
        """Return how the samples were drawn, as rows of a name and a text."""
        return [("samples", f"{self.repeats} of {counted(self.nodes, 'node')}"), ("seed", f"{self.seed}")]

    def as_dict(self) -> dict[str, Any]:
        """Return what a test says as JSON-ready values, without the key ``verdict``, which is for what is proven."""
        return {
            "sample_verdict": self.verdict.value,
            "is_proof": False,
            "r": self.r,
            "chance_of_error": self.chance,
            "nodes": self.nodes,
            "repeats": self.repeats,
            "q": self.q,
            "seed": self.seed,
            "reason": self.reason,
            "seconds": round(self.seconds, 6),
        }


def _rounded_up(chance: float) -> str:
    """Return a probability in two digits that are not less than it.

    >>> [_rounded_up(x) for x in (0.000744, 0.000741, 1.0, 0.0, 1e-6, 0.0996)]
    ['0.00075', '0.00075', '1', '0', '1e-06', '0.1']
    """
    return f"{float(Context(prec=2, rounding=ROUND_CEILING).plus(Decimal(repr(chance)))):.2g}"
