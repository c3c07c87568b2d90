"""The source paper's claims, put to the machine: ``python -m robustness.paper_audit`` writes docs/paper-audit.md.

:mod:`~robustness.paper_audit.about_graphs` and :mod:`~robustness.paper_audit.about_runs` hold the claims,
:mod:`~robustness.paper_audit.census` counts the graphs between the paper's two conditions; Lemma 1 is in
:mod:`robustness.constructions.lemma_1`.
"""

from robustness.paper_audit.census import CensusRow, census
from robustness.paper_audit.claims import Claim, Outcome

__all__ = ["CensusRow", "Claim", "Outcome", "census"]
