"""The threat models, and for each the condition on f that decides: agreement if and only if no attack of a kind exists.

=================  ==========================================  ===============  ==================
model              agreement against f, if and only if         kind of attack   docs/theorems.md
=================  ==========================================  ===============  ==================
malicious          (f+1,f+1)-robust                            one face, total  Theorem B
malicious-local    no local violation for f                    one face, local  Theorem B
byzantine          no trap for f                               two faces        Theorem A
byzantine-local    no local trap for f                         two faces        Theorem A
delayed            no trap for f                               two faces        Theorem A
delayed-local      no local trap for f                         two faces        Theorem A
=================  ==========================================  ===============  ==================

"No trap for f" says: for every set M of at most f (f-local: of any f-local set of) nodes, ``G - M`` is (f+1)-robust.
The kinds of attack are defined in :mod:`robustness.traps.question`. A (2f+1)-robust network has none of any kind: the
sufficient condition of the literature, and the fast way to decide here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from robustness.errors import InvalidParameter
from robustness.traps.question import Question

__all__ = ["SECOND_ORDER_GAINS", "THREAT_MODELS", "ThreatModel", "threat_model_named"]


@dataclass(frozen=True, slots=True)
class ThreatModel:
    """One threat model.

    Attributes
    ----------
    name : str
        As users type it.
    setting : str
        Who misbehaves and how messages travel, in plain words.
    where : str
        The same, as it stands at the beginning of a sentence about what is guaranteed.
    condition : str
        What agreement against f is equivalent to.
    theorem, counter_theorem : str
        The sources: that no attack of this kind means agreement, and that one splits the network.
    two_faces, local : bool
        The kind of attack.
    faults : str
        The fault model of :mod:`robustness.simulation.fault_models` that the attack obeys.
    """

    name: str
    setting: str
    where: str
    condition: str
    theorem: str
    counter_theorem: str
    two_faces: bool
    local: bool
    faults: str

    @property
    def delayed(self) -> bool:
        """Whether it is delays that give a malicious node its two faces."""
        return self.two_faces and not self.faults.startswith("byzantine")

    def question(self, f: int) -> Question:
        """Return what the trap search is asked for this f."""
        return Question(f, self.two_faces, self.local)


#: Where the theorems hold for second-order vehicles. See robustness.gain_region: at s = 1, which the interval of the
#: literature includes, vehicles can swap places for ever.
SECOND_ORDER_GAINS = (
    "second-order nodes (vehicles) in the gain region: weights that add up to at most sigma, s = sigma T² < 1, "
    "2 sqrt(s) - s/2 <= alpha T <= 2 - s/2"
)

_A = f"docs/theorems.md, Theorem A, for first-order nodes and for {SECOND_ORDER_GAINS}"
_B = f"docs/theorems.md, Theorem B, for W-MSR and for {SECOND_ORDER_GAINS}"
_SYNCHRONOUS_TRAP = (
    "Vaidya, Tseng and Liang 2012: each malicious node tells one group one value and the other group another"
)
_DELAYED_TRAP = (
    "docs/theorems.md, Theorem A, necessity: malicious nodes alternate, and delays show either group a face of its own"
)
_STANDING_STILL = "LeBlanc, Zhang, Koutsoukos and Sundaram 2013, Theorem 1, necessity: the malicious stand still"
_ALL = "at most f malicious nodes in all"
_AROUND = "up to f malicious nodes around every normal node, however many in all"

#: Every threat model by its name.
THREAT_MODELS: Mapping[str, ThreatModel] = MappingProxyType(
    {
        model.name: model
        for model in (
            ThreatModel(
                "malicious",
                f"updates in step, without delays; {_ALL}, each telling everybody the same",
                "in step, without delays, against liars who tell everybody the same",
                "(f+1,f+1)-robust",
                f"LeBlanc, Zhang, Koutsoukos and Sundaram 2013, Theorem 1, and {_B}",
                f"{_STANDING_STILL} (X_S1 and X_S2)",
                two_faces=False,
                local=False,
                faults="malicious",
            ),
            ThreatModel(
                "malicious-local",
                f"updates in step, without delays; {_AROUND}, each telling everybody the same",
                "in step, without delays, with up to f such liars around every node",
                "no local violation",
                _B,
                _STANDING_STILL,
                two_faces=False,
                local=True,
                faults="malicious-local",
            ),
            ThreatModel(
                "byzantine",
                f"updates in step, without delays; {_ALL}, telling each neighbour another lie",
                "in step, without delays, against liars who tell each neighbour another story",
                "no trap",
                f"Vaidya, Tseng and Liang 2012, and {_A}",
                _SYNCHRONOUS_TRAP,
                two_faces=True,
                local=False,
                faults="byzantine",
            ),
            ThreatModel(
                "byzantine-local",
                f"updates in step, without delays; {_AROUND}, telling each neighbour another lie",
                "in step, without delays, with up to f such storytellers around every node",
                "no local trap",
                _A,
                _SYNCHRONOUS_TRAP,
                two_faces=True,
                local=True,
                faults="byzantine-local",
            ),
            ThreatModel(
                "delayed",
                f"partly asynchronous updates and delayed messages (ADP-MSR); {_ALL}",
                "with delays and partly asynchronous updates",
                "no trap",
                _A,
                _DELAYED_TRAP,
                two_faces=True,
                local=False,
                faults="malicious",
            ),
            ThreatModel(
                "delayed-local",
                f"partly asynchronous updates and delayed messages (ADP-MSR); {_AROUND}",
                "with delays and up to f liars around every node",
                "no local trap",
                _A,
                _DELAYED_TRAP,
                two_faces=True,
                local=True,
                faults="malicious-local",
            ),
        )
    }
)


def threat_model_named(name: str) -> ThreatModel:
    """Return the threat model of this name, or raise :class:`InvalidParameter` naming those there are."""
    if name not in THREAT_MODELS:
        raise InvalidParameter(f"a threat model is one of {', '.join(THREAT_MODELS)}, not {name!r}")
    return THREAT_MODELS[name]
