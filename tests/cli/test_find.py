"""``robustness find``: exit codes 0, 10 and 30, the graph on standard output, JSON."""

from __future__ import annotations

import json
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

import robustness as rb
from cli.main import robustness
from robustness.files import decode_topology, read_topology

WHEEL = ["-p", "2-robust", "-p", "(2,2)-robust", "-p", "min-degree>=3", "-p", "trap(1)"]


def find(*arguments: str) -> Result:
    return CliRunner().invoke(robustness, ["find", *arguments])


class TestFound:
    def test_the_wheel_goes_to_standard_output(self) -> None:
        found = find("-n", "1..7", *WHEEL)
        assert found.exit_code == 0
        graph = decode_topology(found.stdout.encode())
        assert nx.is_isomorphic(graph.to_networkx(), nx.wheel_graph(5))
        assert "found: 5 nodes, 8 edges, no graph with fewer fits; none on 1..4 nodes" in found.stderr

    def test_or_to_a_file(self, tmp_path: Path) -> None:
        found = find("-n", "6", "-p", "3-connected", "-x", "2-robust", "-o", str(tmp_path / "prism.json"))
        assert (found.exit_code, found.stdout.split(":")[0]) == (0, "found")
        assert not rb.is_r_robust(read_topology(tmp_path / "prism.json"), 2)

    def test_json(self) -> None:
        document = json.loads(find("-n", "5", *WHEEL, "--json").stdout)
        assert next(iter(document)) == "schema"
        assert document["schema"] == "robustness/find/1"
        assert (document["verdict"], document["n"], document["edges"], document["method"]) == (
            "found",
            5,
            8,
            "enumeration",
        )
        assert set(document["trap"]) == {"M", "S1", "S2"}
        assert decode_topology(json.dumps(document["topology"]).encode()).sha256 == document["graph"]["sha256"]

    def test_directed(self) -> None:
        found = find("-n", "3", "-p", "1-robust", "-x", "1-connected", "--directed", "--fewest-edges")
        assert decode_topology(found.stdout.encode()).directed


class TestImpossible:
    def test_ends_in_ten(self) -> None:
        ended = find("-n", "2..5", "-p", "3-robust", "-x", "min-degree>=3")
        assert (ended.exit_code, ended.stdout) == (10, "impossible: no graph on 2..5 nodes fits\n")

    def test_json(self) -> None:
        document = json.loads(find("-n", "4", "-p", "3-robust", "--json").stdout)
        assert (document["verdict"], document["topology"], document["impossible_for"]) == ("impossible", None, [4])


class TestUndecided:
    def test_ends_in_thirty(self) -> None:
        ended = find("-n", "13", "-p", "5-robust", "--fewest-edges", "--timeout", "0.5", "--json")
        assert ended.exit_code == 30
        document = json.loads(ended.stdout)
        assert document["verdict"] == "undecided"
        assert not document["has_fewest_edges"]
        assert document["stats"]["reason"]


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["-n", "x"],
        ["-n", "7..2"],
        ["-n", "-1"],
        ["-n", "5", "-p", "very robust"],
        ["-n", "5", "--timeout", "0"],
        ["-n", "5", "-p", "1-robust", "-o", "/nowhere/found.json"],
    ],
)
def test_misuse_ends_in_usage(arguments: list[str]) -> None:
    ended = find(*arguments)
    assert ended.exit_code == 2
    assert ended.stdout == ""
