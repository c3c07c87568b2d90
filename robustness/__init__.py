"""Exact graph robustness for resilient consensus, with evidence anybody can check."""

from __future__ import annotations

import importlib
import importlib.util
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
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
    from robustness.figures.network import draw
    from robustness.files import read_topology, write_topology
    from robustness.files.from_memory import from_adjacency, from_edges, from_igraph, from_neighbours
    from robustness.graph_search import find_graph
    from robustness.mending import Goal, MendResult, margin, mend, thin
    from robustness.reporting import report
    from robustness.results import Bound, Bounds, RobustnessResult, Verdict, Witness
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

#: Where each public name lives; the module is imported when the name is first asked for.
_LATER = {
    "ALGORITHMS": "robustness.decision.algorithms",
    "Bound": "robustness.results",
    "Bounds": "robustness.results",
    "Digraph": "robustness.digraph",
    "Gate": "robustness.surveying",
    "GraphWarning": "robustness.digraph",
    "InternalError": "robustness.errors",
    "InvalidGraph": "robustness.errors",
    "InvalidParameter": "robustness.errors",
    "JointResult": "robustness.time_varying",
    "MissingExtra": "robustness.errors",
    "RobustnessError": "robustness.errors",
    "RobustnessResult": "robustness.results",
    "TimeVaryingGraph": "robustness.time_varying",
    "ToleranceResult": "robustness.threat_models",
    "Undecided": "robustness.errors",
    "UnreadableTopology": "robustness.errors",
    "Verdict": "robustness.results",
    "Witness": "robustness.results",
    "certify": "robustness.decision.certification",
    "certify_joint": "robustness.time_varying",
    "check_joint_robustness": "robustness.time_varying",
    "check_rs_robustness": "robustness.decision.front",
    "determine_robustness": "robustness.decision.front",
    "draw": "robustness.figures.network",
    "find_graph": "robustness.graph_search",
    "from_adjacency": "robustness.files.from_memory",
    "from_edges": "robustness.files.from_memory",
    "from_igraph": "robustness.files.from_memory",
    "from_neighbours": "robustness.files.from_memory",
    "is_r_robust": "robustness.decision.front",
    "is_rs_robust": "robustness.decision.front",
    "joint_curve": "robustness.time_varying",
    "r_reachable_nodes": "robustness.definitions",
    "read_topology": "robustness.files",
    "robustness_profile": "robustness.decision.front",
    "simulate": "robustness.simulation.front",
    "Goal": "robustness.mending",
    "MendResult": "robustness.mending",
    "margin": "robustness.mending",
    "mend": "robustness.mending",
    "thin": "robustness.mending",
    "report": "robustness.reporting",
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
    "Goal",
    "GraphWarning",
    "InternalError",
    "InvalidGraph",
    "InvalidParameter",
    "JointResult",
    "MendResult",
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
    "from_adjacency",
    "from_edges",
    "from_igraph",
    "from_neighbours",
    "is_r_robust",
    "is_rs_robust",
    "joint_curve",
    "margin",
    "mend",
    "r_reachable_nodes",
    "read_topology",
    "report",
    "robustness_profile",
    "simulate",
    "survey",
    "thin",
    "tolerance",
    "write_topology",
]


def __dir__() -> list[str]:
    """Return every public name, those that are imported later among them."""
    return sorted({*__all__, "__version__", "constructions"})


def __getattr__(name: str) -> Any:
    """Import what is asked for when it is asked for, so that ``import robustness`` and the command start fast."""
    if name == "__version__":
        from importlib.metadata import version

        return version("graph-robustness")
    if name in _LATER:
        value = getattr(importlib.import_module(_LATER[name]), name)
    elif not name.startswith("_") and importlib.util.find_spec(f"{__name__}.{name}") is not None:
        value = importlib.import_module(f"{__name__}.{name}")
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value
