"""``robustness tolerance``: the paragraph, the table, the evidence, the JSON, the gate and the files."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from certificates import verify, verify_tolerance
from cli.choices import THREAT_MODEL_NAMES as MODELS
from cli.exit_codes import ExitCode
from cli.interruption import Overrun
from cli.main import robustness
from robustness.files import encode_topology
from robustness.threat_models import THREAT_MODELS, ThreatModel, front
from robustness.threat_models.results import ToleranceResult

WHEEL = encode_topology(nx.wheel_graph(5))
BETWEEN = encode_topology(nx.complete_graph(8))
ROOT = Path(__file__).parents[2]


def tolerance(*arguments: str, graph: bytes = WHEEL) -> Result:
    return CliRunner().invoke(robustness, ["tolerance", "-", *arguments], input=graph)


def document(*arguments: str, graph: bytes = WHEEL) -> dict[str, object]:
    outcome = tolerance("--json", *arguments, graph=graph)
    assert outcome.stdout.count("\n") == 1
    found: dict[str, object] = json.loads(outcome.stdout)
    return found


def test_models_are_those_of_the_library() -> None:
    assert tuple(THREAT_MODELS) == MODELS
    for name in MODELS:
        assert name in CliRunner().invoke(robustness, ["tolerance", "--help"]).stdout


class TestText:
    def test_the_table_then_a_sentence_for_each_outcome_then_what_it_was_asked_about(self) -> None:
        outcome = tolerance()
        assert outcome.exit_code == ExitCode.DONE
        table, sentences, facts = outcome.stdout.split("\n\n")
        assert sentences.startswith("In step, without delays")
        assert "theorem  " not in outcome.stdout
        assert [line.split()[0] for line in facts.splitlines()] == ["graph", "evidence", "time"]
        rows = [line.split() for line in table.splitlines()]
        assert rows[0] == ["model", "guaranteed", "refuted", "between"]
        assert rows[1:] == [
            ["malicious", "1", "2", "-"],
            ["malicious-local", "1", "2", "-"],
            ["byzantine", "0", "1", "-"],
            ["byzantine-local", "0", "1", "-"],
            ["delayed", "0", "1", "-"],
            ["delayed-local", "0", "1", "-"],
        ]
        assert rows == [line.split() for line in tolerance("-v").stdout.split("\n\n")[0].splitlines()]

    def test_theorems_and_evidence_on_request(self) -> None:
        _, _, *evidence, facts = tolerance("-v").stdout.split("\n\n")
        assert facts.startswith("graph")
        assert len(evidence) == 6
        assert "S1        {" in evidence[4]
        assert "simulated an exact split" in evidence[4]
        assert "theorem   docs/theorems.md, Theorem A" in evidence[4]

    def test_one_model(self) -> None:
        outcome = tolerance("--model", "delayed")
        assert "byzantine" not in outcome.stdout
        assert outcome.stdout.split("\n\n")[1].startswith("With delays")

    def test_one_line_on_request(self) -> None:
        told = (
            "guaranteed f: malicious 1, malicious-local 1, byzantine 0, byzantine-local 0, delayed 0, delayed-local 0"
        )
        assert tolerance("-q").stdout == f"{told}\n"
        assert tolerance("-q", "--require", "9").stdout.count("\n") == 1

    def test_lines_fit_the_terminal(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("cli.output.terminal_width", lambda _stream=None: 60)
        sentences = tolerance().stdout.split("\n\n")[1]
        assert max(map(len, sentences.splitlines())) <= 60

    @pytest.mark.parametrize("columns", ["40", "100"])
    def test_a_program_gets_each_line_in_one_piece(self, columns: str, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setenv("COLUMNS", columns)
        told = tolerance("-v").stdout
        monkeypatch.delenv("COLUMNS")
        assert re.sub(r"time .*", "", told) == re.sub(r"time .*", "", tolerance("-v").stdout)
        assert all(line.endswith(".") for line in told.split("\n\n")[1].splitlines())

    @pytest.mark.parametrize("n", [0, 1])
    def test_nobody_to_disagree(self, n: int) -> None:
        outcome = tolerance(graph=encode_topology(nx.empty_graph(n)))
        assert outcome.exit_code == ExitCode.DONE
        assert "Fewer than two nodes cannot disagree" in outcome.stdout

    def test_not_even_agreement_without_liars(self) -> None:
        outcome = tolerance("--model", "delayed", graph=encode_topology(nx.empty_graph(3)))
        assert "agreement fails even though nobody lies" in " ".join(outcome.stdout.split())
        assert "delayed                none        0  -" in outcome.stdout


class TestJson:
    def test_key_by_key(self) -> None:
        found = document("--model", "delayed", "--require", "1")
        assert list(found) == ["schema", "graph", "summary", "models", "require", "seconds"]
        assert found["schema"] == "robustness/tolerance/1"
        assert found["require"] == {"f": 1, "verdict": "refuted", "models": ["delayed"]}
        (model,) = found["models"]
        assert list(model) == [
            "model", "setting", "guaranteed", "refuted", "undecided", "is_decided", "summary", "reasons",
            "attack", "parameters", "confirmed",
        ]  # fmt: skip
        assert (model["model"], model["guaranteed"], model["refuted"]) == ("delayed", 0, 1)
        assert (model["undecided"], model["is_decided"], model["confirmed"]) == ([], True, True)
        assert [reason["standing"] for reason in model["reasons"]] == ["guaranteed", "refuted"]
        assert all(list(reason) == ["standing", "f", "statement", "theorem", "evidence"] for reason in model["reasons"])
        assert model["attack"]["kind"] == "trap"
        assert model["attack"]["malicious"] == [0]

    def test_all_models_and_no_gate(self) -> None:
        found = document()
        assert [model["model"] for model in found["models"]] == list(MODELS)
        assert found["require"] is None


def test_a_single_node_survives_any_number() -> None:
    one = encode_topology(nx.path_graph(1))
    assert tolerance("-q", graph=one).stdout.startswith("guaranteed f: malicious any, ")
    assert re.search(r"^delayed +any +none  -$", tolerance(graph=one).stdout, re.MULTILINE)


class TestGate:
    @pytest.mark.parametrize(
        ("model", "f", "code", "word"),
        [
            ("delayed", 1, ExitCode.DONE, "guaranteed:"),
            ("delayed", 2, ExitCode.DONE, "guaranteed:"),
            ("delayed", 3, ExitCode.REFUTED, "refuted:"),
            ("delayed", 99, ExitCode.REFUTED, "refuted:"),
            ("byzantine", 2, ExitCode.DONE, "guaranteed:"),
            ("malicious", 3, ExitCode.DONE, "guaranteed:"),
            ("malicious", 4, ExitCode.REFUTED, "refuted:"),
            ("malicious-local", 2, ExitCode.DONE, "guaranteed:"),
        ],
    )
    def test_exit_codes(self, model: str, f: int, code: ExitCode, word: str) -> None:
        outcome = tolerance("--model", model, "--require", str(f), graph=BETWEEN)
        assert outcome.exit_code == code
        assert outcome.stdout.startswith(word)

    @pytest.mark.parametrize(("f", "code"), [(1, ExitCode.DONE), (2, ExitCode.DONE), (3, ExitCode.REFUTED)])
    def test_without_a_model_the_worst_counts(self, f: int, code: ExitCode) -> None:
        assert tolerance("--require", str(f), graph=BETWEEN).exit_code == code

    def test_the_gate_names_the_models_that_it_is_about(self) -> None:
        results = rb.tolerance(nx.wheel_graph(5)).results
        refuted = [each.model for each in results if each.standing(1).value == "refuted"]
        assert 0 < len(refuted) < len(results)
        wheel = encode_topology(nx.wheel_graph(5))
        assert tolerance("-q", "--require", "1", graph=wheel).stdout.startswith(
            f"refuted: f = 1 under {', '.join(refuted)}: an attack splits the network"
        )
        assert document("--require", "1", graph=wheel)["require"]["models"] == refuted

    def test_where_nobody_lies_no_attack_is_blamed(self) -> None:
        apart = encode_topology(nx.empty_graph(4))
        assert tolerance("-q", "--require", "0", graph=apart).stdout == (
            "refuted: f = 0 under every threat model: the network splits though nobody lies\n"
        )

    def test_a_limit_is_undecided(self) -> None:
        graph = encode_topology(nx.random_regular_graph(10, 60, seed=1))
        found = document("--model", "delayed", "--require", "3", "--timeout", "0.2", graph=graph)
        assert found["require"] == {"f": 3, "verdict": "undecided", "models": ["delayed"]}
        assert tolerance("--model", "delayed", "--timeout", "0.2", graph=graph).exit_code == ExitCode.UNDECIDED

    def test_what_theory_leaves_open_is_told_from_what_a_limit_left(self, tmp_path: Path) -> None:
        steps = [[[u, v] for u in range(6) for v in range(6) if u != v and (u + v) % 2 == k] for k in (0, 1)]
        (tmp_path / "links.json").write_text(json.dumps({"nodes": list(range(6)), "period": None, "steps": steps}))
        asked = ["tolerance", str(tmp_path / "links.json"), "--tau", "1", "--delay", "1", "--model", "delayed"]
        outcome = CliRunner().invoke(robustness, [*asked, "--require", "1"])
        assert outcome.exit_code == ExitCode.UNDECIDED
        assert outcome.stdout.startswith("open: f = 1 under delayed: theory does not decide it")
        assert "0 open, 1 open" in outcome.stdout
        found = json.loads(CliRunner().invoke(robustness, [*asked, "--require", "1", "--json"]).stdout)
        assert found["require"] == {"f": 1, "verdict": "open", "models": ["delayed"]}

    @pytest.mark.parametrize("stop", [Overrun, KeyboardInterrupt])
    def test_work_that_is_stopped_keeps_what_lemmas_prove(
        self, stop: type[BaseException], monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """Before any model was finished, and for a model that lemmas do not decide, bounds are told."""

        def stopped(*_: object) -> None:
            raise stop

        monkeypatch.setattr("cli.tolerance._examine", stopped)
        graph = encode_topology(nx.gnp_random_graph(60, 0.5, seed=1))
        outcome = tolerance("--require", "4", "--timeout", "9", "--json", graph=graph)
        assert outcome.exit_code == (ExitCode.UNDECIDED if stop is Overrun else ExitCode.INTERRUPTED)
        models = {model["model"]: model for model in json.loads(outcome.stdout)["models"]}
        assert set(models) == set(MODELS)
        assert all(model["guaranteed"] >= 0 and model["refuted"] is not None for model in models.values())
        assert models["malicious"]["guaranteed"] > 2

    def test_work_that_is_stopped_over_time_claims_nothing(
        self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
    ) -> None:
        def overruns(*_: object) -> None:
            raise Overrun

        monkeypatch.setattr("cli.tolerance._examine", overruns)
        (tmp_path / "links.json").write_text(json.dumps({"nodes": [0, 1], "period": None, "steps": [[[0, 1]]]}))
        asked = ["tolerance", str(tmp_path / "links.json"), "--tau", "1", "--require", "0"]
        outcome = CliRunner().invoke(robustness, asked)
        assert outcome.exit_code == ExitCode.UNDECIDED
        assert outcome.stdout.startswith("undecided: f = 0 under")
        assert "nothing is guaranteed within the limit" in outcome.stdout

    def test_an_attack_that_does_not_split_is_a_bug_not_a_verdict(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robustness.threat_models.confirmation.confirm", lambda _: False)
        outcome = tolerance("--model", "delayed", "--require", "1")
        assert outcome.exit_code == ExitCode.INTERNAL_ERROR
        assert "please report" in outcome.stderr
        assert outcome.stdout == ""


class TestFiles:
    def test_certificates_and_attacks(self, tmp_path: Path) -> None:
        outcome = tolerance("-o", str(tmp_path / "evidence"), graph=BETWEEN)
        assert outcome.exit_code == ExitCode.DONE
        folder = tmp_path / "evidence"
        graph = (folder / "graph.json").read_bytes()
        found = document(graph=BETWEEN)
        for model in found["models"]:
            name = model["model"]
            for what in ("guaranteed", "refuted"):
                path = folder / f"{name}-{what}-{model[what]}.cert"
                data = path.read_bytes()
                if b"tolerance-certificate" in data:
                    claim = verify_tolerance(graph, data)
                    assert (claim.f, claim.verdict) == (model[what], "together" if what == "guaranteed" else "apart")
                    assert claim.bound == ("local" if "local" in name else "total")
                    assert claim.faces == (1 if "malicious" in name else 2)
                else:
                    ordinary = verify(graph, data)
                    r = model[what] + 1
                    assert (name, ordinary.r, ordinary.s) == ("malicious", r, r)
                    assert ordinary.verdict == ("robust" if what == "guaranteed" else "not-robust")
            arguments = ["simulate", "-", "--attack", str(folder / f"{name}-attack.json"), "--steps", "20"]
            replay = CliRunner().invoke(robustness, arguments, input=BETWEEN)
            assert replay.exit_code == ExitCode.DONE, replay.output
            assert "exactly" in replay.stdout

    def test_a_local_violation_with_many_liars_is_replayed(self, tmp_path: Path) -> None:
        masks = (118, 57, 123, 54, 72, 26, 63)
        graph = encode_topology(nx.DiGraph([(j, i) for i in range(7) for j in range(7) if masks[i] >> j & 1]))
        assert tolerance("--model", "malicious-local", "-o", str(tmp_path), graph=graph).exit_code == ExitCode.DONE
        attack = json.loads((tmp_path / "malicious-local-attack.json").read_bytes())
        assert (attack["f"], attack["kind"], attack["malicious"]) == (1, "violation", [0, 2, 6])
        arguments = ["simulate", "-", "--attack", str(tmp_path / "malicious-local-attack.json"), "--steps", "20"]
        replay = CliRunner().invoke(robustness, arguments, input=graph)
        assert replay.exit_code == ExitCode.DONE, replay.output
        assert "exactly" in replay.stdout

    def test_where_nobody_can_disagree_no_limit_is_blamed(self, tmp_path: Path) -> None:
        outcome = tolerance("--model", "delayed", "-o", str(tmp_path), graph=encode_topology(nx.empty_graph(1)))
        assert "no certificate of delayed, f = 0 guaranteed: nobody can disagree" in outcome.stderr

    @pytest.mark.parametrize("model", ["byzantine", "delayed-local", "malicious-local"])
    def test_beyond_twice_robust_a_transcript_certifies(self, model: str, tmp_path: Path) -> None:
        assert tolerance("--model", model, "-o", str(tmp_path), graph=BETWEEN).exit_code == ExitCode.DONE
        (certificate,) = tmp_path.glob(f"{model}-guaranteed-*.cert")
        claim = verify_tolerance((tmp_path / "graph.json").read_bytes(), certificate.read_bytes())
        assert (claim.evidence, claim.certificates, claim.f) == ("refutation", 0, int(certificate.stem[-1]))
        asked = ["--expect", "together", "-f", str(claim.f), "--model", model]
        outcome = CliRunner().invoke(robustness, ["verify", str(tmp_path / "graph.json"), str(certificate), *asked])
        assert outcome.exit_code == ExitCode.DONE, outcome.output

    def test_what_was_not_certified_is_said(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("robustness.threat_models.certification._MOST_NODES", 1)
        outcome = tolerance("--model", "byzantine", "-o", str(tmp_path), graph=BETWEEN)
        assert "no certificate of byzantine, f = 2 guaranteed" in outcome.stderr
        assert not (tmp_path / "byzantine-guaranteed-2.cert").exists()


class TestMisuse:
    @pytest.mark.parametrize("arguments", [["--model", "friendly"], ["--require", "-1"], ["--require", "x"]])
    def test_usage(self, arguments: list[str]) -> None:
        assert tolerance(*arguments).exit_code == ExitCode.USAGE

    def test_bad_input(self) -> None:
        assert tolerance(graph=b"{}").exit_code == ExitCode.BAD_INPUT


def test_ctrl_c(tmp_path: Path) -> None:
    path = tmp_path / "graph.json"
    path.write_bytes(encode_topology(nx.random_regular_graph(10, 60, seed=1)))
    process = subprocess.Popen(
        [sys.executable, "-m", "cli", "tolerance", str(path), "--model", "byzantine"],
        cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ),
    )  # fmt: skip
    time.sleep(2.5)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=10)
    assert process.returncode == ExitCode.INTERRUPTED
    # An interrupt before the work began, on a busy machine, finds nothing to tell.
    assert ("byzantine                 0" in out and "nothing else is claimed" in err) or "nothing is claimed" in err


def test_summary_is_the_library_s(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ToleranceResult, "summary", lambda _: "as the library says")
    assert document("--model", "delayed")["models"][0]["summary"] == "as the library says"


@pytest.mark.parametrize("stop", [KeyboardInterrupt, Overrun])
def test_what_was_decided_before_a_stop_is_kept(stop: type[BaseException], monkeypatch: pytest.MonkeyPatch) -> None:
    judged: list[str] = []
    stops = [stop]
    judge = front.judge

    def stubborn(decisions: object, threat: ThreatModel) -> ToleranceResult:
        if len(judged) == 2 and stops:
            raise stops.pop()
        judged.append(threat.name)
        return judge(decisions, threat)  # type: ignore[arg-type]

    monkeypatch.setattr(front, "judge", stubborn)
    graph = encode_topology(nx.wheel_graph(5))
    outcome = CliRunner().invoke(robustness, ["tolerance", "-", "--json"], input=graph)
    found = {model["model"]: model for model in json.loads(outcome.stdout)["models"]}
    assert outcome.exit_code == (130 if stop is KeyboardInterrupt else 30)
    assert [found[name]["guaranteed"] for name in judged[:2]] == [1, 1]
    assert len(found) == 6
    assert sorted(judged) == sorted(found), "each model is judged once: finished before, or by lemmas after the stop"


def test_what_holds_only_over_time_is_said_to_have_no_certificate(tmp_path: Path) -> None:
    sequence = str(Path(__file__).parents[2] / "examples" / "round-robin.json")
    outcome = CliRunner().invoke(
        robustness, ["tolerance", sequence, "--model", "delayed", "--tau", "12", "-o", str(tmp_path)]
    )
    for claim in ("f = 0 guaranteed", "f = 1 refuted"):
        assert f"no certificate of delayed, {claim}: it holds only over time" in outcome.stderr


def test_a_command_about_one_network_names_those_about_many_steps() -> None:
    sequence = str(Path(__file__).parents[2] / "examples" / "round-robin.json")
    outcome = CliRunner().invoke(robustness, ["attack", sequence])
    assert (outcome.exit_code, "joint, tolerance --tau and simulate --over-time read it" in outcome.stderr) == (3, True)
