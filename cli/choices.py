"""Names that users choose from, written out so that --help need not import the library; a test compares each table."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

__all__ = [
    "ADVERSARY_NAMES",
    "ALGORITHM_NAMES",
    "EXPERIMENT_NAMES",
    "FACES",
    "FAULT_MODEL_NAMES",
    "FORMAT_NAMES",
    "RULE_NAMES",
    "SCHEDULE_NAMES",
    "THREAT_MODEL_NAMES",
]

#: ``auto`` and the names in ``robustness.ALGORITHMS``.
ALGORITHM_NAMES = ("auto", "exhaustive", "transform", "subset-search", "milp", "cp-sat")

#: How many faces a malicious node has under a threat model, and how malicious nodes are bounded.
FACES: Mapping[str, tuple[int, str]] = MappingProxyType(
    {
        "malicious": (1, "total"),
        "malicious-local": (1, "local"),
        "byzantine": (2, "total"),
        "byzantine-local": (2, "local"),
        "delayed": (2, "total"),
        "delayed-local": (2, "local"),
    }
)

#: The names in ``robustness.threat_models.THREAT_MODELS``, for tolerance, attacks and certificates.
THREAT_MODEL_NAMES = tuple(FACES)

#: What a simulation is made of: the registries of ``robustness.simulation``.
RULE_NAMES = ("adp-msr", "dp-msr", "w-msr")
FAULT_MODEL_NAMES = ("malicious", "malicious-local", "byzantine", "byzantine-local")
SCHEDULE_NAMES = ("synchronous", "periodic", "random", "adversarial", "delayed")
ADVERSARY_NAMES = ("auto", "constant", "ramp", "sine", "random", "two-face", "extreme", "greedy", "crash", "omission")

#: The names in ``robustness.files.FORMAT_NAMES``.
FORMAT_NAMES = (
    "json", "graphml", "gexf", "xml", "gml", "edge-list", "adjacency-list", "matrix", "text", "csv", "npy", "npz",
    "mat", "matrix-market", "dot", "pajek", "graph6", "sparse6", "digraph6",
)  # fmt: skip

#: The names in ``robustness.paper.experiments.EXPERIMENTS``.
EXPERIMENT_NAMES = (
    "setting-1", "setting-2", "proposition-1", "necessity", "sufficiency", "gap", "corollary-1", "corollary-2",
    "gains-outside", "swap", "push",
)  # fmt: skip
