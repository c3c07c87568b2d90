"""How labels, sets and counts are written: as people write them, and two nodes never look alike."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

import robustness as rb
from cli.main import robustness
from robustness.spelled import Spelling, counted, labels_in_words

ROOT = Path(__file__).parent.parent

LABELS = st.recursive(
    st.integers(-3, 3) | st.text("1,2 ab'\"{}()-", max_size=4),
    lambda inner: st.tuples(inner) | st.tuples(inner, inner),
    max_leaves=3,
)


@given(st.sets(LABELS, max_size=8))
def test_no_two_nodes_of_a_network_look_alike(labels: set[object]) -> None:
    spelled = Spelling(labels)
    assert len({spelled(label) for label in labels}) == len(labels)


def test_quotes_stand_only_where_they_tell_something() -> None:
    assert labels_in_words({"Truck 2", "Truck 1"}) == "{Truck 1, Truck 2}"
    assert labels_in_words({"São Paulo (BR)", "St. John's", "x_1"}) == "{St. John's, São Paulo (BR), x_1}"
    assert labels_in_words({"1", "2"}, among=["1", "2", "3"]) == "{1, 2}"
    assert labels_in_words({"1", "2"}, among=["1", 1, "2", "3"]) == "{'1', 2}"
    assert labels_in_words({"a, b"}, among=["a, b", "c"]) == "{'a, b'}"


@pytest.fixture
def platoon(tmp_path: Path) -> str:
    graph = nx.DiGraph([("0", "1"), ("1", "2"), ("2", "3"), ("0", "2"), ("1", "3"), ("3", "0")])
    path = tmp_path / "platoon.graphml"
    nx.write_graphml(nx.relabel_nodes(graph, {str(k): f"Truck {k + 1}" for k in range(4)}), path)
    return str(path)


COMMANDS = [
    "check GRAPH", "check GRAPH -r 2 -v", "attack GRAPH", "attack GRAPH --model byzantine", "tolerance GRAPH -v",
    "tolerance GRAPH -q", "simulate GRAPH --malicious 'Truck 1' --steps 20", "mend GRAPH -r 3", "mend GRAPH -r 2",
    "thin GRAPH -r 1", "joint GRAPH -r 3 --period 1", "survey GRAPH --as junit", "survey GRAPH",
    "sample GRAPH -r 1 --nodes 2", "simulate GRAPH --malicious nobody", "verify GRAPH GRAPH", "attack GRAPH -f 3",
]  # fmt: skip


@pytest.mark.parametrize("line", COMMANDS)
def test_no_command_shows_labels_as_python_writes_them(line: str, platoon: str) -> None:
    arguments = [platoon if word == "GRAPH" else word.strip("'") for word in re.findall(r"'[^']*'|\S+", line)]
    outcome = CliRunner().invoke(robustness, arguments)
    said = outcome.stdout + outcome.stderr
    assert said
    for sign in ("'Truck", '"Truck', "frozenset", "None,", " None\n", "True", "False", "{}", "node(s)"):
        assert sign not in said, said
    assert not re.search(r"\b1 (?:nodes|arcs|links|steps|networks|rows|edges|runs|losses)\b", said), said


def test_nodes_that_look_alike_are_told_apart_by_a_command(tmp_path: Path) -> None:
    path = tmp_path / "alike.json"
    graph = nx.Graph([(1, "1"), ("1", 2), (2, "3"), (2, 4)])
    rb.write_topology(graph, path)
    said = CliRunner().invoke(robustness, ["simulate", str(path), "--malicious", "nobody"]).stderr
    assert "'1'" in said
    assert "'3'" not in said


def test_a_count_goes_with_its_word() -> None:
    assert [counted(k, "node") for k in (0, 1, 2)] == ["0 nodes", "1 node", "2 nodes"]


#: What is counted in sentences; a message that says so of a number goes through ``counted``.
NOUNS = "nodes|arcs|links|edges|networks|steps|runs|models|searches|violations|liars|vertices|losses"
#: Here the number is fixed, or at least two by what the code has made sure of before.
SETTLED = ("robustness/kernels/",)


def counts_without_their_word(source: str) -> list[int]:
    """Return the lines of f-strings in which a number stands before a plural, or an s hangs on a condition.

    Constants, ranges such as "2 to {n} nodes" and numbers in thousands are left out.
    """
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.JoinedStr):
            parts = [ast.Constant(""), *node.values, ast.Constant("")]
            for before, value, after in zip(parts, parts[1:], parts[2:], strict=False):
                if not isinstance(value, ast.FormattedValue):
                    continue
                told = ast.unparse(value.value)
                words = after.value if isinstance(after, ast.Constant) else ""
                is_range = isinstance(before, ast.Constant) and before.value.endswith((" to ", ".."))
                is_settled = told.isupper() or told.startswith(("counted(", "'")) or value.format_spec or is_range
                if (not is_settled and re.match(rf" (?:[a-z]+ )?(?:{NOUNS})\b", words)) or (
                    re.match(r" \w+\(s\)", words) or re.match(r"'s' (?:\*|if .*\d)", told)
                ):
                    found.append(node.lineno)
    return found


def test_the_search_for_such_counts_finds_them() -> None:
    assert counts_without_their_word('f"{n} nodes", f"{g.n} robust nodes", f"{f(n)} file(s)"') == [1, 1, 1]
    assert counts_without_their_word('f"{sum(x)} steps", f"{n} step{\'s\' * (n != 1)}", f"{f + 1} links"') == [1, 1, 1]
    assert counts_without_their_word('f"2 to {n} nodes", f"{n:,} steps"') == []
    assert counts_without_their_word('f"{MOST} nodes", f"{counted(n, word)} of {g}"') == []


def test_no_message_counts_without_minding_one() -> None:
    lines = {
        f"{path.relative_to(ROOT)}:{line}"
        for room in ("robustness", "cli")
        for path in sorted((ROOT / room).rglob("*.py"))
        if not str(path.relative_to(ROOT)).startswith(SETTLED)
        for line in counts_without_their_word(path.read_text())
    }
    assert lines == set()
