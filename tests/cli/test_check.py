"""``robustness check``: what it prints, key by key, and how it talks."""

from __future__ import annotations

import json
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli.main import robustness
from robustness.decision.algorithms import exhaustive
from robustness.definitions import is_violation
from robustness.files import encode_topology, read_topology, write_topology
from robustness.limits import Limits

DATA = Path(__file__).parents[1] / "data"
WHEEL = encode_topology(nx.wheel_graph(5))


def check(*arguments: str, graph: bytes = WHEEL) -> Result:
    return CliRunner().invoke(robustness, ["check", "-", *arguments], input=graph)


def document(*arguments: str, graph: bytes = WHEEL) -> dict[str, object]:
    outcome = check("--json", *arguments, graph=graph)
    assert outcome.stdout.count("\n") == 1
    return json.loads(outcome.stdout)


class TestJson:
    def test_determined_key_by_key(self) -> None:
        found = document()
        seconds, witness, bounds = found.pop("seconds"), found.pop("witness"), found.pop("bounds")
        assert found.pop("algorithm") in rb.ALGORITHMS
        assert found == {
            "schema": "robustness/check/1",
            "graph": {
                "nodes": 5,
                "arcs": 16,
                "directed": False,
                "sha256": rb.Digraph.from_networkx(nx.wheel_graph(5)).sha256,
                "read_as": "undirected, 5 nodes, 8 links",
            },
            "verdict": "determined",
            "r": 2,
            "s": 5,
            "profile": {"1": 5, "2": 5, "3": 0},
        }
        assert 0 <= seconds < 60
        assert sorted(witness) == ["S1", "S2"]
        assert set(bounds) == {"lower", "upper", "lower_reason", "upper_reason", "s_lower", "s_upper"}
        assert [bounds[key] for key in ("lower", "upper", "s_lower", "s_upper")] == [2, 2, 5, 5]

    def test_keys_are_in_the_order_of_the_contract(self) -> None:
        keys = ["schema", "graph", "verdict", "r", "s", "profile", "bounds", "witness", "algorithm", "seconds"]
        for question in ([], ["-r", "2"], ["-r", "3"], ["-r", "2", "-s", "2"]):
            assert list(document(*question)) == keys

    def test_robust(self) -> None:
        found = document("-r", "2", "-s", "2")
        assert (found["verdict"], found["r"], found["s"]) == ("robust", 2, 2)
        assert found["witness"] is None
        assert found["profile"] is None
        assert found["bounds"]["lower"] == 2

    def test_not_robust_comes_with_a_pair_that_violates_the_definition(self) -> None:
        found = document("-r", "3")
        assert (found["verdict"], found["r"], found["s"]) == ("not-robust", 3, 1)
        graph = rb.Digraph.from_networkx(nx.wheel_graph(5))
        pair = (graph.ids(found["witness"][side]) for side in ("S1", "S2"))
        assert is_violation(graph, *pair, 3, 1)
        assert found["bounds"]["upper"] == 2

    def test_the_witness_of_a_determination_refutes_the_next_r(self) -> None:
        found = document()
        graph = rb.Digraph.from_networkx(nx.wheel_graph(5))
        assert is_violation(graph, *(graph.ids(found["witness"][side]) for side in ("S1", "S2")), found["r"] + 1, 1)

    def test_labels_of_every_type(self) -> None:
        graph = encode_topology(nx.Graph([(1, "1"), ("1", (2, ("a", 3)))]))
        assert document("-r", "2", graph=graph)["verdict"] == "not-robust"
        sides = document("-r", "2", graph=graph)["witness"]
        assert all(label in (1, "1", [2, ["a", 3]]) for label in sides["S1"] + sides["S2"])

    @pytest.mark.parametrize(("n", "r", "s", "profile"), [(0, 0, 1, {}), (1, 1, 1, {"1": 1}), (2, 0, 2, {"1": 0})])
    def test_graphs_that_are_hardly_any(self, n: int, r: int, s: int, profile: dict[str, int]) -> None:
        found = document(graph=encode_topology(nx.empty_graph(n)))
        assert (found["verdict"], found["r"], found["s"], found["profile"]) == ("determined", r, s, profile)
        assert found["graph"]["nodes"] == n

    def test_direction_matters(self) -> None:
        one_way = document(graph=encode_topology(nx.DiGraph([("a", "b"), ("a", "c")])))
        assert one_way["graph"]["directed"] is True
        assert one_way["graph"]["arcs"] == 2
        assert one_way["r"] == 1
        assert document(graph=encode_topology(nx.DiGraph([("b", "a"), ("c", "a")])))["r"] == 0

    @pytest.mark.parametrize("algorithm", sorted(rb.ALGORITHMS))
    def test_every_algorithm_gives_the_same_profile(self, algorithm: str) -> None:
        found = document("--algorithm", algorithm)
        assert (found["r"], found["s"], found["profile"]) == (2, 5, {"1": 5, "2": 5, "3": 0})
        assert found["algorithm"] == algorithm

    def test_the_profile_is_that_of_the_definition(self) -> None:
        graph = nx.gnp_random_graph(6, 0.6, seed=3, directed=True)
        plain, limits = rb.Digraph.from_networkx(graph), Limits()
        expected = {}
        for r in (1, 2, 3):
            robust = [s for s in range(1, 7) if exhaustive.decide(plain, r, s, limits).verdict is rb.Verdict.ROBUST]
            expected[str(r)] = max(robust, default=0)
        assert document(graph=encode_topology(graph))["profile"] == expected

    def test_no_profile_on_large_graphs_or_after_the_time_is_over(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("cli.check.PROFILE_NODES", 4)
        found = document("--algorithm", "exhaustive")
        assert (found["verdict"], found["profile"]) == ("determined", None)

        def late(*_: object, **__: object) -> None:
            raise rb.Undecided("late")

        monkeypatch.setattr("cli.check.PROFILE_NODES", 5)
        monkeypatch.setattr("robustness.decision.front.robustness_profile", late)
        found = document("--timeout", "9", "--algorithm", "subset-search")
        assert (found["verdict"], found["profile"]) == ("determined", None)

    def test_ctrl_c_in_the_profile_keeps_what_was_determined(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def interrupt(*_: object, **__: object) -> None:
            raise KeyboardInterrupt

        monkeypatch.setattr("robustness.decision.front.robustness_profile", interrupt)
        outcome = check("--json", "--algorithm", "exhaustive")
        found = json.loads(outcome.stdout)
        assert outcome.exit_code == 130
        assert (found["verdict"], found["r"], found["s"], found["profile"]) == ("determined", 2, 5, None)

    def test_ctrl_c_prints_the_bounds_known_so_far(self, monkeypatch: pytest.MonkeyPatch) -> None:
        pair = rb.Witness(frozenset({1}), frozenset({2}))
        known = rb.Bounds(rb.Bound(1, "connected"), rb.Bound(2, "a pair", pair))

        def interrupted(*_: object, on_bounds: object, **__: object) -> None:
            on_bounds(known)
            raise KeyboardInterrupt

        monkeypatch.setattr("robustness.decision.front.determine_robustness", interrupted)
        outcome = check("--json")
        found = json.loads(outcome.stdout)
        assert outcome.exit_code == 130
        assert found["verdict"] == "undecided"
        assert found["r"] == 1
        assert found["bounds"] == {"lower": 1, "upper": 2, "lower_reason": "connected", "upper_reason": "a pair"}
        assert found["witness"] == {"S1": [1], "S2": [2]}
        text = check()
        assert text.exit_code == 130
        assert "r* >= 1    connected\nr* <= 2    a pair\n" in text.stdout


class TestText:
    def test_determined(self) -> None:
        lines = check().stdout.splitlines()
        assert lines[0] == "determined: r* = 2: the network is 2-robust, not 3-robust; for r = 2 the greatest s is 5"
        assert lines[1] == "no node of either set has 3 or more in-neighbours outside its own set:"
        assert lines[2].startswith("  S1 = {")
        assert lines[3].startswith("  S2 = {")
        assert lines[4] == "graph      -: 5 nodes, 16 arcs, undirected"
        assert lines[5].startswith("r* >= 2 ")
        assert lines[6].startswith("r* <= 2 ")
        assert lines[7:9] == ["r          1 2 3", "greatest s 5 5 0"]
        assert lines[9].startswith("algorithm  ")
        assert lines[10].startswith("time       ")
        assert len(lines) == 11

    def test_robust_and_not_robust(self) -> None:
        assert check("-r", "2").stdout.startswith("robust: the network is 2-robust\n")
        assert check("-r", "2", "-s", "3").stdout.startswith("robust: the network is (2,3)-robust\n")
        assert check("-r", "3").stdout.startswith("not robust: the network is not 3-robust\nno node of either")
        path = encode_topology(nx.path_graph(6))
        refuted = check("-r", "1", "-s", "6", graph=path).stdout
        assert refuted.startswith("not robust: the network is not (1,6)-robust\nin each set some node has fewer than 1")
        assert "fewer than 6 have 1 or more:" in refuted

    def test_undecided_names_the_limit_and_the_bounds(self) -> None:
        graph = encode_topology(nx.gnp_random_graph(40, 0.5, seed=1))
        limited = ["--algorithm", "exhaustive", "--timeout", "0.01"]
        decision = check("-r", "8", *limited, graph=graph).stdout
        assert decision.startswith("undecided: whether the network is 8-robust is not known (the time limit")
        determination = check(*limited, graph=graph).stdout
        assert determination.startswith("undecided: the greatest r is not known (the time limit")
        assert "\nr* >= 0 " in determination

    def test_long_sets_are_cut_unless_asked_for(self) -> None:
        graph = encode_topology(nx.empty_graph(200))
        short, whole = check("-r", "1", graph=graph).stdout, check("-r", "1", "-v", graph=graph).stdout
        pair = document("-r", "1", graph=graph)["witness"]
        if max(len(side) for side in pair.values()) > 60:
            assert " more}" in short
        assert " more}" not in whole


class TestTalk:
    def test_warnings_go_to_standard_error_once(self) -> None:
        outcome = CliRunner().invoke(robustness, ["check", str(DATA / "square.edgelist")])
        assert outcome.exit_code == 0
        assert outcome.stderr.startswith(
            "warning: read as: undirected, 4 nodes, 4 links; links between columns 1 and 2"
        )
        assert outcome.stderr.endswith("; --directed if links run one way\n")
        assert outcome.stderr.count("\n") == 1
        assert "warning" not in outcome.stdout

    def test_one_reading_is_no_warning_but_a_note_where_a_word_is_due(self, tmp_path: Path) -> None:
        assert CliRunner().invoke(robustness, ["check", str(DATA / "square.graphml")]).stderr == ""
        named = tmp_path / "named.gml"
        nodes = "".join(f'node [ id {k} label "Truck {k}" ] ' for k in range(3))
        named.write_text(f"graph [ directed 1 {nodes} edge [ source 0 target 1 ] ]")
        told = CliRunner().invoke(robustness, ["check", str(named)]).stderr
        assert told == "note: read as: directed, 3 nodes, 1 link; nodes are named by their label\n"
        edges = ["check", "--directed", str(DATA / "square.edgelist")]
        assert CliRunner().invoke(robustness, edges).stderr.startswith("note: read as: directed")
        assert CliRunner().invoke(robustness, ["-q", *edges]).stderr == ""

    @pytest.mark.parametrize("arguments", [["-q", "check"], ["check", "-q"]])
    def test_quiet_leaves_results_and_errors(self, arguments: list[str]) -> None:
        outcome = CliRunner().invoke(robustness, [*arguments, str(DATA / "square.graphml")])
        assert outcome.stdout.startswith("determined:")
        assert outcome.stderr == ""
        assert "error:" in CliRunner().invoke(robustness, [*arguments, "gone.json"]).stderr

    @pytest.mark.parametrize("path", sorted(DATA.glob("square.*")), ids=lambda path: path.suffix)
    def test_every_format(self, path: Path) -> None:
        outcome = CliRunner().invoke(robustness, ["check", str(path), "--json", "-q"])
        found = json.loads(outcome.stdout)
        assert (found["r"], found["s"], found["profile"]) == (1, 4, {"1": 4, "2": 0})

    def test_a_named_network(self) -> None:
        outcome = CliRunner().invoke(robustness, ["check", "topohub:topozoo/Abilene", "--json"])
        assert (json.loads(outcome.stdout)["r"], outcome.stderr) == (1, "")

    def test_the_graph_is_read_and_never_written(self, tmp_path: Path) -> None:
        path = tmp_path / "graph.json"
        write_topology(nx.wheel_graph(5), path)
        before = path.read_bytes()
        CliRunner().invoke(robustness, ["check", str(path)])
        assert path.read_bytes() == before
        assert read_topology(path).n == 5
