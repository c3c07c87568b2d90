"""``robustness simulate`` and ``robustness attack``: outcomes, exit codes, files."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli import choices, simulate_runs
from cli.exit_codes import ExitCode
from cli.main import robustness
from robustness.files import encode_topology
from robustness.paper.experiments import EXPERIMENTS
from robustness.simulation import ADVERSARIES, RULES, SCHEDULES, finding
from robustness.simulation.claim import Claim
from robustness.simulation.fault_models import FAULT_MODELS
from robustness.simulation.finding import ATTACK_MODELS
from robustness.threat_models import THREAT_MODELS

WHEEL, CYCLE, COMPLETE = (
    encode_topology(graph) for graph in (nx.wheel_graph(5), nx.cycle_graph(6), nx.complete_graph(5))
)


def run(*arguments: str | Path, graph: bytes | None = None) -> Result:
    return CliRunner().invoke(robustness, [str(argument) for argument in arguments], input=graph)


def document(*arguments: str | Path, graph: bytes | None = None) -> dict[str, Any]:
    done = run(*arguments, "--json", graph=graph)
    assert done.stdout.count("\n") == 1, done.output
    return json.loads(done.stdout)


def test_the_choices_are_those_of_the_library() -> None:
    assert sorted(choices.RULE_NAMES) == sorted(RULES)
    assert sorted(choices.FAULT_MODEL_NAMES) == sorted(FAULT_MODELS)
    assert sorted(choices.SCHEDULE_NAMES) == sorted(SCHEDULES)
    assert sorted(choices.ADVERSARY_NAMES) == sorted([*ADVERSARIES, "auto"])
    assert sorted(choices.EXPERIMENT_NAMES) == sorted(EXPERIMENTS)
    assert choices.THREAT_MODEL_NAMES == ATTACK_MODELS == tuple(THREAT_MODELS)


class TestSimulate:
    def test_json_key_by_key(self) -> None:
        found = document("simulate", "-", "--adversary", "ramp", "--malicious", "0", graph=WHEEL)
        (only,) = found.pop("runs")
        assert found == {
            "schema": "robustness/simulate/1",
            "graph": {
                "nodes": 5,
                "arcs": 16,
                "directed": False,
                "sha256": rb.Digraph.from_networkx(nx.wheel_graph(5)).sha256,
                "read_as": "undirected, 5 nodes, 8 links",
            },
            "outcome": "agreement",
            "rule": "adp-msr",
            "model": "malicious",
            "f": 1,
            "adversary": "ramp (slope 0.05)",
            "schedule": "every step, no delays",
            "tau": 0,
            "steps": 1000,
        }
        assert only["malicious"] == [0]
        assert only["safe"] is True
        assert [group["nodes"] for group in only["groups"]] == [[1, 2, 3, 4]]

    @pytest.mark.parametrize(
        ("graph", "arguments", "outcome"),
        [
            (WHEEL, (), "agreement"),
            (WHEEL, ("--schedule", "delayed"), "split"),
            (WHEEL, ("--model", "byzantine", "--rule", "w-msr"), "split"),
            (WHEEL, ("--model", "malicious-local", "--schedule", "delayed"), "split"),
            (WHEEL, ("--model", "byzantine-local"), "split"),
            (CYCLE, (), "split"),
            (CYCLE, ("--rule", "dp-msr"), "split"),
            (CYCLE, ("-f", "0"), "agreement"),
            (COMPLETE, ("--schedule", "adversarial", "--runs", "3"), "agreement"),
            (COMPLETE, ("--schedule", "random", "--adversary", "random", "--tau", "6"), "agreement"),
            (COMPLETE, ("--active", "0", "--speed", "5", "-T", "0.5", "--alpha", "3"), "agreement"),
        ],
    )
    def test_outcomes_and_exit_codes(self, graph: bytes, arguments: tuple[str, ...], outcome: str) -> None:
        arguments = (*arguments, "--steps", "300")
        assert document("simulate", "-", *arguments, graph=graph)["outcome"] == outcome
        other = "split" if outcome == "agreement" else "agreement"
        assert run("simulate", "-", *arguments, graph=graph).exit_code == ExitCode.DONE
        assert run("simulate", "-", *arguments, "--expect", outcome, graph=graph).exit_code == ExitCode.DONE
        assert run("simulate", "-", *arguments, "--expect", other, graph=graph).exit_code == ExitCode.REFUTED

    @pytest.mark.parametrize(("nodes", "outcome"), [(0, "agreement"), (1, "agreement"), (2, "split")])
    def test_hardly_anybody(self, nodes: int, outcome: str) -> None:
        """Two vehicles with f = 1 drop each other's value: both stay where they are."""
        graph = encode_topology(nx.complete_graph(nodes))
        assert document("simulate", "-", "--steps", "50", graph=graph)["outcome"] == outcome
        assert document("attack", "-", "--steps", "50", graph=graph)["outcome"] == outcome

    def test_undecided_at_the_horizon(self) -> None:
        done = run("simulate", "-", "--steps", "3", graph=COMPLETE)
        assert done.exit_code == ExitCode.UNDECIDED
        assert done.stdout.startswith("undecided:")
        assert run("simulate", "-", "--steps", "3", "--expect", "split", graph=COMPLETE).exit_code == ExitCode.UNDECIDED

    def test_the_time_limit(self) -> None:
        done = run("simulate", "-", "--steps", "100000000", "--timeout", "0.2", "--adversary", "sine", graph=COMPLETE)
        assert done.exit_code == ExitCode.UNDECIDED
        assert "time limit" in done.stderr

    def test_the_same_seed_gives_the_same_bytes(self) -> None:
        arguments = ("simulate", "-", "--adversary", "random", "--schedule", "random", "--json", "--seed")
        first, same, other = (run(*arguments, seed, graph=WHEEL).stdout for seed in ("4", "4", "5"))
        assert first == same
        assert first != other

    def test_text(self) -> None:
        done = run("simulate", "-", "--schedule", "delayed", graph=WHEEL)
        assert done.stdout.splitlines()[0] == "split: normal nodes stayed apart"
        assert "{0}, seed 0: split, exactly" in done.stdout
        assert done.stdout.count("group ") == 2

    def test_gains_outside_the_theory_are_said(self) -> None:
        done = run("simulate", "-", "--alpha", "0.1", graph=COMPLETE)
        assert "nothing is promised" in done.stderr

    @pytest.mark.parametrize(
        ("arguments", "code"),
        [
            ((), ExitCode.USAGE),
            (("-", "--experiment", "gap"), ExitCode.USAGE),
            (("--experiment", "setting-3"), ExitCode.USAGE),
            (("-", "--rule", "dp-msr", "--schedule", "delayed"), ExitCode.USAGE),
            (("-", "--malicious", "x"), ExitCode.USAGE),
            (("-", "--malicious", "1", "--malicious", "2"), ExitCode.USAGE),
            (("-", "-T", "0"), ExitCode.USAGE),
            (("-", "--schedule", "random", "--tau", "-1"), ExitCode.USAGE),
            (("--replay", "missing.json", "--certificate", "missing.cert"), ExitCode.USAGE),
            (("--replay", "missing.json"), ExitCode.BAD_INPUT),
            (("-", "--attack", "missing.json"), ExitCode.BAD_INPUT),
            (("-", "--certificate", "missing.cert"), ExitCode.BAD_INPUT),
            (("-", "--attack", "a", "--certificate", "b"), ExitCode.USAGE),
            (("-", "--period", "2"), ExitCode.USAGE),
            (("-", "--over-time", "--certificate", "b"), ExitCode.USAGE),
            (("--experiment", "gap", "--over-time"), ExitCode.USAGE),
            (("missing.json",), ExitCode.BAD_INPUT),
        ],
    )
    def test_what_cannot_be_run(self, arguments: tuple[str, ...], code: ExitCode) -> None:
        done = run("simulate", *arguments, graph=WHEEL)
        assert done.exit_code == code, done.output
        assert done.stdout == ""

    def test_nodes_are_named_by_label(self) -> None:
        graph = rb.Digraph([1, "1", "b", (0, 1)], [])
        for text, label in (("1", 1), ('"1"', "1"), ("b", "b"), ("[0, 1]", (0, 1))):
            assert simulate_runs.node_named(graph, text) == label
        assert simulate_runs.node_named(rb.Digraph(["1"], []), "1") == "1"
        for text in ("true", "1.0", "c", "{}", "null", "[" * 100_000):
            with pytest.raises(ValueError, match="named by its label"):
                simulate_runs.node_named(graph, text)

    def test_save_replay_and_plot(self, tmp_path: Path) -> None:
        saved, picture = tmp_path / "run.json", tmp_path / "run.png"
        first = document("simulate", "-", "--save", saved, "--plot", picture, "--adversary", "random", graph=WHEEL)
        first["graph"]["read_as"] = None  # a replay reads no graph file
        assert document("simulate", "--replay", saved) == first
        assert picture.read_bytes().startswith(b"\x89PNG")

    def test_over_time(self, tmp_path: Path) -> None:
        """The complete graph in thirds agrees under delays; the wheel in halves is split by its trap."""
        for whole, parts, outcome in ((nx.complete_graph(6), 3, "agreement"), (nx.wheel_graph(5), 2, "split")):
            edges = sorted(whole.edges)
            steps = [[[*edge] for edge in edges[k::parts]] for k in range(parts)]
            path, options = tmp_path / "steps.json", ("--over-time", "--tau", "3", "--steps", "600")
            document_of = {"nodes": sorted(whole), "period": parts, "steps": steps, "directed": False}
            path.write_text(json.dumps(document_of))
            found = document("simulate", path, *options, "--schedule", "delayed")
            assert found["outcome"] == outcome
            if outcome == "split":
                assert found["runs"][0]["exact"] is True
                attack = tmp_path / "attack.json"
                run("attack", "-", "--model", "delayed", "-o", attack, graph=encode_topology(whole))
                assert document("simulate", path, *options, "--attack", attack)["runs"][0]["exact"] is True

    def test_tuples_as_labels(self) -> None:
        """The groups of an attack are watched by label, whatever the labels are."""
        found = document("simulate", "-", graph=encode_topology(nx.grid_2d_graph(2, 3)))
        assert (found["outcome"], found["runs"][0]["exact"]) == ("split", True)

    def test_a_certificate_is_put_to_the_test(self, tmp_path: Path) -> None:
        from certificates.verification import FORMAT

        graph = rb.Digraph.from_networkx(nx.complete_graph(5))
        claim = {"property": "rs-robust", "r": 3, "s": 1, "verdict": "robust"}
        header = {"format": FORMAT, "graph": graph.sha256, "claim": claim, "evidence": {"kind": "degree"}}
        path = tmp_path / "k5.cert"
        path.write_bytes(json.dumps(header).encode() + b"\n")
        found = document("simulate", "-", "--certificate", path, "-f", "1", "--steps", "200", graph=COMPLETE)
        assert (found["outcome"], found["validation"], found["exhaustive"]) == ("agreement", "confirmed", True)
        assert found["counterexample"] is None
        assert run("simulate", "-", "--certificate", path, graph=CYCLE).exit_code == ExitCode.REFUTED
        path.write_bytes(b"not a certificate")
        assert run("simulate", "-", "--certificate", path, graph=COMPLETE).exit_code == ExitCode.BAD_INPUT

    def test_a_counterexample_is_saved_and_replayed(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        """No true certificate has one, so the battery is given a false claim: a cycle called (2,2)-robust."""
        monkeypatch.setattr("robustness.simulation.validate.claim_of_certificate", lambda *_: Claim(2, 2, None))
        monkeypatch.chdir(tmp_path)
        (tmp_path / "c6.cert").write_text("")
        done = run("simulate", "-", "--certificate", "c6.cert", "-f", "1", graph=CYCLE)
        assert done.exit_code == ExitCode.REFUTED
        assert done.stdout.startswith("counterexample:")
        assert "counterexample.json" in done.stderr
        assert document("simulate", "--replay", "counterexample.json")["outcome"] == "split"
        found = document("simulate", "-", "--certificate", "c6.cert", "--save", "mine.json", graph=CYCLE)
        assert found["counterexample"] == "mine.json"
        assert found["outcome"] == "split"

    def test_nothing_but_the_verdict_off_a_terminal(self, tmp_path: Path) -> None:
        run("certify", "-", "-r", "2", "-s", "2", "-o", tmp_path / "c6.cert", graph=CYCLE)
        done = run("simulate", "-", "--certificate", tmp_path / "c6.cert", graph=CYCLE)
        assert (done.exit_code, done.stderr) == (ExitCode.DONE, "")


class TestExperiments:
    def test_json(self) -> None:
        found = document("simulate", "--experiment", "proposition-1")
        assert found["schema"] == "robustness/simulate/1"
        assert (found["experiment"], found["outcome"], found["as_reported"]) == ("proposition-1", "split", True)
        assert len(found["cases"]) == 6
        assert all(case["exact"] and case["outcome"] == "split" for case in found["cases"])

    @pytest.mark.parametrize(("name", "outcome"), [("necessity", "split"), ("corollary-2", "agreement")])
    def test_exit_codes(self, name: str, outcome: str) -> None:
        assert run("simulate", "--experiment", name, "--expect", outcome).exit_code == ExitCode.DONE
        other = "split" if outcome == "agreement" else "agreement"
        assert run("simulate", "--experiment", name, "--expect", other).exit_code == ExitCode.REFUTED

    def test_pictures(self, tmp_path: Path) -> None:
        done = run("simulate", "--experiment", "corollary-1", "--plot", tmp_path / "figures")
        assert done.exit_code == ExitCode.DONE
        assert [path.suffix for path in (tmp_path / "figures").iterdir()] == [".png"]
        assert done.stdout.startswith("Corollary 1")

    def test_the_time_limit(self) -> None:
        assert run("simulate", "--experiment", "setting-1", "--timeout", "0.05").exit_code == ExitCode.UNDECIDED


class TestAttack:
    def test_json_key_by_key(self) -> None:
        found = document("attack", "-", graph=CYCLE)
        assert set(found) == {"schema", "graph", "f", "model", "outcome", "reason", "attack"}
        assert (found["schema"], found["f"], found["model"]) == ("robustness/attack-result/1", 1, "malicious")
        assert found["outcome"] == "split"
        assert found["attack"]["schema"] == "robustness/attack/1"

    @pytest.mark.parametrize(
        ("graph", "model", "f", "outcome"),
        [
            (CYCLE, "malicious", 1, "split"),
            (WHEEL, "malicious", 1, "agreement"),
            (WHEEL, "delayed", 1, "split"),
            (WHEEL, "byzantine", 1, "split"),
            (WHEEL, "delayed-local", 1, "split"),
            (CYCLE, "malicious-local", 1, "split"),
            (COMPLETE, "delayed-local", 1, "agreement"),
            (COMPLETE, "delayed", 1, "agreement"),
            (COMPLETE, "malicious", 3, "split"),
        ],
    )
    def test_outcomes_and_exit_codes(self, graph: bytes, model: str, f: int, outcome: str) -> None:
        arguments = ("attack", "-", "--model", model, "-f", str(f), "--steps", "50")
        assert document(*arguments, graph=graph)["outcome"] == outcome
        found = ExitCode.DONE if outcome == "split" else ExitCode.REFUTED
        assert run(*arguments, graph=graph).exit_code == found
        for expected in ("split", "agreement"):
            code = ExitCode.DONE if expected == outcome else ExitCode.REFUTED
            assert run(*arguments, "--expect", expected, graph=graph).exit_code == code

    @pytest.mark.parametrize("model", ATTACK_MODELS)
    def test_hardly_any_time(self, model: str) -> None:
        """An answer or none, but no error."""
        done = run("attack", "-", "--model", model, "--timeout", "1e-9", graph=WHEEL)
        assert done.exit_code in (ExitCode.DONE, ExitCode.REFUTED, ExitCode.UNDECIDED), done.output

    def test_agreement_is_promised_only_for_gains_of_the_theory(self) -> None:
        """K_4 with f = 1, which the source paper leaves open; exit 10 names the gains, and 30 when they are others."""
        graph = encode_topology(nx.complete_graph(4))
        for model in ATTACK_MODELS:
            done = run("attack", "-", "--model", model, graph=graph)
            assert done.exit_code == ExitCode.REFUTED
            assert "alpha T <= 2 - s/2" in done.stdout
            assert run("attack", "-", "--model", model, "--alpha", "1.5", graph=graph).exit_code == ExitCode.REFUTED
            done = run("attack", "-", "--model", model, "--alpha", "0.3", "-T", "0.01", graph=graph)
            assert done.exit_code == ExitCode.UNDECIDED
            assert "nothing is promised" in done.stdout

    @pytest.mark.parametrize(("graph", "model"), [(CYCLE, "malicious"), (WHEEL, "delayed"), (WHEEL, "byzantine")])
    def test_the_file_is_played_by_simulate(self, tmp_path: Path, graph: bytes, model: str) -> None:
        path = tmp_path / "attack.json"
        assert run("attack", "-", "--model", model, "-o", path, graph=graph).exit_code == ExitCode.DONE
        done = document("simulate", "-", "--attack", path, graph=graph)
        assert done["outcome"] == "split"
        assert done["runs"][0]["exact"] is True
        refuted = run("simulate", "-", "--attack", path, "--expect", "agreement", graph=graph)
        assert refuted.exit_code == ExitCode.REFUTED

    def test_the_file_is_bound_to_its_graph(self, tmp_path: Path) -> None:
        path = tmp_path / "attack.json"
        run("attack", "-", "-o", path, graph=CYCLE)
        done = run("simulate", "-", "--attack", path, graph=WHEEL)
        assert done.exit_code == ExitCode.BAD_INPUT
        assert "another graph" in done.stderr
        path.write_text("{}")
        assert run("simulate", "-", "--attack", path, graph=CYCLE).exit_code == ExitCode.BAD_INPUT

    def test_no_file_without_an_attack(self, tmp_path: Path) -> None:
        run("attack", "-", "-o", tmp_path / "attack.json", graph=COMPLETE)
        assert not (tmp_path / "attack.json").exists()

    def test_a_file_that_cannot_be_written(self, tmp_path: Path) -> None:
        assert run("attack", "-", "-o", tmp_path / "no" / "attack.json", graph=CYCLE).exit_code == ExitCode.USAGE


def test_one_limit_for_the_adversary_and_the_run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What the choice of the adversary used of the limit is not given to the run again."""
    from robustness.simulation import run as running

    given: list[float] = []
    simulate = running.simulate

    def noted(*arguments: Any, time_limit: float, **options: Any) -> Any:
        given.append(time_limit)
        return simulate(*arguments, time_limit=60.0, **options)

    now = [100.0]
    monkeypatch.setattr("robustness.limits.time.monotonic", lambda: now[0])
    monkeypatch.setattr(running, "simulate", noted)
    found = finding.find_attack_within

    def slow(*arguments: Any) -> Any:
        now[0] += 30.0
        return found(*arguments)

    monkeypatch.setattr(finding, "find_attack_within", slow)
    path = tmp_path / "complete.json"
    rb.write_topology(nx.complete_graph(5), path)
    outcome = CliRunner().invoke(robustness, ["simulate", str(path), "--steps", "20", "--timeout", "40"])
    assert outcome.exit_code in (0, 30)
    assert given == [pytest.approx(10.0, abs=1.0)]


@pytest.mark.parametrize("adversary", sorted(ADVERSARIES))
def test_rule_and_schedule_are_told_in_words(adversary: str) -> None:
    done = run("simulate", "-", "--steps", "5", "--adversary", adversary, graph=COMPLETE)
    rule, schedule = (line for line in done.stdout.splitlines() if line.startswith(("rule", "schedule")))
    assert schedule == "schedule   every step, no delays"
    assert re.fullmatch(r"rule       adp-msr, f = 1, malicious, adversary [a-z -]+( \([a-z]+ .*\))?", rule), rule
    assert "=" not in rule.partition("malicious")[2]
