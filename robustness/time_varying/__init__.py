"""Time-varying graphs: sequences of graphs on one node set, and whether they are jointly (r,s)-robust."""

from robustness.time_varying.certification import canonical_sequence, certify_joint, joint_certificate
from robustness.time_varying.front import check_joint_robustness, joint_curve
from robustness.time_varying.reading import encode_sequence, read_sequence
from robustness.time_varying.results import JointResult, UnionVerdict, Violation
from robustness.time_varying.sequence import TimeVaryingGraph

__all__ = [
    "JointResult",
    "TimeVaryingGraph",
    "UnionVerdict",
    "Violation",
    "canonical_sequence",
    "certify_joint",
    "check_joint_robustness",
    "encode_sequence",
    "joint_certificate",
    "joint_curve",
    "read_sequence",
]
