"""Proofs for a third party's checker, in the pseudo-Boolean format of VeriPB."""

from robustness.decision.veripb.front import export

__all__ = ["export"]
