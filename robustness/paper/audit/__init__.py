"""The source paper's claims, put to the machine: ``python -m robustness.paper.audit`` writes docs/paper-audit.md.

:mod:`~robustness.paper.audit.about_graphs` and :mod:`~robustness.paper.audit.about_runs` hold the claims,
:mod:`~robustness.paper.audit.census` counts the graphs between the paper's two conditions; Lemma 1 is in
:mod:`robustness.constructions.lemma_1`.
"""

from robustness.paper.audit.census import CensusRow, census
from robustness.paper.audit.claims import Claim, Outcome

__all__ = ["CensusRow", "Claim", "Outcome", "census"]
