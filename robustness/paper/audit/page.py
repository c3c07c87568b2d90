"""The page docs/paper-audit.md and its drawings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from robustness.figures.network import draw_to_file
from robustness.paper.audit import about_graphs, about_motion, about_notions, about_proposition, about_runs
from robustness.paper.audit.about_runs import battery, runs_in_words
from robustness.paper.audit.census import CensusRow, census
from robustness.paper.audit.claims import PLACES, Claim, Outcome
from robustness.paper.lemma_audit import Finding
from robustness.paper.lemma_audit import audit as audit_of_lemma_1
from robustness.spelled import counted

__all__ = ["CLAIMS", "census_table", "write"]

#: Every claim but those of Lemma 1, in the order of the paper; what the paper says before what we say.
CLAIMS: tuple[Claim, ...] = tuple(
    sorted(
        (
            *about_notions.CLAIMS,
            *about_motion.CLAIMS,
            *about_graphs.CLAIMS,
            *about_proposition.CLAIMS,
            *about_runs.CLAIMS,
        ),
        key=lambda claim: (PLACES.index(claim.place), not claim.is_paper),
    )
)

_FIGURES = "figures/audit"

#: How runs end.
_ENDS = ("agreement", "split", "divergence", "undecided")

#: Graphs up to so many nodes that only the exact condition promises are attacked by the simulator; on 8 there are
#: hundreds.
_PLAYED = 7


def write(folder: Path, executor: Any = None) -> None:
    """Write ``paper-audit.md`` and its drawings under the documentation's folder."""
    figures = folder / _FIGURES
    figures.mkdir(parents=True, exist_ok=True)
    drawn: list[str] = []
    rows = []
    for claim in CLAIMS:
        outcome = claim.check()
        rows.append(_row(claim, outcome, len(drawn) + 1))
        if outcome.counterexample is not None:
            drawn.append(_figure(figures, len(drawn) + 1, claim, outcome))
    found = census(executor=executor)
    played = [row for row in found if row.free and row.n <= _PLAYED]
    runs = {row: [battery(graph, row.f, seeds=2) for graph in row.free] for row in played}
    text = _PAGE.format(
        rows="\n".join(rows),
        lemma="\n".join(map(_lemma_row, audit_of_lemma_1(directed=False), audit_of_lemma_1(directed=True))),
        census=census_table(found),
        free=sum(map(len, runs.values())),
        played=_PLAYED,
        runs=runs_in_words(_sum([counts for each in runs.values() for counts in each])),
        by_row="\n".join(_runs_row(row, counts) for row, counts in runs.items()),
        figures="\n\n".join(drawn),
    )
    (folder / "paper-audit.md").write_text(text, encoding="utf-8")


def census_table(rows: tuple[CensusRow, ...]) -> str:
    """Return the census as a Markdown table."""
    head = "| n | f | connected graphs | promised | of these (2f+1)-robust | refuted | of these without delays |\n"
    lines = []
    for row in rows:
        promised, refuted = row.promised + len(row.free), row.refuted + len(row.trapped)
        counts = (row.n, row.f, row.connected, promised, row.promised, refuted, row.refuted)
        lines.append("| " + " | ".join(map(str, counts)) + " |")
    return head + "|---|---|---|---|---|---|---|\n" + "\n".join(lines)


def _row(claim: Claim, outcome: Outcome, number: int) -> str:
    result = outcome.result if outcome.result == "holds" else f"**{outcome.result}**"
    note = outcome.note
    if outcome.counterexample is not None:
        note = f"{note} ([drawn](#audit-{number}))".strip()
    cells = (claim.place, "paper" if claim.is_paper else "ours", claim.text, result, outcome.how, note)
    return "| " + " | ".join(_cell(cell) for cell in cells) + " |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _lemma_row(undirected: Finding, directed: Finding) -> str:
    statement = undirected.statement
    cells = (statement.item, "paper" if statement.is_paper else "ours", statement.text)
    results = (_word(undirected), _word(directed))
    return "| " + " | ".join(map(_cell, (*cells, *results))) + " |"


def _word(finding: Finding) -> str:
    if finding.counterexample is None:
        return "holds"
    return f"**fails** on {counted(finding.counterexample.n, 'node')}: {finding.reason}"


def _figure(folder: Path, number: int, claim: Claim, outcome: Outcome) -> str:
    assert outcome.counterexample is not None  # noqa: S101 - the caller looked
    name = f"{number:02}.svg"
    draw_to_file(outcome.counterexample, outcome.sets, folder / name)
    caption = f"**{claim.place}.** {claim.text}: {outcome.note or outcome.result}"
    return f"(audit-{number})=\n{caption}\n\n![{claim.place}]({_FIGURES}/{name})"


def _sum(counts: list[dict[str, int]]) -> dict[str, int]:
    return {verdict: sum(each[verdict] for each in counts) for verdict in _ENDS}


def _runs_row(row: CensusRow, counts: list[dict[str, int]]) -> str:
    total = _sum(counts)
    ends = (f"{total[verdict]:,}" for verdict in _ENDS)
    return "| " + " | ".join([str(row.n), str(row.f), str(len(counts)), *ends]) + " |"


_PAGE = """\
# The paper's claims, audited

The source paper is M. Safi, S. M. Dibaji, M. Pirani: *Resilient Coordinated Movement of Connected Autonomous Vehicles*
([number 1 of the references](references.md)).

This page and its drawings are made by a command, which anyone can run again (a few minutes):

```
python -m robustness.paper.audit docs
```

Every numbered statement of the source paper, the factual remarks in its prose, its numerical example and its
appendix, in our words. What a verdict means:

holds
: no counterexample in the range that was tried. A search over all small graphs decides a statement about graphs
  there and nowhere else; a simulation decides nothing, it only failed to refute. Proofs, where we have them, are in
  the docstrings.

fails
: there is a counterexample; the smallest one found (fewest nodes, then fewest links) is drawn below.

holds corrected
: as printed it is loose or wrong, and a corrected reading, given in the last column, holds.

answered
: the paper leaves it open, and it is settled here.

contradicts itself
: two places in the paper do not fit together.

not checkable
: a limit, or a result of the literature.

## Theorem, proposition, corollaries, remarks and example

| place | says | statement | result | how | finding |
|---|---|---|---|---|---|
{rows}

## Lemma 1

Tried on all graphs on 2 to 6 nodes and all digraphs on 2 to 5 (to 4 where further choices are tried), up to
isomorphism. With counterexamples in full: [Lemma 1 item by item](lemma-1.md).

| item | says | statement | graphs | digraphs |
|---|---|---|---|---|
{lemma}

## The census of the gap

Between its two conditions, (2f+1)-robust and (f+1,f+1)-robust, the paper says nothing. The exact condition under
delays is
the absence of a trap (for gains in their region), so every connected graph is promised or refuted, and nothing is left
between.
All connected graphs on up to 8 nodes, up to isomorphism:

{census}

*Promised*: no trap for f, that is, (f+1)-robust without any f nodes. *Refuted*: with a trap, which is a proved attack
under
delays; *without delays*: not even (f+1,f+1)-robust. An independent count, which tries out all sets by the definitions,
gives the
same numbers (`tests/tolerance/test_census.py`, from 7 nodes on behind the marker `slow`).

The smallest graph that is promised without being (2f+1)-robust is K_4 with f = 1; K_n with n = 3f + 1 is one for every
f that
was tried.

### What the strongest attacks achieve on graphs that only the exact condition promises

Six adversaries (constant, ramp, random, two faces, extreme value, greedy), each under adversarial, random and bounded
delays, in
every set of f vehicles, from two starts, on each of the {free} graphs on up to {played} nodes that have no trap and
are not
(2f+1)-robust: {runs}.

| n | f | graphs | runs that agree | that split | that diverge | undecided at the horizon |
|---|---|---|---|---|---|---|
{by_row}

That none of these attacks succeeds proves nothing; the proof is in docs/theorems.md.

## Drawings

A grey line is a link both ways, an arrow from u to v says that v hears u. S1 and S2 are the two sides, M is malicious;
strong
arrows lead into a side from outside, the ones that the definition counts.

{figures}
"""
