"""One exact search on many workers: cubes, who solves them, their journal, and how much is left: docs/cluster.md."""

from robustness.cubes.cube import Cube, software
from robustness.cubes.estimate import Estimate
from robustness.cubes.executors import CubeExecutor, opened_cluster
from robustness.cubes.solving import solve

__all__ = ["Cube", "CubeExecutor", "Estimate", "opened_cluster", "software", "solve"]
