"""What can it survive? Threat models, what theory promises under each, and the attacks that refute more."""

from robustness.threat_models.certification import ToleranceCertificates, certify_tolerance
from robustness.threat_models.confirmation import confirm
from robustness.threat_models.front import tolerance
from robustness.threat_models.models import THREAT_MODELS, ThreatModel
from robustness.threat_models.parameters import Parameters
from robustness.threat_models.results import AttackSets, Reason, Standing, ToleranceResult, ToleranceTable

__all__ = [
    "THREAT_MODELS",
    "AttackSets",
    "Parameters",
    "Reason",
    "Standing",
    "ThreatModel",
    "ToleranceCertificates",
    "ToleranceResult",
    "ToleranceTable",
    "certify_tolerance",
    "confirm",
    "tolerance",
]
