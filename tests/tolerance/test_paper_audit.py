"""The audit page is what its command writes; each check can fail; drawings show what they say."""

from __future__ import annotations

import re
from pathlib import Path

import networkx as nx
import pytest

import robustness as rb
from robustness.constructions.lemma_1 import STATEMENTS
from robustness.figures.network import draw_to_file
from robustness.paper.audit import (
    Claim,
    about_graphs,
    about_motion,
    about_notions,
    about_proposition,
    about_runs,
    census,
)
from robustness.paper.audit.__main__ import main
from robustness.paper.audit.claims import PLACES, Outcome, example, failing, holding, in_words
from robustness.paper.audit.page import CLAIMS, census_table

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "paper-audit.md").read_text(encoding="utf-8")
ABOUT_GRAPHS = (*about_notions.CLAIMS, *about_graphs.CLAIMS, *about_proposition.CLAIMS)

#: What takes more than a second or two is checked by the slow test of the whole page alone.
QUICK_RUNS = [
    claim
    for claim in (*about_motion.CLAIMS, *about_runs.CLAIMS)
    if not re.search(r"Setting|sufficiency|omissive|before Corollary 2", claim.place)
]

#: What did not hold when the page was made.
WRONG = {
    "vertex connectivity: the least number of nodes whose removal leaves it not strongly connected",
    "each vehicle can set the distances delta_ij itself",
    "vehicles form p_j[k - tau_ij] - p_i[k] from the positions they receive",
    "every neighbour's position is received at least once in tau steps",
    "misbehaviour only makes convergence longer, whatever it is",
    "a vehicle with 2f neighbours keeps its state",
    "malicious vehicles alternate between two positions",
    "adding G2, then G3 and G4, keeps it 2f-robust by Lemma 1 (iv)",
    "the delays that show each group a face of its own",
    "K_5 is the only 3-robust graph with 5 nodes; adding links to the figure leads to it",
    "vehicle 4 keeps close to vehicles 2 and 3 most of the time",
    "a condition that is both necessary and sufficient is left to find",
    "X are the nodes with at least f+1 incoming links",
    "r and s below n; item (v) of Lemma 1 lets s be n",
    "(f+1,f+1)-robustness suffices under delays (nobody says so; the gap)",
    "(2f+1)-robustness is necessary as well: every other graph has a trap",
    "f malicious vehicles need (2f+1)-connectivity (said of other algorithms)",
    "values equal to one's own count as extreme on both sides (others: on none)",
    "the unnumbered input in x and v is equivalent to (5)",
    "of the gains alpha_i nothing is asked but that they are positive",
    "(2f+1)-robust graphs agree under delays, whatever the positive gains",
    "jointly (2f+1)-robust networks with l <= tau agree",
    "vehicles wait for d_i - f neighbours before an update",
    "vehicles 1 and 5 hear that vehicle 4 is at 200",
    "the least degree of the graph of four cliques is 2f+1 or more",
    "the graph of four cliques is (f+1,f+1)-robust",
    "the malicious vehicles are those of G2",
    "large random graphs become robust",
    "checking robustness is difficult",
    "x_i - x_j tends to delta_ij; Definition 5: x_j - x_i tends to delta_ij",
    "vehicle 4 sends 2 + kTr and 200 as positions",
    "T = 0.01 and alpha = 2, 3, 10 lie where the theorem holds (needed, not said)",
    "when all vehicles see for themselves the malicious one cannot prevent agreement",
}


def row(claim: Claim) -> list[str]:
    """Return the cells of a claim's row on the page."""
    start = f"| {claim.place} | {'paper' if claim.is_paper else 'ours'} | {claim.text} | "
    (line,) = [line for line in PAGE.splitlines() if line.startswith(start)]
    return [cell.strip() for cell in line.strip("|").split(" | ")]


def test_the_page_follows_the_paper() -> None:
    places = [row(claim)[0] for claim in CLAIMS]
    assert places == sorted(places, key=PLACES.index)
    assert set(places) == set(PLACES)
    starts = [f"| {claim.place} | {'paper' if claim.is_paper else 'ours'} | {claim.text} |" for claim in CLAIMS]
    assert [PAGE.index(start) for start in starts] == sorted(PAGE.index(start) for start in starts)


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim.place}: {claim.text[:40]}")
def test_every_claim_is_on_the_page_with_its_result(claim: Claim) -> None:
    assert ("holds" == row(claim)[3]) == (claim.text not in WRONG)


@pytest.mark.parametrize("claim", ABOUT_GRAPHS, ids=lambda claim: f"{claim.place}: {claim.text[:40]}")
def test_claims_about_graphs_come_out_as_the_page_says(claim: Claim, tmp_path: Path) -> None:
    outcome, cells = claim.check(), row(claim)
    assert cells[3].strip("*") == outcome.result
    assert cells[4] == outcome.how
    if outcome.counterexample is not None:
        (number,) = re.findall(r"\[drawn\]\(#audit-(\d+)\)", cells[5])
        draw_to_file(outcome.counterexample, outcome.sets, tmp_path / "drawn.svg")
        committed = DOCS / "figures" / "audit" / f"{int(number):02}.svg"
        assert (tmp_path / "drawn.svg").read_bytes() == committed.read_bytes()


@pytest.mark.parametrize(
    "claim",
    QUICK_RUNS,
    ids=lambda claim: f"{claim.place}: {claim.text[:40]}",
)
def test_quick_claims_about_runs_come_out_as_the_page_says(claim: Claim) -> None:
    outcome, cells = claim.check(), row(claim)
    note = cells[5] if len(cells) > 5 else ""
    assert (cells[3].strip("*"), cells[4], note) == (outcome.result, outcome.how, outcome.note)


def test_every_statement_of_lemma_1_is_on_the_page() -> None:
    for statement in STATEMENTS:
        assert f"| {statement.item} | {'paper' if statement.is_paper else 'ours'} | {statement.text} |" in PAGE


def test_the_census_of_the_page_up_to_seven_nodes() -> None:
    for line in census_table(census(7)).splitlines():
        assert line in PAGE.splitlines()


@pytest.mark.slow
def test_the_command_writes_what_is_committed(tmp_path: Path) -> None:
    main([str(tmp_path)])
    assert (tmp_path / "paper-audit.md").read_text(encoding="utf-8") == PAGE
    written = {path.name: path.read_text(encoding="utf-8") for path in (tmp_path / "figures" / "audit").iterdir()}
    committed = {path.name: path.read_text(encoding="utf-8") for path in (DOCS / "figures" / "audit").iterdir()}
    assert written == committed


class TestChecks:
    """A check that cannot fail checks nothing."""

    def test_a_false_claim_fails_on_a_smallest_graph(self) -> None:
        found = holding(lambda graph: "three nodes" if graph.n == 3 else None)
        assert found.result == "fails"
        assert found.counterexample is not None
        assert found.counterexample.n == 3

    def test_a_claim_called_false_that_holds_is_said_to_hold(self) -> None:
        assert failing(lambda _: None, "nothing").result == "holds"

    def test_what_no_graph_shows_does_not_exist(self) -> None:
        assert example(lambda _: None).result == "fails"

    def test_a_range_is_said_as_it_was_tried(self) -> None:
        tried = set()
        found = holding(lambda graph: tried.add((graph.directed, graph.n)), graphs=4, digraphs=3)
        assert found.how == in_words(4, 3) == "search: all graphs on 2 to 4 nodes, all digraphs on 2 to 3 nodes"
        assert tried == {(False, 2), (False, 3), (False, 4), (True, 2), (True, 3)}
        assert in_words(4, 0) == "search: all graphs on 2 to 4 nodes"

    def test_the_battery_splits_what_can_be_split(self) -> None:
        counts = about_runs.battery(rb.Digraph.from_networkx(nx.path_graph(4)), 1)
        assert counts["split"] > 0
        assert sum(counts.values()) == 4 * len(about_runs.STRONGEST) * len(about_runs.SCHEDULES)

    def test_the_battery_does_not_split_what_is_promised(self) -> None:
        counts = about_runs.battery(rb.Digraph.from_networkx(nx.complete_graph(5)), 1)
        assert counts["split"] == counts["undecided"] == 0

    def test_outcomes_name_a_result_of_the_legend(self) -> None:
        legend = set(re.findall(r"^(\w[\w ]+)\n: ", PAGE, flags=re.MULTILINE))
        assert {row(claim)[3].strip("*") for claim in CLAIMS} <= legend
        assert isinstance(CLAIMS[0].check(), Outcome)
