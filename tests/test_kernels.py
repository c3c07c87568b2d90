"""The kernels: machine code is used only when it was made from the sources beside it, and both ways agree."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from robustness import kernels
from robustness.kernels import sources

ROOT = Path(__file__).resolve().parent.parent

#: Exercises every kernel and prints what each says.
PROGRAM = """
import json
import networkx as nx
import robustness as rb
from robustness import kernels
from robustness.decision.algorithms import ALGORITHMS
from robustness.limits import Limits, Steps
from robustness.decision.bounds.growth import find_growth
from robustness.decision.bounds.local_search import find_violation
from robustness.simulation import Scenario, as_topology, random_start, simulate
from robustness.traps import find_trap

said = []
for seed in range(3):
    for directed in (False, True):
        graph = rb.Digraph.from_networkx(nx.gnp_random_graph(9, 0.6, seed=seed, directed=directed))
        for r in range(1, 6):
            for s in (1, 2, 4):
                answer = ALGORITHMS["subset-search"](graph, r, s, Limits(), transcript=True)
                pair = answer.pair and [sorted(side) for side in answer.pair]
                said.append([answer.verdict.value, pair, answer.stats["nodes"], (answer.transcript or b"").hex()])
        for faces in (1, 2):
            for local in (False, True):
                trap = find_trap(graph, 1, faces=faces, local=local, algorithm="search")
                said.append([trap.exists, sorted(trap.M), sorted(trap.S1), sorted(trap.S2), dict(trap.stats)])
graph = rb.Digraph.from_networkx(nx.random_regular_graph(4, 14, seed=1))
pair = find_violation(graph, 3, steps=Steps(10**7), restarts=2)
said.append(pair and [sorted(side) for side in pair])
growth = find_growth(rb.Digraph.from_networkx(nx.wheel_graph(14)), 2)
said.append([growth.seed, growth.order.tolist()])
dense = rb.Digraph.from_networkx(nx.gnp_random_graph(20, 0.6, seed=3))
growths = [find_growth(dense, r, s, steps=Steps(10**8)) for r, s in ((3, 1), (2, 3), (4, 3))]
said.append([growth and [growth.seed, growth.order.tolist(), growth.seed_proof] for growth in growths])
network = as_topology(nx.complete_graph(5), steps=1)
outcome, = simulate(Scenario(network, f=1, steps=20), [random_start(network.union, [4], seed=0)], record=True)
said.append(outcome.verdict.value)
print(json.dumps({"compiled": kernels.IS_COMPILED, "why": kernels.WHY_NOT, "said": said}))
"""


def run(folder: Path, **environment: str) -> dict[str, object]:
    """Run the program on the packages in ``folder``."""
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", PROGRAM],
        cwd=folder,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", **environment},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def compiled() -> dict[str, object]:
    return run(ROOT)


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """A copy of the installed packages, machine code and all."""
    for package in ("robustness", "certificates"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def test_these_tests_run_machine_code(compiled: dict[str, object]) -> None:
    assert kernels.IS_COMPILED, kernels.WHY_NOT
    assert (compiled["compiled"], compiled["why"]) == (True, "")


def test_plain_python_says_the_same_to_the_letter(compiled: dict[str, object]) -> None:
    plain = run(ROOT, ROBUSTNESS_KERNELS="interpreted")
    assert (plain["compiled"], plain["why"]) == (False, "ROBUSTNESS_KERNELS=interpreted")
    assert plain["said"] == compiled["said"]


@pytest.mark.parametrize("changed", ["search_rules.py", "words.py", "steps.pxd", "layout.py"])
def test_an_upgrade_of_one_source_leaves_no_old_machine_code_in_use(
    changed: str, installed: Path, compiled: dict[str, object]
) -> None:
    """As after 'git pull' without 'make', or half an upgrade: every kernel may hold code of the one that changed."""
    source = installed / "robustness" / "kernels" / changed
    source.write_text(source.read_text(encoding="utf-8") + "\n# A comment, this time.\n", encoding="utf-8")
    upgraded = run(installed)
    assert upgraded["compiled"] is False
    assert "was made from other sources: run 'make' or 'pip install .' again" in str(upgraded["why"])
    assert upgraded["said"] == compiled["said"]


def test_a_changed_rule_takes_effect_at_once(installed: Path, compiled: dict[str, object]) -> None:
    """The audit's case: a rule that is broken in the source is broken in the answer, whatever was compiled before."""
    source = installed / "robustness" / "kernels" / "search_rules.py"
    text = source.read_text(encoding="utf-8")
    assert "if left < 0 or self.blockers == 0:" in text
    source.write_text(text.replace("if left < 0 or self.blockers == 0:", "if True:"), encoding="utf-8")
    assert run(installed)["said"] != compiled["said"]


@pytest.mark.parametrize("damage", [b"", b"\x7fELF", os.urandom(1000)], ids=["empty", "cut off", "random"])
def test_damaged_machine_code_is_not_used(damage: bytes, installed: Path, compiled: dict[str, object]) -> None:
    (code,) = (installed / "robustness" / "kernels").glob("tabu.*.so")
    code.write_bytes(damage)
    damaged = run(installed)
    assert damaged["compiled"] is False
    assert "tabu cannot be loaded" in str(damaged["why"])
    assert damaged["said"] == compiled["said"]


def test_without_machine_code_the_sources_run(installed: Path, compiled: dict[str, object]) -> None:
    for code in (installed / "robustness" / "kernels").glob("*.so"):
        code.unlink()
    plain = run(installed)
    assert "installed without a C compiler" in str(plain["why"])
    assert plain["said"] == compiled["said"]


def test_the_digest_is_of_names_and_contents(tmp_path: Path) -> None:
    seen = set()
    for name, content in (("a.py", "x"), ("b.py", "x"), ("a.py", "y"), ("a.pxd", "y")):
        folder = tmp_path / f"{name}{content}"
        folder.mkdir()
        (folder / name).write_text(content, encoding="utf-8")
        seen.add(sources.digest(folder))
    assert len(seen) == 4


def test_the_command_says_in_one_line_that_machine_code_is_not_used(installed: Path) -> None:
    shutil.copytree(ROOT / "cli", installed / "cli", ignore=shutil.ignore_patterns("__pycache__"))
    source = installed / "robustness" / "kernels" / "words.py"
    source.write_text(source.read_text(encoding="utf-8") + "\n# Pulled, not built.\n", encoding="utf-8")
    # Twenty-four nodes of degree six: no shortcut of small graphs, so that a kernel is called.
    links = [{"source": i, "target": (i + k) % 24} for i in range(24) for k in (1, 2, 3)]
    graph = {"directed": False, "multigraph": False, "nodes": [{"id": i} for i in range(24)], "edges": links}
    (installed / "g.json").write_text(json.dumps(graph), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "cli", "check", "g.json", "-r", "2"],
        cwd=installed, env={"PATH": os.environ["PATH"], "PYTHONPATH": str(installed)},
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    (said,) = (line for line in done.stderr.splitlines() if "slow" in line)
    assert "was made from other sources: run 'make' or 'pip install .' again" in said
