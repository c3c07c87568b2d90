"""One technique, one file, one signature: exact algorithms that look for a violating pair."""

from robustness.decision.algorithms.registry import ALGORITHMS, OPTIONS, Algorithm, require_algorithm, require_options

__all__ = ["ALGORITHMS", "OPTIONS", "Algorithm", "require_algorithm", "require_options"]
