"""Search for graphs with given properties."""

from robustness.graph_search.front import find_graph
from robustness.graph_search.properties import (
    Connected,
    Edges,
    HasTrap,
    InDegree,
    Property,
    RRobust,
    RSRobust,
    parse_property,
    regular,
)
from robustness.graph_search.results import FindResult, FindVerdict

__all__ = [
    "Connected",
    "Edges",
    "FindResult",
    "FindVerdict",
    "HasTrap",
    "InDegree",
    "Property",
    "RRobust",
    "RSRobust",
    "find_graph",
    "parse_property",
    "regular",
]
