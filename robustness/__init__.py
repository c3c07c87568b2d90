"""Exact graph robustness for resilient consensus, with evidence anybody can check."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from robustness.decision.algorithms import ALGORITHMS
from robustness.decision.certification import certify
from robustness.decision.front import (
    check_rs_robustness,
    determine_robustness,
    is_r_robust,
    is_rs_robust,
    robustness_profile,
)
from robustness.definitions import r_reachable_nodes
from robustness.digraph import Digraph, GraphWarning
from robustness.errors import (
    InternalError,
    InvalidGraph,
    InvalidParameter,
    MissingExtra,
    RobustnessError,
    Undecided,
    UnreadableTopology,
)
from robustness.results import Bound, Bounds, RobustnessResult, Verdict, Witness

if TYPE_CHECKING:
    from robustness.figures.network import draw
    from robustness.files import read_topology, write_topology
    from robustness.graph_search import find_graph
    from robustness.simulation.front import simulate
    from robustness.surveying import Gate, survey
    from robustness.threat_models import ToleranceResult, tolerance
    from robustness.time_varying import (
        JointResult,
        TimeVaryingGraph,
        certify_joint,
        check_joint_robustness,
        joint_curve,
    )

#: Names whose modules are imported when they are first asked for.
_LATER = {
    "Gate": "robustness.surveying",
    "JointResult": "robustness.time_varying",
    "TimeVaryingGraph": "robustness.time_varying",
    "ToleranceResult": "robustness.threat_models",
    "certify_joint": "robustness.time_varying",
    "check_joint_robustness": "robustness.time_varying",
    "constructions": "robustness.constructions",
    "draw": "robustness.figures.network",
    "find_graph": "robustness.graph_search",
    "joint_curve": "robustness.time_varying",
    "read_topology": "robustness.files",
    "simulate": "robustness.simulation.front",
    "survey": "robustness.surveying",
    "tolerance": "robustness.threat_models",
    "write_topology": "robustness.files",
}

__all__ = [
    "ALGORITHMS",
    "Bound",
    "Bounds",
    "Digraph",
    "Gate",
    "GraphWarning",
    "InternalError",
    "InvalidGraph",
    "InvalidParameter",
    "JointResult",
    "MissingExtra",
    "RobustnessError",
    "RobustnessResult",
    "TimeVaryingGraph",
    "ToleranceResult",
    "Undecided",
    "UnreadableTopology",
    "Verdict",
    "Witness",
    "certify",
    "certify_joint",
    "check_joint_robustness",
    "check_rs_robustness",
    "determine_robustness",
    "draw",
    "find_graph",
    "is_r_robust",
    "is_rs_robust",
    "joint_curve",
    "r_reachable_nodes",
    "read_topology",
    "robustness_profile",
    "simulate",
    "survey",
    "tolerance",
    "write_topology",
]


def __dir__() -> list[str]:
    """Return every public name, those that are imported later among them."""
    return sorted({*__all__, "__version__", "constructions"})


def __getattr__(name: str) -> Any:
    """Import what only some users need when they ask for it, so that ``import robustness`` stays fast."""
    if name == "__version__":
        from importlib.metadata import version

        return version("graph-robustness")
    if name not in _LATER:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module = importlib.import_module(_LATER[name])
    return module if name == "constructions" else getattr(module, name)
