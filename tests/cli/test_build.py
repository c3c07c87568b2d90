"""``robustness build``: every family can be built, listed and piped on."""

from __future__ import annotations

import json
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner, Result

from cli.main import robustness
from robustness.constructions import FAMILIES, build
from robustness.digraph import as_digraph
from robustness.files import decode_topology, read_topology
from robustness.traps import is_trap


def run(*arguments: str, stdin: str | None = None) -> Result:
    return CliRunner().invoke(robustness, arguments, input=stdin)


class TestGraph:
    def test_goes_to_standard_output_and_pipes_into_check(self) -> None:
        built = run("build", "wheel", "--n", "7")
        assert built.exit_code == 0
        assert decode_topology(built.stdout.encode()) == as_digraph(nx.wheel_graph(7))
        assert "r* = 2, greatest s for it 3" in built.stderr
        checked = run("check", "-", "-r", "2", "-s", "3", stdin=built.stdout)
        assert checked.exit_code == 0

    @pytest.mark.parametrize("name", ["wheel.json", "wheel.g6", "wheel.npy"])
    def test_goes_to_a_file_in_the_format_of_its_suffix(self, tmp_path: Path, name: str) -> None:
        built = run("build", "wheel", "--n", "7", "-o", str(tmp_path / name))
        assert built.exit_code == 0
        assert built.stdout.startswith("wheel: 7 nodes, 12 edges\n")
        assert read_topology(tmp_path / name) == as_digraph(nx.wheel_graph(7))

    def test_keeps_its_trap_in_json(self, tmp_path: Path) -> None:
        place = tmp_path / "counterexample.json"
        assert run("build", "two-f-robust", "--f", "2", "--variant", "corrected", "-o", str(place)).exit_code == 0
        trap = json.loads(place.read_text())["graph"]["trap"]
        assert is_trap(read_topology(place), 2, trap["M"], trap["S1"], trap["S2"])

    def test_quiet_says_only_the_graph(self) -> None:
        assert run("build", "petersen", "-q").stderr == ""

    def test_json_is_one_document(self) -> None:
        document = json.loads(run("build", "complete-multipartite", "--sizes", "3,2,1", "--json").stdout)
        assert document["schema"] == "robustness/build/1"
        assert document["family"] == {"name": "complete-multipartite", "parameters": {"sizes": [3, 2, 1]}}
        assert document["known"]["r"] == 3
        graph = decode_topology(json.dumps(document["topology"]).encode())
        assert (
            document["graph"]["sha256"]
            == graph.sha256
            == as_digraph(build("complete-multipartite", sizes=[3, 2, 1])).sha256
        )

    def test_options_are_those_of_the_family(self) -> None:
        built = run("build", "erdos-renyi", "--n", "5", "--p", "0.5", "--directed", "--seed", "3")
        assert decode_topology(built.stdout.encode()) == as_digraph(
            build("erdos-renyi", n=5, p=0.5, directed=True, seed=3)
        )

    def test_one_link_is_one(self) -> None:
        assert run("build", "path", "--n", "2").stderr.startswith("path: 2 nodes, 1 edge\n")

    @pytest.mark.parametrize(
        ("name", "told"),
        [
            ("whel", "No such family 'whel': did you mean wheel?"),
            ("xyzzy", "No such family 'xyzzy': robustness build --list"),
        ],
    )
    def test_a_mistyped_family_is_called_one(self, name: str, told: str) -> None:
        outcome = run("build", name)
        assert outcome.exit_code == 2
        assert told in outcome.stderr


class TestList:
    def test_is_made_of_sentences_and_of_options_as_they_are_typed(self) -> None:
        listed = run("build", "--list").stdout.splitlines()
        assert [line for line in listed if line != line.rstrip()] == []
        assert [line for line in listed if ". c" in line] == []
        assert any(line.endswith("--n N --r N [--seed N]") for line in listed)

    def test_names_every_family_with_its_value(self) -> None:
        listed = run("build", "--list")
        assert listed.exit_code == 0
        for name, family in FAMILIES.items():
            assert name in listed.stdout
            assert family.value in listed.stdout

    def test_as_json(self) -> None:
        document = json.loads(run("build", "--list", "--json").stdout)
        assert document["schema"] == "robustness/build-list/1"
        assert [family["name"] for family in document["families"]] == list(FAMILIES)
        (parameter,) = next(each for each in document["families"] if each["name"] == "wheel")["parameters"]
        assert parameter == {"name": "n", "type": "int", "default": None}

    @pytest.mark.parametrize("name", FAMILIES)
    def test_every_family_has_help(self, name: str) -> None:
        shown = run("build", name, "--help")
        assert shown.exit_code == 0
        assert "``" not in shown.stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["nothing"],
        ["wheel"],
        ["wheel", "--n", "x"],
        ["wheel", "--n", "3"],
        ["wheel", "--k", "3"],
        ["complete-multipartite", "--sizes", "3,,1"],
        ["five-node-figure", "--reading", "third"],
        ["wheel", "--n", "5", "-o", "/nowhere/wheel.json"],
    ],
)
def test_misuse_ends_in_usage(arguments: list[str]) -> None:
    ended = run("build", *arguments)
    assert ended.exit_code == 2
    assert ended.stdout == ""
    assert ended.stderr


def test_an_unknown_suffix_is_bad_input() -> None:
    assert run("build", "wheel", "--n", "5", "-o", "wheel.xyz").exit_code == 3
