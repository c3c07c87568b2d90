"""The atlas: what is known about all topohub networks and all connected graphs of up to six nodes.

``python -m benchmarks.atlas measure`` surveys them (about twenty minutes; five seconds a network at most) and writes
the rows to ``docs/atlas.jsonl``; ``python -m benchmarks.atlas page FILE`` makes the page. ``make atlas`` does both.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import networkx as nx

from robustness.constructions.small_graphs import digraph_of_masks, graphs_up_to_isomorphism
from robustness.reporting.front import report_of
from robustness.surveying import Row, Survey, survey
from robustness.threat_models import THREAT_MODELS

DATA = Path(__file__).resolve().parent.parent / "docs" / "atlas.jsonl"
JOURNAL = Path("build/atlas.state")
LIMIT = 5.0
LARGEST = 6


def census() -> Iterator[tuple[str, nx.Graph]]:
    """Yield every connected graph of 2 to 6 nodes up to isomorphism, with a name."""
    for n in range(2, LARGEST + 1):
        for number, masks in enumerate(graphs_up_to_isomorphism(n)):
            graph = nx.empty_graph(n)
            graph.add_edges_from(digraph_of_masks(masks).arcs())
            if nx.is_connected(graph):
                yield f"census:{n}/{number}", graph


def measure() -> None:
    JOURNAL.parent.mkdir(exist_ok=True)
    found = survey([*census(), "topohub:*"], time_limit=LIMIT, state=JOURNAL)
    write(found.rows)


def write(rows: tuple[Row, ...]) -> None:
    """Write the rows without what differs from run to run and what nobody looks up."""
    kept = (replace(row, weakest=None, seconds=0.0).as_dict() for row in rows)
    DATA.write_text("".join(json.dumps(row) + "\n" for row in kept), encoding="utf-8")


def rows() -> tuple[Row, ...]:
    return tuple(Row.of_dict(json.loads(line)) for line in DATA.read_text(encoding="utf-8").splitlines())


def page(target: Path) -> None:
    found = Survey(rows(), tuple(THREAT_MODELS))
    report_of(found, {}, title="Atlas: topohub networks and small graphs").write(target)


if __name__ == "__main__":
    if sys.argv[1:2] == ["measure"]:
        measure()
    else:
        page(Path(sys.argv[2]))
