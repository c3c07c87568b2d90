"""The pages about constructions and property testing say what happens: their programs run, their output is real."""

from __future__ import annotations

import re
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import networkx as nx
import pytest
from click.testing import CliRunner
from hypothesis import settings

from cli.main import robustness
from robustness.constructions import FAMILIES
from robustness.constructions.operations import OPERATIONS
from robustness.constructions.small_graphs import batch_profiles, graphs_up_to_isomorphism

DOCS = Path(__file__).parents[2] / "docs"


def blocks(page, language):
    return re.findall(rf"```{language}\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), flags=re.DOTALL)


def run_programs(page):
    """The names that the page's programs define, run one after the other, and what they print."""
    names, printed = {"__name__": "page"}, StringIO()
    with redirect_stdout(printed):
        for program in blocks(page, "python"):
            exec(compile(program, page, "exec"), names)  # noqa: S102 - the programs are ours
    return names, printed.getvalue()


class TestConstructions:
    def test_programs_run_and_print_what_the_page_shows(self):
        _, printed = run_programs("constructions.md")
        (shown,) = blocks("constructions.md", "text")
        assert printed == shown

    def test_every_family_and_operation_is_on_the_page(self):
        page = (DOCS / "constructions.md").read_text(encoding="utf-8")
        assert [name for name in FAMILIES if f"`{name}`" not in page] == []
        assert [name for name in OPERATIONS if f"`{name.replace('-', '_')}`" not in page] == []

    @pytest.mark.parametrize(
        "line", [line for block in blocks("constructions.md", "console") for line in block.splitlines()]
    )
    def test_command_lines_are_well_formed(self, line, tmp_path, monkeypatch):
        import shlex

        monkeypatch.chdir(tmp_path)
        words = shlex.split(line.partition("|")[0])
        assert words[0] == "robustness"
        if "--fewest-edges" in words:
            words += ["--timeout", "60"]
        assert CliRunner().invoke(robustness, words[1:]).exit_code == 0

    def test_table_of_fewest_edges(self):
        import numpy as np

        page = (DOCS / "constructions.md").read_text(encoding="utf-8")
        for r in (2, 3, 4):
            (row,) = re.findall(rf"^\| r = {r} \|(.*)\|$", page, flags=re.MULTILINE)
            for n, cell in zip(range(4, 8), row.split("|"), strict=False):
                if cell.strip():
                    batch = graphs_up_to_isomorphism(n)
                    fits = batch_profiles(batch)[:, r] > 0
                    assert int(cell) == (np.bitwise_count(batch[fits]).sum(axis=1) // 2).min()


class TestPropertyTesting:
    def test_correct_algorithm_passes(self):
        names, _ = run_programs("property-testing.md")
        names["test_normal_nodes_agree"]()
        names["test_normal_nodes_stay_between_their_first_values"]()

    def test_planted_bug_is_found_and_shrinks_to_the_triangle(self):
        names, _ = run_programs("property-testing.md")
        failing = []
        original = names["run"]

        def remember(G, start, malicious, f, **options):
            failing.append((G, malicious, start))
            return original(G, start, malicious, f, **options)

        names["run"] = remember
        with pytest.raises(AssertionError):
            settings(database=None)(names["test_cutting_both_ends_agrees"])()
        G, malicious, start = failing[-1]
        assert nx.is_isomorphic(G.to_undirected(), nx.complete_graph(3))
        assert malicious == frozenset()
        assert sorted(start.values()) == [0, 0, 1]

    def test_message_is_what_the_page_shows(self):
        _, printed = run_programs("property-testing.md")
        (shown,) = blocks("property-testing.md", "text")
        assert printed == shown
