"""What is kept when a limit or Ctrl-C stops the work."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.decision.bounds import spectral
from robustness.threat_models.decisions import Decisions, Finding

DENSE = nx.gnp_random_graph(100, 0.5, seed=1)


def test_an_undecided_answer_tells_what_is_known() -> None:
    result = rb.check_rs_robustness(DENSE, 24, time_limit=1e-6)
    assert result.verdict is rb.Verdict.UNDECIDED
    assert result.bounds is not None
    assert 10 < result.bounds.lower.value < result.bounds.upper.value < 50


@pytest.mark.parametrize("model", ["malicious", "malicious-local", "byzantine", "delayed-local"])
def test_a_limit_that_has_passed_ends_the_questions(monkeypatch: pytest.MonkeyPatch, model: str) -> None:
    """Of the numbers f that no lemma settles, one is tried after the limit, not all."""
    undecided = []
    asked = Decisions.attack

    def attack(self: Decisions, *arguments: Any) -> Finding:
        found = asked(self, *arguments)
        undecided.append(found.exists is None)
        return found

    monkeypatch.setattr(Decisions, "attack", attack)
    result = rb.tolerance(DENSE, model, time_limit=1e-6)
    assert sum(undecided) <= 1
    assert result.guaranteed >= 0
    assert result.refuted is not None or model != "malicious"


def test_the_spectrum_of_a_graph_is_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    computed = []
    evidence = spectral._evidence

    def counting(graph: rb.Digraph) -> object:
        computed.append(graph)
        return evidence(graph)

    monkeypatch.setattr(spectral, "_evidence", counting)
    graph = rb.Digraph.from_networkx(nx.gnp_random_graph(90, 0.5, seed=3))
    for r in range(12, 30):
        rb.check_rs_robustness(graph, r, time_limit=1e-6)
    assert len(computed) == 1


def interrupted(*arguments: str, after: str) -> tuple[int, str, str]:
    """Return exit code and output of a command that gets Ctrl-C when the file ``after`` has been there for a while."""
    code = f"import sys; sys.argv[1:] = {list(arguments)!r}; from cli.main import main; open({after!r}, 'w'); main()"
    process = subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    while not os.path.exists(after):
        time.sleep(0.05)
    time.sleep(5)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check -r 24", "certify -r 24 -o {out}"])
def test_ctrl_c_keeps_what_is_proven(command: str, tmp_path: Path) -> None:
    path = tmp_path / "dense.json"
    rb.write_topology(DENSE, path)
    name, *options = command.format(out=tmp_path / "x.cert").split()
    code, out, err = interrupted(name, str(path), *options, after=str(tmp_path / "started"))
    assert code == 130
    assert "nothing else is claimed" in err
    assert out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "kept"),
    [
        ("find -n 4..14 -p 5-robust -p max-degree<=6 --fewest-edges", "none on 4"),
        ("joint {sequence} -r 14", "fewer than"),
    ],
)
def test_ctrl_c_tells_what_was_proven_on_the_way(command: str, kept: str, tmp_path: Path) -> None:
    path = tmp_path / "sequence.json"
    steps = [[list(arc) for arc in nx.gnp_random_graph(60, 0.12, seed=k, directed=True).edges] for k in range(8)]
    path.write_text(json.dumps({"nodes": list(range(60)), "period": 8, "steps": steps}))
    code, out, err = interrupted(*command.format(sequence=path).split(), after=str(tmp_path / "started"))
    assert code == 130
    assert "nothing else is claimed" in err
    assert kept in out
