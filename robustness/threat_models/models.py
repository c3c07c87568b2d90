"""The threat models, and for each the two theorems that bound what a network survives.

For every model there is a condition on f that *promises* agreement (sufficient) and a kind of attack that *proves* that
there is none (its absence is necessary). Where the two leave no f between them the model is *exact*.

=================  ==========================================  =========================================  =======
model              promises agreement against f                 proves a split                             exact
=================  ==========================================  =========================================  =======
malicious          (f+1,f+1)-robust                             its violating pair (one face, f-total)     yes
malicious-local    (2f+1)-robust                                a local violation (one face, f-local)      no
byzantine          no trap for f                                a trap (two faces, f-total)                yes
delayed            (2f+1)-robust                                a trap (two faces, f-total)                no
delayed-local      (2f+1)-robust                                a local trap (two faces, f-local)          no
=================  ==========================================  =========================================  =======

"No trap for f" says: for every set M of at most f (f-local: of any f-local set of) nodes, ``G - M`` is (f+1)-robust. A
violation of (f+1,f+1)-robustness contains a trap (:mod:`robustness.traps.question`), so under delays the trap is
the sharper of the two necessary conditions. Whether it is also sufficient for second-order vehicles is open, and
nothing here says that it is.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from robustness.errors import InvalidParameter
from robustness.traps.question import Question

__all__ = ["SECOND_ORDER_GAINS", "THREAT_MODELS", "ThreatModel", "threat_model_named"]

#: What promises agreement.
RS_ROBUST, TWICE_ROBUST, NO_TRAP = "(f+1,f+1)-robust", "(2f+1)-robust", "no trap"


@dataclass(frozen=True, slots=True)
class ThreatModel:
    """One threat model.

    Attributes
    ----------
    name : str
        As users type it.
    setting : str
        Who misbehaves and how messages travel, in plain words.
    promise : str
        Which condition promises agreement: one of the three above.
    theorem, counter_theorem : str
        The sources of the promise and of the proof that an attack of this kind splits the network.
    two_faces, local : bool
        The kind of attack.
    exact : bool
        Whether either the promise or the attack always holds.
    faults : str
        The fault model of :mod:`robustness.simulation.fault_models` that the attack obeys.
    """

    name: str
    setting: str
    promise: str
    theorem: str
    counter_theorem: str
    two_faces: bool
    local: bool
    exact: bool
    faults: str

    def question(self, f: int) -> Question:
        """Return what the trap search is asked for this f."""
        return Question(f, self.two_faces, self.local)


#: Where the theorems on second-order vehicles hold; the source paper leaves it unsaid. See robustness.gain_region: at
#: s = 1, which the interval of the literature includes, vehicles can swap places for ever.
SECOND_ORDER_GAINS = (
    "for gains in the gain region: weights that add up to at most sigma, s = sigma T² < 1, "
    "2 sqrt(s) - s/2 <= alpha T <= 2 - s/2"
)

_SYNCHRONOUS_TRAP = (
    "Vaidya, Tseng and Liang 2012: each malicious node tells one group one value and the other group another"
)
_DELAYED_TRAP = (
    "a trap splits for ever: malicious nodes alternate, and delays show either group a face of its own "
    "(the argument of the source paper's Proposition 1)"
)

#: Every threat model by its name, from the weakest attacker to the strongest.
THREAT_MODELS: Mapping[str, ThreatModel] = MappingProxyType(
    {
        model.name: model
        for model in (
            ThreatModel(
                "malicious",
                "updates in step, without delays; at most f malicious nodes in all, each telling everybody the same",
                RS_ROBUST,
                f"LeBlanc, Zhang, Koutsoukos and Sundaram 2013, Theorem 1 (W-MSR; DP-MSR {SECOND_ORDER_GAINS})",
                "LeBlanc et al. 2013, Theorem 1, necessity: X_S1 and X_S2 are malicious and stand still",
                two_faces=False,
                local=False,
                exact=True,
                faults="malicious",
            ),
            ThreatModel(
                "malicious-local",
                "updates in step, without delays; up to f malicious nodes around every normal vehicle, however many in "
                "all, each telling everybody the same",
                TWICE_ROBUST,
                "LeBlanc et al. 2013: (2f+1)-robustness suffices for W-MSR under the f-local model",
                "a local violation splits for ever: its malicious nodes stand still (LeBlanc et al. 2013, Theorem 1)",
                two_faces=False,
                local=True,
                exact=False,
                faults="malicious-local",
            ),
            ThreatModel(
                "byzantine",
                "updates in step, without delays; at most f malicious nodes in all, telling each neighbour another lie",
                NO_TRAP,
                "Vaidya, Tseng and Liang 2012, first-order iterative consensus: agreement iff G - M is (f+1)-robust "
                "for every M of at most f nodes",
                _SYNCHRONOUS_TRAP,
                two_faces=True,
                local=False,
                exact=True,
                faults="byzantine",
            ),
            ThreatModel(
                "delayed",
                "partly asynchronous updates and delayed messages (ADP-MSR); at most f malicious nodes in all",
                TWICE_ROBUST,
                f"the source paper, Theorem 1, sufficiency, {SECOND_ORDER_GAINS}",
                _DELAYED_TRAP,
                two_faces=True,
                local=False,
                exact=False,
                faults="malicious",
            ),
            ThreatModel(
                "delayed-local",
                "partly asynchronous updates and delayed messages (ADP-MSR); up to f malicious nodes around every "
                "normal vehicle, however many in all",
                TWICE_ROBUST,
                f"the source paper, first corollary (f-local), {SECOND_ORDER_GAINS}",
                _DELAYED_TRAP,
                two_faces=True,
                local=True,
                exact=False,
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
