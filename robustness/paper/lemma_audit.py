"""The audit of Lemma 1: every statement on every small graph and digraph, as a table for the documentation.

``python -m robustness.paper.lemma_audit > docs/lemma-1.md`` makes the page anew, in a minute.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from robustness.constructions.lemma_1 import STATEMENTS, Statement, profile
from robustness.constructions.small_graphs import each_graph
from robustness.digraph import Digraph

__all__ = ["Finding", "audit", "page"]

#: All graphs up to so many nodes are tried, and all digraphs; these up to one node less by statements with choices.
GRAPHS, DIGRAPHS = 6, 5


@dataclass(frozen=True, slots=True)
class Finding:
    """What became of one statement: a smallest counterexample and its reason, or None after ``tried`` graphs."""

    statement: Statement
    directed: bool
    tried: int
    counterexample: Digraph | None = None
    reason: str = ""

    def __str__(self) -> str:
        if self.counterexample is None:
            return "holds"
        return f"**fails**: {_graph_text(self.counterexample)}: {self.reason}"


def audit(
    statements: Sequence[Statement] = STATEMENTS, *, directed: bool, largest: int | None = None
) -> tuple[Finding, ...]:
    """Try every statement on all graphs (or digraphs) on 2 to ``largest`` nodes up to isomorphism, smallest first."""
    if largest is None:
        largest = DIGRAPHS if directed else GRAPHS
    graphs = [graph for graph in each_graph(largest, directed=directed) if graph.n >= 2]
    fewer = [graph for graph in graphs if graph.n < largest] if directed else graphs
    return tuple(_try(each, fewer if each.has_choices else graphs, directed) for each in statements)


def _try(statement: Statement, graphs: Iterable[Digraph], directed: bool) -> Finding:
    tried = 0
    for graph in graphs:
        tried += 1
        reason = statement.refute(graph)
        if reason is not None:
            return Finding(statement, directed, tried, graph, reason)
    return Finding(statement, directed, tried)


def page(graphs: int = GRAPHS, digraphs: int = DIGRAPHS) -> str:
    """Return the page of the documentation as Markdown."""
    undirected = audit(directed=False, largest=graphs)
    directed = audit(directed=True, largest=digraphs)
    tried = [sum(graph.n >= 2 for graph in each_graph(n, directed=d)) for n, d in ((graphs, False), (digraphs, True))]
    rows = [_row(one, two) for one, two in zip(undirected, directed, strict=True)]
    head = _HEAD.format(graphs=graphs, digraphs=digraphs, fewer=digraphs - 1, tried=tried)
    return "\n".join([head, *rows]) + "\n" + _TAIL


def _row(undirected: Finding, directed: Finding) -> str:
    statement = undirected.statement
    cells = (statement.item, "paper" if statement.is_paper else "ours", statement.text, undirected, directed)
    return "| " + " | ".join(map(str, cells)) + " |"


def _graph_text(graph: Digraph) -> str:
    """Return a graph in a few words: complete, or its links, or the missing links of a dense one."""
    sign = "→" if graph.directed else "–"
    pairs = [(u, v) for u in range(graph.n) for v in range(graph.n) if (u != v if graph.directed else u < v)]
    links = {arc for arc in graph.arcs() if graph.directed or arc[0] < arc[1]}
    missing = [pair for pair in pairs if pair not in links]
    name = f"K_{graph.n}" if len(missing) < len(links) else f"n = {graph.n}"
    if not missing:
        return name
    listed, word = (missing, "without") if len(missing) < len(links) else (sorted(links), "with")
    text = ", ".join(f"{u}{sign}{v}" for u, v in listed) or "no link"
    return f"{name} {word} {text}, s_max = {profile(graph)[1:]}"


_HEAD = """\
# Lemma 1 of the source paper, item by item

The source paper is M. Safi, S. M. Dibaji, M. Pirani: *Resilient Coordinated Movement of Connected Autonomous Vehicles*
([number 1 of the references](references.md)).

This page is made by a command, which anyone can run again:

```
python -m robustness.paper.lemma_audit > docs/lemma-1.md
```

Every statement is executable (`robustness.constructions.lemma_1`) and was tried on **all** graphs on 2 to {graphs}
nodes ({tried[0]} of them) and **all** digraphs on 2 to {digraphs} nodes ({tried[1]}), up to isomorphism. Where the
statement quantifies over something more (r and s, the arcs removed, the node added), all choices were tried. `holds`
means no counterexample among these; a counterexample shown is a smallest one (fewest nodes, then fewest links).
Larger graphs are drawn by Hypothesis in `tests/constructions/test_lemma_1.py`. Rows marked *ours* are corrections,
sharper forms and converses.

| item | says | statement | graphs | digraphs |
|---|---|---|---|---|"""

_TAIL = """
## What to make of it

* **(iii) is about undirected graphs only.** A 1-robust digraph need not be strongly connected: one arc between two
  nodes is enough. What does hold for digraphs is that r - 1 nodes may be removed and some node still reaches all
  others: by (vi) for node removal the rest is 1-robust, and (iv) applies. That r-connected does not imply r-robust
  is confirmed.
* **(iv) needs r >= 1.** Item (i) lets r be 0, and every graph is (0,s)-robust. With r >= 1 it is an equivalence.
* **(vii) is too modest.** The in-degree r + s - 1 that it asks for keeps (r,s), not only r; for r alone in-degree r
  is enough. For (r,s) the bound is sharp. The proof is in `robustness.constructions.operations.add_node`.
* **The range of s.** The definition asks for r, s < n, item (v) uses s = n. Both are right: (r,n-1) and (r,n) are
  the same property, since a violating pair leaves a node on either side unreached and so has at most n - 2 reached
  nodes. For n = 2 the restriction would leave only (1,1).
* **The least in-degree** of an r-robust digraph is at least r from r = 2 on; a 1-robust digraph may have a node
  that hears nobody.
* **K_5 is not the only 3-robust graph on 5 nodes**: K_5 without one edge is 3-robust as well, with 9 = 3r(r-1)/2
  edges.
* The proof of Proposition 1 cites (iv) where it adds nodes; it means (vii). The remark on the normal part cites
  (vi), which keeps the nodes; it needs the form for node removal (`remove_nodes`), which the table confirms.
* (i) to (vii) have short proofs; those that the operations rely on stand in their docstrings. The last line follows
  from (ii), used s - 1 times. (i), (ii), (v), (vi), (vii) in the sharper form and the last line are proved
  [in Coq](formal.md#what-else-is-proven) for every digraph, as `lemma_1_i` and so on.
"""

if __name__ == "__main__":
    sys.stdout.write(page())
