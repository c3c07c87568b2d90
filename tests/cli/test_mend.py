"""``mend`` and ``thin``: exit codes, files, JSON, constraints, certificates that verify on a bare Python."""

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
from cli.exit_codes import ExitCode
from cli.main import robustness
from robustness.files import write_topology

ROOT = Path(__file__).parents[2]


@pytest.fixture
def platoon(tmp_path: Path) -> Path:
    write_topology(nx.path_graph(6), tmp_path / "path.json")
    return tmp_path / "path.json"


def run(*arguments: object) -> Result:
    return CliRunner().invoke(robustness, [*map(str, arguments)])


def test_mended_certified_drawn_and_verified(platoon: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    mended, certificate, picture = (tmp_path / name for name in ("mended.json", "mended.cert", "mended.svg"))
    done = run("mend", platoon, "-r", 2, "-s", 2, "-o", mended, "--goal-certificate", certificate, "--plot", picture)
    assert done.exit_code == ExitCode.DONE, done.output
    assert done.stdout.startswith("optimal: 4 links, cost 4; nothing cheaper")
    assert done.stdout.count("  add  ") == 4
    assert "before  5 links, r* = 1" in done.stdout
    assert "r* = 1, s = 2, survives f = 0 under malicious\nafter" in done.stdout
    assert "after   9 links, r* = 2, s = 2, survives f = 1 under malicious" in done.stdout
    assert b"<!-- link added -->" in picture.read_bytes()
    canonical = tmp_path / "mended.graph"
    canonical.write_bytes(rb.read_topology(mended).canonical_bytes())
    command = ["-I", "-m", "certificates", "verify", str(canonical), str(certificate), "--expect", "robust", "-r", "2"]
    checked = subprocess.run([sys.executable, *command], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr


def test_the_certificate_of_the_least_cost_is_verified(platoon: Path, tmp_path: Path) -> None:
    certificate, canonical = tmp_path / "mending.cert", tmp_path / "path.graph"
    done = run("mend", platoon, "-r", 2, "-s", 2, "--certificate", certificate)
    assert "verified" in done.stderr
    verified = run("verify", platoon, certificate)
    assert verified.exit_code == ExitCode.DONE, verified.output
    assert "the kernel's tree over choices confirms that to break them all costs at least 4" in verified.stdout
    by_highs = run("verify", platoon, certificate, "--choices", 0)
    assert (by_highs.exit_code, by_highs.stdout.count("HiGHS confirms that")) == (ExitCode.DONE, 1)
    found = json.loads(run("verify", platoon, certificate, "--json").stdout)
    assert (found["cost"], found["least"], found["bound"], found["solver"]) == (4, 4, "confirmed", "kernel")
    assert run("verify", platoon, certificate, "--timeout", "0.001").exit_code in (ExitCode.DONE, ExitCode.UNDECIDED)
    assert run("verify", platoon, certificate, "--expect", "robust").exit_code == ExitCode.REFUTED
    canonical.write_bytes(rb.read_topology(platoon).canonical_bytes())
    command = ["-I", "-m", "certificates", "verify", str(canonical), str(certificate)]
    checked = subprocess.run([sys.executable, *command], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr
    assert "proven by a tree over choices" in checked.stdout
    checked = subprocess.run([sys.executable, *command, "--choices", "3"], capture_output=True, text=True, check=False)
    assert (checked.returncode, checked.stdout.count("left to a solver")) == (0, 1)
    forged = tmp_path / "forged.cert"
    forged.write_bytes(certificate.read_bytes().replace(b'"pairs":[', b'"pairs":[[0,[],[1],[3]],'))
    assert run("verify", platoon, forged).exit_code == ExitCode.REFUTED


def test_a_certificate_of_thinning_is_verified_with_the_network(tmp_path: Path) -> None:
    write_topology(nx.complete_graph(5), tmp_path / "five.json")
    assert run("thin", tmp_path / "five.json", "-r", 2, "--certificate", tmp_path / "t.cert").exit_code == ExitCode.DONE
    assert run("verify", tmp_path / "five.json", tmp_path / "t.cert").exit_code == ExitCode.DONE


def test_arcs_are_counted_where_links_run_one_way(platoon: Path, tmp_path: Path) -> None:
    mended = tmp_path / "mended.json"
    done = run("mend", platoon, "-r", 2, "--one-way", "-o", mended)
    added = done.stdout.count("  add  ")
    assert "before  10 arcs, r* = 1" in done.stdout
    assert f"after   {10 + added} arcs, r* = 2" in done.stdout
    assert rb.read_topology(mended).arc_count == 10 + added
    said = json.loads(run("mend", platoon, "-r", 2, "--one-way", "--json").stdout)
    assert (said["before"]["links"], said["after"]["links"]) == (10, 10 + added)


def test_json(platoon: Path) -> None:
    found = json.loads(run("mend", platoon, "--survive", 1, "--model", "delayed", "--json").stdout)
    assert found["schema"] == "robustness/mend/1"
    assert found["verdict"] == "optimal"
    assert found["cost"] == found["lower_bound"] == len(found["links"])
    assert (found["before"]["r"], found["goal"]) == (1, "survives f = 1 under delayed")
    graph = nx.path_graph(6)
    for facts, links in ((found["before"], []), (found["after"], found["links"])):
        graph.add_edges_from(map(tuple, links))
        known, table = rb.determine_robustness(graph), rb.tolerance(graph)
        assert (facts["r"], facts["s"], facts["r_bounds"]) == (known.r, known.s, [known.r, known.r])
        assert {name: told["guaranteed"] for name, told in facts["tolerance"].items()} == table.guaranteed
        assert {name: told["refuted"] for name, told in facts["tolerance"].items()} == table.refuted
    assert table.guaranteed["delayed"] >= 1
    told = run("mend", platoon, "--survive", 1, "--model", "delayed").stdout
    assert "survives f = 0 under delayed\nafter" in told


def test_before_and_after_of_networks_too_large_to_decide_in_short(tmp_path: Path) -> None:
    graph = nx.random_regular_graph(10, 60, seed=2)
    write_topology(graph, tmp_path / "dense.json")
    done = run("mend", tmp_path / "dense.json", "-r", 2, "--json")  # nothing is needed, which takes no search
    facts = json.loads(done.stdout)["before"]
    low, high = facts["r_bounds"]
    assert 2 <= low <= high
    assert facts["r"] == (low if low == high else None)
    assert facts["tolerance"]["malicious"]["guaranteed"] >= 0
    told = run("mend", tmp_path / "dense.json", "-r", 2).stdout
    assert f"r* = {low}" + ("" if low == high else f"..{high}") in told


def test_impossible_is_refuted_with_the_pair(platoon: Path) -> None:
    done = run("mend", platoon, "-r", 4)
    assert done.exit_code == ExitCode.REFUTED
    assert "no candidate breaks these sets, so this is out of reach" in done.stdout
    assert "S1  {" in done.stdout


def test_a_limit_is_undecided_and_says_what_holds(tmp_path: Path) -> None:
    write_topology(nx.path_graph(24), tmp_path / "long.json")
    done = run("mend", tmp_path / "long.json", "-r", 3, "--timeout", 2)
    assert done.exit_code == ExitCode.UNDECIDED
    assert "at least" in done.stdout
    assert re.search(r"before +23 links.*\nafter +\d+ links", done.stdout)


def test_candidates_forbidden_required_and_range(platoon: Path, tmp_path: Path) -> None:
    write_topology(nx.Graph([(0, 2), (1, 3), (2, 4), (3, 5)]), tmp_path / "near.json")
    write_topology(nx.Graph([(0, 5)]), tmp_path / "far.json")
    near = json.loads(run("mend", platoon, "-r", 2, "--candidates", tmp_path / "near.json", "--json").stdout)
    assert all(v - u == 2 for u, v in near["links"])
    barred = json.loads(run("mend", platoon, "-r", 2, "--forbid", tmp_path / "far.json", "--json").stdout)
    assert [0, 5] not in barred["links"]
    forced = json.loads(run("mend", platoon, "-r", 2, "--mandatory", tmp_path / "far.json", "--json").stdout)
    assert [0, 5] in forced["links"]
    graph = nx.path_graph(6)
    nx.set_node_attributes(graph, {k: float(k) for k in graph}, "x")
    nx.set_node_attributes(graph, 0.0, "y")
    nx.write_graphml(graph, tmp_path / "placed.graphml")
    placed = json.loads(
        run("mend", tmp_path / "placed.graphml", "-r", 2, "--range", 2, "--cost", "distance", "--json").stdout
    )
    assert placed["verdict"] == "optimal"
    assert placed["cost"] == 2 * len(placed["links"])
    write_topology(nx.Graph([(0, 99)]), tmp_path / "strange.json")
    strange = run("mend", platoon, "-r", 2, "--candidates", tmp_path / "strange.json")
    assert strange.exit_code == ExitCode.BAD_INPUT
    assert "99" in strange.stderr


def test_budget(platoon: Path) -> None:
    assert run("mend", platoon, "-r", 2, "-s", 2, "--budget", 3).exit_code == ExitCode.REFUTED
    assert run("mend", platoon, "-r", 2, "-s", 2, "--budget", 4).exit_code == ExitCode.DONE
    bought = run("mend", platoon, "--budget", 4)
    assert bought.exit_code == ExitCode.DONE
    assert bought.stdout.startswith("the budget buys (2,4)-robust, for 4; it does not buy (2,5)-robust")
    found = json.loads(run("mend", platoon, "--budget", 4, "--json").stdout)
    assert (found["goal"], found["missed"], found["is_exact"]) == ("(2,4)-robust", "(2,5)-robust", True)
    assert run("mend", platoon, "--budget", "-1").exit_code != ExitCode.DONE
    assert run("mend", platoon).exit_code == ExitCode.USAGE


def test_thin(tmp_path: Path) -> None:
    write_topology(nx.complete_graph(5), tmp_path / "five.json")
    done = run("thin", tmp_path / "five.json", "-r", 2, "-s", 2, "-o", tmp_path / "thin.json")
    assert done.exit_code == ExitCode.DONE
    assert "3 links can go" in done.stdout
    assert rb.is_rs_robust(rb.read_topology(tmp_path / "thin.json"), 2, 2)
    assert run("thin", tmp_path / "five.json", "-r", 4).exit_code == ExitCode.REFUTED


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["-s", "2"],
        ["-r", "2", "--model", "delayed"],
        ["-r", "-1"],
        ["-r", "2", "--candidates", "a", "--range", "1"],
    ],
)
def test_usage(platoon: Path, arguments: list[str]) -> None:
    assert run("mend", platoon, *arguments).exit_code == ExitCode.USAGE


def test_no_output_over_an_input(platoon: Path) -> None:
    assert run("mend", platoon, "-r", 2, "-o", platoon).exit_code == ExitCode.USAGE
    assert rb.read_topology(platoon).arc_count == 10


def test_ctrl_c_keeps_the_best_links(tmp_path: Path) -> None:
    write_topology(nx.path_graph(20), tmp_path / "long.json")
    with subprocess.Popen(
        [sys.executable, "-m", "cli", "mend", str(tmp_path / "long.json"), "-r", "3", "--json"],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=dict(os.environ),
    ) as process:
        time.sleep(6)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    assert process.returncode == ExitCode.INTERRUPTED
    found = json.loads(out)
    if found["schema"] == "robustness/error/1":  # on a very slow machine nothing is known yet
        assert "nothing is claimed" in err
    else:
        assert found["verdict"] in ("feasible", "undecided")


def test_an_interrupted_budget_prints_what_it_buys(tmp_path: Path) -> None:
    """The first rungs of the ladder are climbed at once, and what is known of them is not lost."""
    write_topology(nx.path_graph(40), tmp_path / "long.json")
    command = [sys.executable, "-m", "cli", "mend", str(tmp_path / "long.json"), "--budget", "60", "--json"]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        time.sleep(6)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
    assert process.returncode == ExitCode.INTERRUPTED, err
    found = json.loads(out)
    if found["schema"] == "robustness/error/1":  # on a very slow machine nothing is known yet
        assert "nothing is claimed" in err
    else:
        assert (found["is_exact"], found["missed"]) == (False, None)
        assert found["before"]["links"] == 39


class TestCostsAndCapsFromFiles:
    @pytest.fixture
    def candidates(self, tmp_path: Path) -> Path:
        file = tmp_path / "candidates.csv"
        file.write_text("source,target,price\n0,2,3\n0,3,1.5\n1,3,1\n0,4,1.5\n")
        return file

    @pytest.fixture
    def path(self, tmp_path: Path) -> Path:
        write_topology(nx.path_graph(4), tmp_path / "four.json")
        return tmp_path / "four.json"

    @pytest.fixture
    def five(self, tmp_path: Path) -> Path:
        write_topology(nx.path_graph(5), tmp_path / "five.json")
        return tmp_path / "five.json"

    def test_the_column_of_a_file_is_what_links_cost(self, five: Path, candidates: Path) -> None:
        found = json.loads(run("mend", five, "-r", 2, "--candidates", candidates, "--cost", "price", "--json").stdout)
        assert (found["verdict"], found["cost"]) == ("optimal", 4)
        assert found["links"] == [[0, 3], [0, 4], [1, 3]]

    def test_links_without_the_attribute_and_attributes_without_a_file(self, five: Path, candidates: Path) -> None:
        wrong = run("mend", five, "-r", 2, "--candidates", candidates, "--cost", "weight")
        assert wrong.exit_code == ExitCode.BAD_INPUT
        assert "links here have: price" in wrong.stderr
        assert run("mend", five, "-r", 2, "--cost", "price").exit_code == ExitCode.USAGE
        candidates.write_text("source,target,price\n0,2,3\n0,3,\n1,3,1\n0,4,2\n")
        lacks = run("mend", five, "-r", 2, "--candidates", candidates, "--cost", "price")
        assert lacks.exit_code == ExitCode.USAGE
        assert "has no cost" in lacks.stderr

    def test_thin_keeps_what_is_cheap_to_keep(self, tmp_path: Path) -> None:
        ring = nx.cycle_graph(4)
        nx.set_edge_attributes(ring, {(0, 1): 9, (1, 2): 1, (2, 3): 1, (0, 3): 1}, "price")
        file = tmp_path / "ring.graphml"
        nx.write_graphml_xml(ring, file)
        found = json.loads(run("thin", file, "-r", 1, "--cost", "price", "--json").stdout)
        assert (found["cost"], found["dropped"]) == (3, [["0", "1"]])
        assert run("thin", file, "-r", 1, "--cost", "weight").exit_code == ExitCode.BAD_INPUT

    @pytest.mark.parametrize("text", ["0,1\n3,2\n", '{"0": 1, "3": 2}'])
    def test_every_node_has_a_cap_of_its_own(self, path: Path, tmp_path: Path, text: str) -> None:
        caps = tmp_path / "caps"
        caps.write_text(text)
        capped = json.loads(run("mend", path, "-r", 1, "-s", 2, "--max-in-degree", caps, "--json").stdout)
        free = json.loads(run("mend", path, "-r", 1, "-s", 2, "--json").stdout)
        assert capped["cost"] >= free["cost"]
        assert run("mend", path, "-r", 2, "--max-in-degree", caps).exit_code == ExitCode.REFUTED
        assert run("mend", path, "-r", 2, "--max-in-degree", 3).exit_code == ExitCode.DONE

    @pytest.mark.parametrize("text", ["0;1\n", "0,one\n", "[1]", '{"0": null}', "7,1\n"])
    def test_files_that_say_no_caps(self, path: Path, tmp_path: Path, text: str) -> None:
        caps = tmp_path / "caps"
        caps.write_text(text)
        assert run("mend", path, "-r", 2, "--max-in-degree", caps).exit_code == ExitCode.BAD_INPUT
        assert run("mend", path, "-r", 2, "--max-in-degree", tmp_path / "none").exit_code == ExitCode.USAGE

    def test_a_budget_and_a_threat_model_without_a_goal(self, path: Path) -> None:
        bought = run("mend", path, "--budget", 3, "--model", "delayed")
        assert bought.exit_code == ExitCode.DONE
        assert bought.stdout.startswith("the budget buys the survival of f = 1 under delayed, for 3")
        assert run("mend", path, "--model", "delayed").exit_code == ExitCode.USAGE


@pytest.mark.parametrize(
    ("content", "word"),
    [
        ('{"0": 2.7}', "whole numbers"),
        ('{"0": true}', "whole numbers"),
        ("0,1_0\n", "whole numbers"),
        ("0,-1\n", "whole numbers"),
        ("0,3\n0,2\n", "two caps"),
        ('{"0": 3, "0": 2}', "two caps"),
        ("9,3\n", "none of the network"),
    ],
)
def test_caps_that_say_nothing_clear_are_refused(platoon: Path, tmp_path: Path, content: str, word: str) -> None:
    caps = tmp_path / "caps.txt"
    caps.write_text(content)
    outcome = run("mend", platoon, "-r", 2, "--max-in-degree", caps)
    assert outcome.exit_code == ExitCode.BAD_INPUT
    assert word in outcome.stderr


def test_nodes_that_a_file_cannot_tell_apart_are_refused(tmp_path: Path) -> None:
    network, links = tmp_path / "network.json", tmp_path / "links.csv"
    write_topology(rb.Digraph([1, "1", 2], [(1, 2), (2, "1")]), network)
    links.write_text("source,target\n1,2\n")
    for option in ("--candidates", "--forbid"):
        outcome = run("mend", network, "-r", 1, option, links)
        assert outcome.exit_code == ExitCode.BAD_INPUT
        assert "cannot tell apart" in outcome.stderr
