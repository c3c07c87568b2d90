"""The estimate of what is left, held against trees whose size is known."""

from __future__ import annotations

import numpy as np
import pytest

from robustness import Digraph
from robustness.cubes import Cube, Estimate, solve
from robustness.cubes.cube import CubeQuestion
from robustness.cubes.estimate import Walker
from tests.cubes.instances import MIDDLE, SMALL, question_of


def size_of(question: CubeQuestion, cube: Cube) -> int:
    result = solve(question.as_task(cube, 1000.0))
    assert result["status"] == "closed"
    return int(result["nodes"])


def part_of(question: CubeQuestion, n: int, rounds: int) -> tuple[list[Cube], int]:
    """Return what is open after so many short slices, and the nodes that were visited."""
    cubes, done = [Cube.whole(n)], 0
    for _ in range(rounds):
        result = solve(question.as_task(cubes.pop(0), 0.001))
        done += result["nodes"]
        if result["status"] == "open":
            cubes += reversed(Cube.from_wire(result["rest"], question.hears.shape[1]).cut(4))
    return cubes, done


@pytest.mark.parametrize("instance", [SMALL, MIDDLE])
@pytest.mark.parametrize("rounds", [0, 6])
def test_intervals_hold_the_truth_and_the_mean_is_near(instance: tuple[Digraph, int], rounds: int) -> None:
    graph, r = instance
    question = question_of(graph, r)
    cubes, done = part_of(question, graph.n, rounds)
    left = sum(size_of(question, cube) for cube in cubes)
    assert done + left == size_of(question, Cube.whole(graph.n))
    found = [Walker(question, seed).nodes_left(cubes, 100) for seed in range(16)]
    held = sum(low <= left <= high for _, low, high in found)
    assert held >= 13
    assert 0.75 < np.mean([about for about, _, _ in found]) / left < 1.33
    assert max(high / low for _, low, high in found) < 30


def test_a_closed_tree_is_estimated_exactly() -> None:
    graph = Digraph(range(4), [(i, j) for i in range(4) for j in range(4) if i != j])
    question = question_of(graph, 1)
    whole = Cube.whole(4)
    assert Walker(question, 0).nodes_left([whole], 1)[0] <= size_of(question, whole)
    assert Walker(question, 0).nodes_left([], 100) == (0.0, 0.0, 0.0)


def test_the_words() -> None:
    estimate = Estimate(410, 590, 400, 900, 2, 0.027)
    assert estimate.in_words() == "closed 41 %, about 3.0 h left on 2 workers (2.1 h to 4.6 h)"
    assert estimate.as_dict()["closed"] == 0.41
    assert estimate.as_dict()["nodes_left"] == [400, 590, 900]
    assert Estimate(410, 590, 400, 900).in_words() == "closed 41 %"
    assert Estimate(7, 0, 0, 0).part == 1.0


def test_a_cube_is_cut_into_what_it_was() -> None:
    states = np.arange(5 * 8 * 2, dtype=np.uint64).reshape(5, 8, 2)
    cube = Cube(states, (True, False, False, True, False))
    for parts in range(1, 8):
        cut = cube.cut(parts)
        assert len(cut) == min(parts, 5)
        # The order of the proof is last states first, so the parts stand on one another in the reverse order.
        assert np.array_equal(np.concatenate([each.states for each in reversed(cut)]), states)
        assert sum((each.symmetric for each in reversed(cut)), ()) == cube.symmetric
    again = Cube.from_wire(cube.to_wire(), 2)
    assert again.key == cube.key != cube.cut(2)[0].key
    for wire in ((b"", ""), (b"1", "1"), ("text", "1"), (b"", "2"), None):
        with pytest.raises((ValueError, TypeError)):
            Cube.from_wire(wire, 2)
