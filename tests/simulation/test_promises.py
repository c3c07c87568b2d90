"""What is certified agrees: the whole battery against every small graph that the theory calls safe."""

from __future__ import annotations

import json
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

import networkx as nx
import pytest

import robustness as rb
from robustness.constructions.small_graphs import each_graph
from robustness.errors import InvalidParameter
from robustness.results import RobustnessResult, Verdict, Witness
from robustness.simulation import ADVERSARIES, Scenario, Topology, random_start, schedule_named, simulate
from robustness.simulation.claim import claim_of_certificate, claim_of_result
from robustness.simulation.replay import read_run
from robustness.simulation.validate import malicious_sets, promised_regimes, validate_certificate

SYNCHRONOUS = [("w-msr", "synchronous", 0), ("dp-msr", "synchronous", 0)]
DELAYED = [("adp-msr", name, tau) for name, tau in (("periodic", 3), ("random", 4), ("adversarial", 4), ("delayed", 2))]


def robust_graphs(r: int, s: int, largest: int) -> list[rb.Digraph]:
    graphs = [graph for graph in each_graph(largest, directed=False) if graph.n >= 2]
    return [graph for graph in graphs if s <= graph.n and rb.is_rs_robust(graph, r, s)]


def assert_all_agree(graph: rb.Digraph, f: int, cases: list[tuple[str, str, int]], steps: int) -> None:
    """Every malicious set of at most f nodes, two random starts, every adversary."""
    sets, exhaustive = malicious_sets(graph, f, 1000, seed=0)
    assert exhaustive
    starts = [random_start(graph, chosen, 10 * place + again) for place, chosen in enumerate(sets) for again in (0, 1)]
    for rule, schedule, tau in cases:
        for name, make in ADVERSARIES.items():
            scenario = Scenario(Topology((graph,)), f, rule, adversary=make(), steps=steps,
                                schedule=schedule_named(schedule, tau))  # fmt: skip
            for start, outcome in zip(starts, simulate(scenario, starts), strict=True):
                where = (list(graph.arcs()), rule, schedule, name, start.malicious, outcome.spread)
                assert outcome.verdict.value == "agreement", where
                assert outcome.safe is True, where


class TestEverySmallGraph:
    def test_two_two_robust_agrees_synchronously(self) -> None:
        """n <= 5, f = 1: under W-MSR and DP-MSR, against the whole battery (Theorem of LeBlanc et al. 2013)."""
        graphs = robust_graphs(2, 2, 5)
        assert len(graphs) == 9
        for graph in graphs:
            assert_all_agree(graph, 1, SYNCHRONOUS, 200)

    def test_three_robust_agrees_under_delays(self) -> None:
        """n <= 5, f = 1: under ADP-MSR with every schedule (Theorem 1 of the source paper)."""
        graphs = robust_graphs(3, 1, 5)
        assert [graph.arc_count for graph in graphs] == [18, 20]
        for graph in graphs:
            assert_all_agree(graph, 1, DELAYED, 160)

    @pytest.mark.slow
    def test_three_robust_agrees_under_delays_on_six_nodes(self) -> None:
        for graph in robust_graphs(3, 1, 6):
            assert_all_agree(graph, 1, DELAYED, 800)

    @pytest.mark.slow
    def test_two_two_robust_digraphs_agree_synchronously(self) -> None:
        graphs = [graph for graph in each_graph(4, directed=True) if graph.n >= 2 and rb.is_rs_robust(graph, 2, 2)]
        assert len(graphs) > 5
        for graph in graphs:
            assert_all_agree(graph, 1, SYNCHRONOUS, 400)


class TestRegimes:
    def test_what_is_promised(self) -> None:
        def strength(r: int, s: int, f: int | None = None) -> dict[tuple[str, str, str], int]:
            return {(p.rule, p.model, p.schedule): p.f for p in promised_regimes(r, s, f)}

        both = {("w-msr", "malicious", "synchronous"), ("dp-msr", "malicious", "synchronous")}
        assert {key for key, f in strength(2, 2).items() if f == 1} == both
        assert strength(3, 1)["w-msr", "malicious", "synchronous"] == 1  # (3,1) implies (2,2)
        assert strength(3, 1)["adp-msr", "malicious", "delayed"] == 1
        assert strength(5, 9)["w-msr", "malicious", "synchronous"] == 4
        assert strength(5, 9)["adp-msr", "malicious", "random"] == 2
        assert set(strength(5, 9, 3)) == both
        assert strength(0, 1) == {}
        assert strength(1, 1)["w-msr", "malicious", "synchronous"] == 0

    @pytest.mark.parametrize("n", [5, 6, 7])
    def test_every_promise_is_a_theorem_on_complete_graphs(self, n: int) -> None:
        """The conditions named are met: (f+1,f+1) for the synchronous ones, 2f + 1 for the others."""
        for r, s in rb.robustness_profile(nx.complete_graph(n)).items():
            for regime in promised_regimes(r, s):
                if regime.theorem == "(f+1,f+1)-robust":
                    assert rb.is_rs_robust(nx.complete_graph(n), regime.f + 1, regime.f + 1)
                else:
                    assert r >= 2 * regime.f + 1


class TestMaliciousSets:
    GRAPH = rb.Digraph.from_networkx(nx.cycle_graph(7))

    def test_all_where_few(self) -> None:
        sets, exhaustive = malicious_sets(self.GRAPH, 2, 100, 0)
        assert exhaustive
        assert len(set(sets)) == len(sets) == 1 + 7 + 21

    def test_a_sample_where_many(self) -> None:
        sets, exhaustive = malicious_sets(self.GRAPH, 3, 20, 5)
        assert not exhaustive
        assert len(set(sets)) == len(sets) == 20
        assert {len(chosen) for chosen in sets} == {0, 3}
        assert sets == malicious_sets(self.GRAPH, 3, 20, 5)[0]
        assert sets != malicious_sets(self.GRAPH, 3, 20, 6)[0]

    def test_somebody_is_left(self) -> None:
        sets, _ = malicious_sets(rb.Digraph(range(2), []), 9, 100, 0)
        assert max(map(len, sets)) == 1


def claimed(r: int, s: int, verdict: Verdict = Verdict.ROBUST, witness: Witness | None = None) -> RobustnessResult:
    return RobustnessResult(verdict, r, s, witness)


class TestValidation:
    def test_a_true_certificate_is_confirmed(self) -> None:
        seen: list[tuple[int, int]] = []
        graph = nx.complete_graph(5)
        result = rb.check_rs_robustness(graph, 3, 1)
        report = validate_certificate(graph, result, steps=120, starts_per_set=1, progress=lambda *at: seen.append(at))
        assert (report.verdict, report.outcome, report.exhaustive) == ("confirmed", "agreement", True)
        assert seen[-1] == (63, 63)
        assert report.runs == 63 * 6

    @pytest.mark.parametrize(("graph", "s"), [(nx.path_graph(3), 1), (nx.wheel_graph(5), 5)])
    def test_it_is_played_only_where_the_theorems_apply(self, graph: nx.Graph, s: int) -> None:
        """With f = 0 the weights add up to 1: a warning that nothing is promised would be an error here."""
        r = 1 if s == 1 else 2
        report = validate_certificate(graph, rb.check_rs_robustness(graph, r, s), steps=300, starts_per_set=1)
        assert report.verdict == "confirmed"

    def test_a_sample_is_called_one(self) -> None:
        graph = nx.complete_graph(5)
        whole, some = (
            validate_certificate(graph, claimed(2, 2), f=1, steps=200, starts_per_set=1, most_sets=most)
            for most in (6, 3)
        )
        assert (whole.exhaustive, "every set of malicious nodes" in whole.reason) == (True, True)
        assert (some.exhaustive, "a sample of the sets" in some.reason) == (False, True)

    def test_a_false_one_meets_a_counterexample_that_can_be_replayed(self, tmp_path: Path) -> None:
        """A cycle called (2,2)-robust."""
        path = tmp_path / "new" / "run.json"
        report = validate_certificate(nx.cycle_graph(6), claimed(2, 2), f=1, save_to=path)
        assert report.verdict == "counterexample"
        assert report.counterexample is not None
        assert report.outcome == "split"
        assert report.counterexample.saved_as == path
        scenario, start = read_run(path)
        assert simulate(scenario, [start]) == (report.counterexample.outcome,)

    def test_a_place_that_cannot_be_written_takes_nothing_from_the_verdict(self, tmp_path: Path) -> None:
        (tmp_path / "file").write_text("")
        report = validate_certificate(nx.cycle_graph(6), claimed(2, 2), f=1, save_to=tmp_path / "file" / "run.json")
        assert report.verdict == "counterexample"
        assert report.counterexample is not None
        assert report.counterexample.saved_as is None
        assert "cannot be written" in report.reason

    def test_the_report_does_not_depend_on_the_workers(self) -> None:
        graph = nx.wheel_graph(5)
        fields: dict[str, Any] = {"f": 1, "steps": 80, "starts_per_set": 1}
        alone, together = (validate_certificate(graph, claimed(2, 2), jobs=jobs, **fields) for jobs in (1, 2))
        assert alone == together
        assert alone.verdict == "confirmed"

    def test_a_lost_worker_is_undecided(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def lose(*_: object) -> object:
            raise BrokenProcessPool("killed")

        monkeypatch.setattr("robustness.simulation.validate._play_batch", lose)
        report = validate_certificate(nx.complete_graph(5), claimed(3, 1))
        assert (report.verdict, report.outcome, report.runs) == ("undecided", "undecided", 0)

    def test_the_time_limit_is_undecided(self) -> None:
        report = validate_certificate(nx.complete_graph(5), claimed(3, 1), steps=50, time_limit=1e-9)
        assert report.verdict == "undecided"
        assert "after 1 of 63 batches" in report.reason

    def test_a_run_that_does_not_settle_is_undecided(self) -> None:
        report = validate_certificate(nx.complete_graph(5), claimed(2, 2), f=1, steps=1, starts_per_set=1)
        assert report.verdict == "undecided"
        assert "undecided at the horizon" in report.reason

    def test_a_violation_is_carried_out(self) -> None:
        graph = nx.cycle_graph(6)
        report = validate_certificate(graph, rb.check_rs_robustness(graph, 2, 2))
        assert (report.verdict, report.outcome, report.runs) == ("confirmed", "split", 3)

    @pytest.mark.parametrize(
        ("certificate", "f", "rule"),
        [
            (claimed(2, 2, Verdict.UNDECIDED), None, "undecided"),
            (claimed(2, 2, Verdict.NOT_ROBUST), None, "no pair"),
            (claimed(2, 2), 2, "promises nothing"),
            (claimed(0, 1), None, "promises nothing"),
            (claimed(2, 2, Verdict.NOT_ROBUST, Witness(frozenset({0}), frozenset({1}))), 0, "none for f = 0"),
        ],
    )
    def test_what_promises_nothing_is_refused(self, certificate: RobustnessResult, f: int | None, rule: str) -> None:
        with pytest.raises(InvalidParameter, match=rule):
            validate_certificate(nx.cycle_graph(6), certificate, f=f)

    def test_bytes_go_through_the_kernel(self) -> None:
        graph = rb.Digraph.from_networkx(nx.cycle_graph(6))
        result = rb.check_rs_robustness(graph, 2, 2)
        assert result.witness is not None
        evidence = {"kind": "violation"} | {
            name: sorted(graph.ids(side)) for name, side in zip(("S1", "S2"), result.witness, strict=True)
        }
        claim = {"property": "rs-robust", "r": 2, "s": 2, "verdict": "not-robust"}
        from certificates.errors import CertificateError
        from certificates.verification import FORMAT

        header = {"format": FORMAT, "graph": graph.sha256, "claim": claim, "evidence": evidence}
        certificate = json.dumps(header).encode() + b"\n"
        assert claim_of_certificate(graph, certificate) == claim_of_result(result)
        assert validate_certificate(graph, certificate).verdict == "confirmed"
        with pytest.raises(CertificateError):
            validate_certificate(nx.cycle_graph(7), certificate)

    def test_a_robust_certificate_in_bytes(self) -> None:
        graph = rb.Digraph.from_networkx(nx.complete_graph(5))
        from certificates.verification import FORMAT

        claim = {"property": "rs-robust", "r": 3, "s": 1, "verdict": "robust"}
        header = {"format": FORMAT, "graph": graph.sha256, "claim": claim, "evidence": {"kind": "degree"}}
        assert claim_of_certificate(graph, json.dumps(header).encode() + b"\n") == (3, 1, None)
